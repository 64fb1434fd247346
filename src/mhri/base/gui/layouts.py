# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Rows and columns of widgets, each laid out in one call."""
from python_qt_binding.QtWidgets import QHBoxLayout, QLayout, QVBoxLayout

#: no margins: left, top, right, bottom [px]
TIGHT = (0, 0, 0, 0)


def in_row(*parts, of=None, margins=None, gap=None):
    """Return a row of parts, as :func:`add_parts` places them.

    :param of: the widget to fill, None for a row inside another layout
    :param margins: (left, top, right, bottom) around the parts [px], None for the style's
    :param gap: space between two parts [px], None for the style's
    """
    return _laid_out(QHBoxLayout, parts, of, margins, gap)


def in_column(*parts, of=None, margins=None, gap=None):
    """Return a column of parts; the same parameters as :func:`in_row`."""
    return _laid_out(QVBoxLayout, parts, of, margins, gap)


def add_parts(layout, *parts):
    """Place parts at the end of a row or a column.

    :param parts: each a widget or a layout, alone or in a tuple with its stretch and its
        alignment; a number is the stretch of an empty space
    """
    for part in parts:
        what, *how = part if isinstance(part, tuple) else (part,)
        if isinstance(what, int):
            layout.addStretch(what)
        elif isinstance(what, QLayout):
            layout.addLayout(what, *how)
        else:
            layout.addWidget(what, *how)


def _laid_out(kind, parts, of, margins, gap):
    """Create and fill a layout."""
    layout = kind() if of is None else kind(of)
    if margins is not None:
        layout.setContentsMargins(*margins)
    if gap is not None:
        layout.setSpacing(gap)
    add_parts(layout, *parts)
    return layout
