# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Loading of ``.ui`` forms, the same with every Qt binding."""
import os

from python_qt_binding import loadUi
from python_qt_binding.QtWidgets import QWidget


def load_form(ui_dir, file_name, widget, classes):
    """Fill a widget from a form; each named part becomes an attribute.

    :param ui_dir: folder of the forms
    :param classes: the widget classes of our own that the form uses
    :raises OSError: the form cannot be read
    """
    loadUi(os.path.join(ui_dir, file_name), widget, {one.__name__: one for one in classes})
    # PySide leaves the names of custom widgets out.
    for name, part in list(vars(widget).items()):
        if isinstance(part, QWidget) and not part.objectName():
            part.setObjectName(name)
