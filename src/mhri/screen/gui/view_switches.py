# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The row that chooses what a tile shows: one picture, and what stands beside it."""
from python_qt_binding.QtCore import Qt, Signal
from python_qt_binding.QtWidgets import QButtonGroup, QLabel, QWidget

from mhri.base.gui.arrows import keep_arrows
from mhri.base.gui.flow import FlowLayout, let_height_follow
from mhri.base.gui.switches import SwitchBox, SwitchRadio
from mhri.base.view_rows import KEYS, PICTURES, RGB, VIEW_ROWS

OFF = 'off'
_AT_FIRST = frozenset((RGB,))


class ViewSwitches(QWidget):
    """Check boxes and radio buttons; what the operator wants is kept while it is not on offer.

    Child widgets, by the keys of the registry: ``camera_off``, ``camera_rgb``, ... and
    ``view_scan``, ``view_imu``, ...
    """

    #: another set of views is wanted
    changed = Signal()

    def __init__(self, parent=None):
        super().__init__(parent)
        self._offered = frozenset()
        self._chosen = frozenset(_AT_FIRST)
        self._build()
        self._connect()
        self._restore()

    def _build(self):
        """Make and place the switches."""
        unit = self.fontMetrics().height()
        # Two parts, each of them on further lines where there is no room for all of it.
        pictures, beside = QWidget(self), QWidget(self)
        parts = FlowLayout(self, 2 * unit, 0)
        for part in (pictures, beside):
            FlowLayout(part, unit // 2, 0)
            let_height_follow(part)
            parts.addWidget(part)
        let_height_follow(self)
        # Made in reading order: Tab goes that way.
        self.cameras = {OFF: SwitchRadio(OFF, self)}
        self.cameras.update((row.key, SwitchRadio(row.label, self))
                            for row in VIEW_ROWS if row.picture)
        self.checks = {row.key: SwitchBox(row.label, self) for row in VIEW_ROWS if not row.picture}
        self.camera_caption = QLabel('Picture', self)
        self._group = QButtonGroup(self)
        pictures.layout().addWidget(self.camera_caption)
        for key, button in self.cameras.items():
            button.setObjectName('camera_' + key)
            button.setAccessibleName('picture ' + button.text())
            # With the keyboard on it the arrows choose; a click does not bring the keyboard there.
            keep_arrows(button)
            self._group.addButton(button)
            pictures.layout().addWidget(button)
        for key, box in self.checks.items():
            box.setObjectName('view_' + key)
            beside.layout().addWidget(box)

    def _connect(self):
        """Wire the switches."""
        for button in (*self.checks.values(), *self.cameras.values()):
            button.clicked.connect(self._on_click)

    def _restore(self):
        """Begin with nothing on offer."""
        self.offer(())

    def offer(self, keys):
        """Offer these views of the registry; what is not among them disappears."""
        before = self.wanted()
        self._offered = frozenset(keys) & KEYS
        for key, box in self.checks.items():
            box.setVisible(key in self._offered)
        cameras = self._offered & PICTURES
        self.camera_caption.setVisible(bool(cameras))
        for key, button in self.cameras.items():
            button.setVisible(bool(cameras) if key == OFF else key in cameras)
        self._show()
        if self.wanted() != before:
            self.changed.emit()

    def wanted(self):
        """Return the set of views that are chosen and on offer; of pictures one at most."""
        return set(self._chosen & self._offered)

    def choose(self, keys):
        """Choose exactly these views; of pictures one, the first of them in the registry."""
        before = self.wanted()
        pictures = [row.key for row in VIEW_ROWS if row.picture and row.key in keys]
        self._chosen = frozenset(keys) & KEYS - frozenset(pictures[1:])
        self._show()
        if self.wanted() != before:
            self.changed.emit()

    def chosen(self):
        """Return what is chosen, on offer or not, as a sorted list."""
        return sorted(self._chosen)

    def _show(self):
        """Show what is chosen."""
        wanted = self.wanted()
        for key, box in self.checks.items():
            box.setChecked(key in wanted)
        camera = next(iter(wanted & PICTURES), OFF)
        self.cameras[camera].setChecked(True)
        self._let_tab_reach_checked()

    def _let_tab_reach_checked(self):
        """Make the button that is checked the one of its group that Tab comes to."""
        for button in self.cameras.values():
            button.setFocusPolicy(Qt.TabFocus if button.isChecked() else Qt.NoFocus)

    def _on_click(self):
        """Take over what is checked; what is not on offer stays as it was chosen."""
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
