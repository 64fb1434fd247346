# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Drop-downs and other controls that must not change when the user scrolls past."""


class IgnoresWheel:
    """Mixin of a widget that passes the wheel to its scroll area and never changes its value."""

    def wheelEvent(self, event):  # noqa: N802
        """Ignore the event."""
        event.ignore()


def offer(combo, rows, chosen):
    """Set the rows of a drop-down; an open list is left unchanged.

    :param rows: (label, value) of each row
    :param chosen: the value to show, or the first row if it is not among them
    """
    if combo.view().isVisible():
        return
    if rows != [(combo.itemText(place), combo.itemData(place)) for place in range(combo.count())]:
        combo.clear()
        for row in rows:
            combo.addItem(*row)
    combo.setCurrentIndex(max(0, combo.findData(chosen)))
