# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Widgets that need the arrow keys themselves."""

_KEEPS_ARROWS = 'mhri_keeps_arrows'


def keep_arrows(widget):
    """Leave the arrow keys to a widget while it has the focus; sliders need no call."""
    widget.setProperty(_KEEPS_ARROWS, True)


def keeps_arrows(widget):
    """Return whether the arrow keys belong to a widget while it has the focus."""
    return bool(widget.property(_KEEPS_ARROWS))
