# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A scroll bar for fingers; one that a style sheet makes wide would not follow the theme."""
from python_qt_binding.QtCore import QSize
from python_qt_binding.QtWidgets import QScrollBar

from mhri.base.gui import theme


class WideScrollBar(QScrollBar):
    """As wide as most of a finger."""

    def sizeHint(self):  # noqa: N802
        """Return the room that it takes."""
        return QSize(round(0.6 * theme.touch_size(self)), super().sizeHint().height())
