# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The text size of the screen: fonts, and the sizes that follow them, changed while it runs."""
from python_qt_binding.QtWidgets import QWidget

from mhri.base.gui import theme

#: the sizes to choose from [%]; 100 is the size of the desktop's text, but at least 11 points
SIZES = (75, 100, 125, 150, 175, 200)
# On a monitor that is at least so high [px] with lines so low [px], the desktop was not set up for
# it, and text begins larger.
_HIGH_PX, _LOW_LINE_PX, _ON_HIGH = 2000, 26, 150
# A property of a widget: its sizes at 100 %, and those that were set last.
_KEPT = 'mhri_sizes'
_LIMITS = (('minimumWidth', 'setMinimumWidth'), ('minimumHeight', 'setMinimumHeight'),
           ('maximumWidth', 'setMaximumWidth'), ('maximumHeight', 'setMaximumHeight'))
_NO_LIMIT = 16777215


def usual_size(monitor_px, line_px):
    """Return the size to begin with [%].

    :param monitor_px: height of the monitor
    :param line_px: height of a line of text at 100 %
    """
    return _ON_HIGH if monitor_px >= _HIGH_PX and line_px <= _LOW_LINE_PX else 100


def text_percent():
    """Return the size of the text of what is made now [%]."""
    return round(100 * theme.text_scale[0])


def change_text_size(window, before, percent):
    """Change the size of text: of a window with all it contains, and of what is made from here on.

    :param before: the present size of its text [%]
    :param percent: one of :data:`SIZES`
    """
    theme.text_scale[0] = percent / 100.0
    widgets = [window, *window.findChildren(QWidget)]
    # All is read before the first font is set: children follow their parents, and some widgets
    # compute their limits from their font.
    found = [(widget, widget.font(), _limits_of(widget)) for widget in widgets]
    for widget, font, _ in found:
        widget.setFont(theme.larger(font, percent / before, font.bold()))
    for widget, _, limits in found:
        _scale_limits(widget, limits, before / 100.0, percent / 100.0)


def _limits_of(widget):
    """Return the limits of the size of a widget that were set: {name: px}."""
    limits = {read: getattr(widget, read)() for read, _ in _LIMITS}
    return {read: px for read, px in limits.items() if 1 < px < _NO_LIMIT}


def _scale_limits(widget, limits, before, scale):
    """Scale limits that are as before; what is large enough for a finger stays so."""
    kept = widget.property(_KEPT) or {}
    for read, write in _LIMITS:
        now = getattr(widget, read)()
        if limits.get(read) != now:
            continue
        base, last = kept.get(read, (0.0, 0))
        if last != now:
            base = now / before
        px = round(base * scale)
        if base >= theme.SMALLEST_TOUCH_PX:
            px = max(px, theme.SMALLEST_TOUCH_PX)
        kept[read] = base, px
        getattr(widget, write)(px)
    if kept:
        widget.setProperty(_KEPT, kept)
