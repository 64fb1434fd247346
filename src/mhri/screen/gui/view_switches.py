# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The switches of a tile: one picture, and the views over it."""
from python_qt_binding.QtCore import Qt, Signal
from python_qt_binding.QtWidgets import QLabel, QWidget

from mhri.base.gui.flow import FlowLayout, let_height_follow
from mhri.base.gui.switches import radio_group, SwitchBox
from mhri.base.view_rows import KEYS, PICTURES, RGB, VIEW_ROWS

OFF = 'off'
NO_ROOM = '{} (no room)'
_AT_FIRST = frozenset((RGB,))


class ViewSwitches(QWidget):
    """Check boxes and radio buttons; a choice is kept while unavailable.

    Child widgets, by the keys of the registry: ``camera_off``, ``camera_rgb``, ``camera_cloud``,
    ... and ``view_scan``, ``view_imu``, ...
    """

    #: the set of wanted views changed
    changed = Signal()

    def __init__(self, parent=None):
        super().__init__(parent)
        self._offered = frozenset()
        self._chosen = frozenset(_AT_FIRST)
        self._build()
        self._connect()
        self._restore()

    def _build(self):
        """Create and place the switches."""
        unit = self.fontMetrics().height()
        # Two parts, each wrapped if it does not fit on a line.
        pictures, beside = QWidget(self), QWidget(self)
        parts = FlowLayout(self, 2 * unit, 0)
        for part in (pictures, beside):
            FlowLayout(part, unit // 2, 0)
            let_height_follow(part)
            parts.addWidget(part)
        let_height_follow(self)
        self.camera_caption = QLabel('Picture', self)
        pictures.layout().addWidget(self.camera_caption)
        # Created in reading order, which is the order of Tab.
        self.cameras = radio_group(self, pictures.layout(), 'camera_', 'picture ', {
            OFF: OFF, **{row.key: row.label for row in VIEW_ROWS if row.picture}})
        self.checks = {row.key: SwitchBox(row.label, self) for row in VIEW_ROWS if not row.picture}
        for key, box in self.checks.items():
            box.setObjectName('view_' + key)
            beside.layout().addWidget(box)

    def _connect(self):
        """Connect the switches."""
        for button in (*self.checks.values(), *self.cameras.values()):
            button.clicked.connect(self._on_click)

    def _restore(self):
        """Start without available views."""
        self.offer(())

    def offer(self, keys):
        """Make exactly these views of the registry available."""
        before = self.selected_views()
        self._offered = frozenset(keys) & KEYS
        for key, box in self.checks.items():
            box.setVisible(key in self._offered)
        cameras = self._offered & PICTURES
        self.camera_caption.setVisible(bool(cameras))
        for key, button in self.cameras.items():
            button.setVisible(bool(cameras) if key == OFF else key in cameras)
        self._show()
        if self.selected_views() != before:
            self.changed.emit()

    def selected_views(self):
        """Return the set of chosen and available views, with at most one picture."""
        return set(self._chosen & self._offered)

    def choose(self, keys):
        """Choose exactly these views; of several pictures, only the first in the registry."""
        before = self.selected_views()
        pictures = [row.key for row in VIEW_ROWS if row.picture and row.key in keys]
        self._chosen = frozenset(keys) & KEYS - frozenset(pictures[1:])
        self._show()
        if self.selected_views() != before:
            self.changed.emit()

    def show_without_room(self, keys):
        """Mark the chosen views that the tile is too small for."""
        for row in VIEW_ROWS:
            if row.key in self.checks:
                self.checks[row.key].setText(
                    NO_ROOM.format(row.label) if row.key in keys else row.label)

    def chosen(self):
        """Return the chosen views, available or not, as a sorted list."""
        return sorted(self._chosen)

    def _show(self):
        """Show the choice."""
        selected = self.selected_views()
        for key, box in self.checks.items():
            box.setChecked(key in selected)
        camera = next(iter(selected & PICTURES), OFF)
        self.cameras[camera].setChecked(True)
        self._let_tab_reach_checked()

    def _let_tab_reach_checked(self):
        """Make Tab reach the checked button of a group."""
        for button in self.cameras.values():
            button.setFocusPolicy(Qt.TabFocus if button.isChecked() else Qt.NoFocus)

    def _on_click(self):
        """Read the switches; keep the choice of unavailable views."""
        self._let_tab_reach_checked()
        checked = {key for key, box in self.checks.items() if box.isChecked()}
        checked |= {key for key, button in self.cameras.items() if button.isChecked()}
        kept = self._chosen - self._offered
        if self._offered & PICTURES:
            kept -= PICTURES
        chosen = frozenset(checked - {OFF}) | kept
        if chosen != self._chosen:
            self._chosen = chosen
            self.changed.emit()
