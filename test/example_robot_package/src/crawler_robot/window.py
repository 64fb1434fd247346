# SPDX-FileCopyrightText: 2026 The lab
# SPDX-License-Identifier: BSD-3-Clause
"""The crawler's window: the standard one, and how far it is from where it was switched on."""
import math

from python_qt_binding.QtWidgets import QLabel

from mhri.screen.gui.windows import TurtleBotWindow


class CrawlerWindow(TurtleBotWindow):
    """A window with a line more."""

    def _build(self, ui_dir, type_label):
        super()._build(ui_dir, type_label)
        self.distance = QLabel(self)
        self.motion_place.layout().addWidget(self.distance)

    def show_view(self, view, stop_all=False):
        """Show a robot, about 20 times a second: never wait here."""
        super().show_view(view, stop_all)
        if view.x_m is not None:
            self.distance.setText('{:.2f} m from home'.format(math.hypot(view.x_m, view.y_m)))
