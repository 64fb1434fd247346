# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The drop-down that says and chooses which source drives."""
from typing import NamedTuple

from python_qt_binding.QtCore import QSize, Qt, QTimer, Signal
from python_qt_binding.QtWidgets import QComboBox, QStyle, QStyleOptionComboBox, QStylePainter

from mhri.base.gui import theme
from mhri.base.gui.labels import plain_tip
from mhri.base.gui.pending import Pending

ANSWER_WITHIN_S = 2.0
# A node looks once a second which device is wanted, and opening takes a while.
DEVICE_WITHIN_S = 5.0


class _Row(NamedTuple):
    """A line of the list: a source as it is, or one of its other devices."""

    source: str
    label: str
    device: str = ''

    @property
    def wanted(self):
        """What the line asks for: a source, or a source and a device."""
        return (self.source, self.device) if self.device else self.source


def _rows(name, label, device):
    """Return the lines of a source with what is known of its device, or None."""
    others = [other for other in device.there if other != device.name] if device else []
    return [_Row(name, label), *(_Row(name, other, other) for other in others)]


class ModeCombo(QComboBox):
    """Shows the mode in force; a click is a request, shown as one until the mux grants it.

    After 2 s without an answer it shows what is in force again. Below a source there are the other
    devices that are there for it: one of two pads can be chosen. The wheel does nothing: scrolling
    past must not hand the robots to another source.
    """

    #: name of the source that is asked for
    mode_requested = Signal(str)
    #: another device of a source is asked for: names of both
    device_requested = Signal(str, str)

    def __init__(self, parent=None):
        super().__init__(parent)
        self._sources = ()
        self._rows = ()
        self._device = ''
        self._mode = None
        self._shown = ''
        self._asked = Pending(ANSWER_WITHIN_S)
        self._asked_device = Pending(DEVICE_WITHIN_S)
        self._build()
        self._connect()
        self._show()

    def _build(self):
        """Set what never changes."""
        self.setFocusPolicy(Qt.TabFocus)
        self.setSizeAdjustPolicy(QComboBox.AdjustToMinimumContentsLengthWithIcon)
        # With the button to talk beside it, it must not make the panel wider.
        self.setMinimumContentsLength(10)
        self.setAccessibleName('Drive with')
        self._answer = QTimer(self)
        self._answer.setSingleShot(True)
        # A coarse one may come too early to find the request too old.
        self._answer.setTimerType(Qt.PreciseTimer)
        self._answer.setInterval(round(ANSWER_WITHIN_S * 1000) + 20)

    def _connect(self):
        """Wire the list and the timer."""
        self.activated[int].connect(self._on_activated)
        self._answer.timeout.connect(self._show)

    @property
    def shown_text(self):
        """The text on show."""
        return self._shown

    @property
    def pending(self):
        """Name of the source asked for and not in force yet, or None."""
        return self._asked.value

    def label_of(self, name):
        """Return the label of a source; of an unknown one its name."""
        return dict(self._sources).get(name, name)

    def show_mode(self, sources, mode, devices=()):
        """Show the sources, pairs (name, label), and the mode in force (None: not known).

        :param devices: the :class:`mhri.base.views.DeviceView` of those that have one
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
        """Fill the list; one that is open stays so while devices come and go."""
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
        """Say of each device in its tool tip what has to be done."""
        for place, row in enumerate(self._rows):
            tip = plain_tip(notes.get(row.wanted, ''))
            if tip != (self.itemData(place, Qt.ToolTipRole) or ''):
                self.setItemData(place, tip, Qt.ToolTipRole)
        tip = plain_tip(notes.get(self._mode, ''))
        if tip != self.toolTip():
            self.setToolTip(tip)

    def _on_activated(self, index):
        """Ask for the chosen source; the drop-down goes back to the mode in force until then."""
        name, device = self._rows[index].source, self._rows[index].device
        self._asked_device.drop()
        if device:
            self._asked_device.ask(device)
            self.device_requested.emit(name, device)
        if name != self._mode:
            self._asked.ask(name)
            self._answer.start()
            self.mode_requested.emit(name)
        elif self._asked.value is not None:
            self._asked.drop()
            self.mode_requested.emit(name)
        self._show()

    def _show(self):
        """Show the mode in force, or the one asked for as such."""
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
        if shown != self._shown:
            self._shown = shown
            self.update()

    def wheelEvent(self, event):  # noqa: N802
        """Leave the wheel to whatever scrolls."""
        event.ignore()

    def paintEvent(self, event):  # noqa: N802
        """Paint the drop-down with the text on show."""
        painter = QStylePainter(self)
        option = QStyleOptionComboBox()
        self.initStyleOption(option)
        option.currentText = self._shown
        painter.drawComplexControl(QStyle.CC_ComboBox, option)
        painter.drawControl(QStyle.CE_ComboBoxLabel, option)
