# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Loading of ``.ui`` forms, the same with every Qt binding."""
from functools import lru_cache
import os

from python_qt_binding import loadUi, QT_BINDING
from python_qt_binding.QtWidgets import QWidget


@lru_cache(maxsize=None)
def _maker(path):
    """Return the class that fills a widget from a form, None where the binding has no such thing.

    Reading the form anew for each robot takes five times as long.
    """
    if QT_BINDING != 'pyqt':
        return None
    from PyQt5 import uic
    return uic.loadUiType(path)[0]


def load_form(ui_dir, file_name, widget, classes):
    """Fill a widget from a form; each named part becomes an attribute.

    :param ui_dir: folder of the forms
    :param classes: the widget classes of our own that the form uses
    :raises OSError: the form cannot be read
    """
    path = os.path.join(ui_dir, file_name)
    maker = _maker(path)
    if maker is not None:
        parts = maker()
        parts.setupUi(widget)
        vars(widget).update(vars(parts))
        return
    loadUi(path, widget, {one.__name__: one for one in classes})
    # PySide leaves the names of custom widgets out.
    for name, part in list(vars(widget).items()):
        if isinstance(part, QWidget) and not part.objectName():
            part.setObjectName(name)
