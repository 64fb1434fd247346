# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The line with the state of a drill, above the bottom line; hidden without a drill."""
from mhri.base.gui import theme
from mhri.base.gui.labels import plain_tip, SignLine


class DrillLine(SignLine):
    """The line; its tool tip is the task of the drill."""

    def __init__(self, parent=None):
        super().__init__(parent)
        self.show_drill(())

    def show_drill(self, texts, about='', silent=False):
        """Show the longest text that fits; without texts, hide the line.

        :param about: description of the task
        :param silent: whether the referee has stopped
        """
        if texts:
            self.line.show_text(texts[0], theme.TEXT, texts[1:])
            self.sign.show_sign(theme.WARNING if silent else None)
            self.setToolTip(plain_tip(about))
        self.setVisible(bool(texts))

    def text(self):
        """Return the full text, even if it does not fit."""
        return self.line.text()
