# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The drop-down that shows and selects the active source."""
from typing import NamedTuple

from python_qt_binding.QtCore import QSize, Qt, Signal
from python_qt_binding.QtWidgets import QComboBox

from mhri.base.gui import theme
from mhri.base.gui.choices import IgnoresWheel
from mhri.base.gui.controls import Combo
from mhri.base.gui.labels import plain_tip
from mhri.base.gui.pending import Pending

ANSWER_WITHIN_S = 2.0
# A node reads the requested device once a second, and opening it takes a while.
DEVICE_WITHIN_S = 5.0


class _Row(NamedTuple):
    """A row of the list: a source with its device, or one of its other devices."""

    source: str
    label: str
    device: str = ''

    @property
    def wanted(self):
        """The request of the row: a source, or a source and a device."""
        return (self.source, self.device) if self.device else self.source


def _rows(name, label, device):
    """Return the rows of a source, given the state of its device or None."""
    others = [other for other in device.there if other != device.name] if device else []
    return [_Row(name, label), *(_Row(name, other, other) for other in others)]


class ModeCombo(IgnoresWheel, Combo):
    """Shows the current mode; a click is a request, shown as pending until the mux grants it.

    After 2 s without an answer it shows the current mode again. Below a source are its other
    connected devices, e.g. to choose between two pads. The wheel has no effect: scrolling past must
    not hand the robots to another source.
    """

    #: a source is requested: its name
    mode_requested = Signal(str)
    #: another device of a source is requested: names of both
    device_requested = Signal(str, str)

    def __init__(self, parent=None):
        super().__init__(parent)
        self._sources = ()
        self._rows = ()
        self._device = ''
        self._mode = None
        #: the displayed text
        self.shown_text = ''
        self._asked = Pending(ANSWER_WITHIN_S, self._show)
        self._asked_device = Pending(DEVICE_WITHIN_S)
        self._build()
        self._connect()
        self._show()

    def _build(self):
        """Set the constant properties."""
        self.setFocusPolicy(Qt.TabFocus)
        self.setSizeAdjustPolicy(QComboBox.AdjustToMinimumContentsLengthWithIcon)
        # With the talk button beside it, it must not make the panel wider.
        self.setMinimumContentsLength(10)
        self.setAccessibleName('Drive with')

    def _connect(self):
        """Connect the signals."""
        self.activated[int].connect(self._on_activated)

    @property
    def pending(self):
        """Name of the requested source that is not active yet, or None."""
        return self._asked.value

    def label_of(self, name):
        """Return the label of a source, or its name if it is unknown."""
        return dict(self._sources).get(name, name)

    def show_mode(self, sources, mode, devices=()):
        """Show the sources, pairs (name, label), and the current mode (None if unknown).

        :param devices: the :class:`mhri.base.views.DeviceView` of the sources that have one
        """
        self._sources = tuple(sources)
        there = {device.source: device for device in devices}
        rows = tuple(row for name, label in sources for row in _rows(name, label, there.get(name)))
        if rows != self._rows:
            self._show_rows(rows)
        self._mode = mode
        self._device = there[mode].name if mode in there else ''
        self._show_notes({device.source: device.note for device in devices})
        self._show()

    def _show_rows(self, rows):
        """Fill the list; an open list stays open while only labels change."""
        same = [row.wanted for row in rows] == [row.wanted for row in self._rows]
        self._rows = rows
        if not same:
            self.clear()
        for place, row in enumerate(rows):
            if same:
                self.setItemText(place, row.label)
            else:
                self.addItem(row.label, row.wanted)
                self.setItemData(place, QSize(0, theme.touch_size(self)), Qt.SizeHintRole)

    def _show_notes(self, notes):
        """Show the note of each device in its tool tip."""
        for place, row in enumerate(self._rows):
            tip = plain_tip(notes.get(row.wanted, ''))
            if tip != (self.itemData(place, Qt.ToolTipRole) or ''):
                self.setItemData(place, tip, Qt.ToolTipRole)
        tip = plain_tip(notes.get(self._mode, ''))
        if tip != self.toolTip():
            self.setToolTip(tip)

    def _on_activated(self, index):
        """Request the chosen source; the drop-down returns to the current mode until granted."""
        name, device = self._rows[index].source, self._rows[index].device
        self._asked_device.drop()
        if device:
            self._asked_device.ask(device)
            self.device_requested.emit(name, device)
        if name != self._mode:
            self._asked.ask(name)
            self.mode_requested.emit(name)
        elif self._asked.value is not None:
            self._asked.drop()
            self.mode_requested.emit(name)
        self._show()

    def _show(self):
        """Show the current mode, or the requested one as pending."""
        wanted = self._asked.settle(self._mode)
        index = self.findData(self._mode) if self._mode is not None else -1
        if index != self.currentIndex():
            self.setCurrentIndex(index)
        self._asked_device.settle(self._device)
        if self._asked_device.value is not None:
            shown = 'switching to {} ...'.format(self._asked_device.value)
        elif self._asked.value is not None:
            shown = 'switching to {} ...'.format(self.label_of(wanted))
        elif self._mode is None:
            shown = 'not known yet'
        else:
            shown = self.label_of(self._mode)
        if shown != self.shown_text:
            self.shown_text = shown
            self.update()

    def shown(self):
        """Return the displayed text."""
        return self.shown_text
