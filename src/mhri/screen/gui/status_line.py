# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The line at the bottom, with the most important message."""
from mhri.base.gui import theme, words
from mhri.base.gui.labels import SignLine
from mhri.screen.status import BETWEEN

_SIGNS = {'calm': None, 'attention': theme.WARNING,
          'stopped': (theme.OCTAGON, theme.STOP)}


class StatusLine(SignLine):
    """A sentence, preceded by a shape if it needs attention."""

    def __init__(self, parent=None):
        super().__init__(parent)
        self.line.setObjectName('status_label')
        self.line.setFont(theme.larger(theme.base_font(self.font()), theme.HEAD))

    def show_status(self, text, level):
        """Show a sentence; the level is 'calm', 'attention' or 'stopped'."""
        self.sign.show_sign(_SIGNS[level])
        parts = text.split(BETWEEN)
        # The robots come first, the state last; their source is visible elsewhere.
        shorter = [BETWEEN.join((parts[0], parts[-1]))] if len(parts) > 2 else []
        self.line.show_text(text, shorter=[
            part for short in (text, *shorter, parts[-1])
            for part in (short, *words.beginnings(short, ('; ', ': check ', ': look ')))][1:])
