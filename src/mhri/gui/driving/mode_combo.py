# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The drop-down that says and chooses which source drives."""
from python_qt_binding.QtCore import QSize, Qt, QTimer, Signal
from python_qt_binding.QtWidgets import QComboBox, QStyle, QStyleOptionComboBox, QStylePainter

from mhri.gui.screen import theme
from mhri.gui.screen.labels import plain_tip
from mhri.gui.screen.pending import Pending

ANSWER_WITHIN_S = 2.0


class ModeCombo(QComboBox):
    """Shows the mode in force; a click is a request, shown as one until the mux grants it.

    After 2 s without an answer it shows what is in force again. The wheel does nothing: scrolling
    past must not hand the robots to another source.
    """

    #: name of the source that is asked for
    mode_requested = Signal(str)

    def __init__(self, parent=None):
        super().__init__(parent)
        self._sources = ()
        self._mode = None
        self._shown = ''
        self._asked = Pending(ANSWER_WITHIN_S)
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

        :param devices: the :class:`mhri.core.screen.views.DeviceView` of those that have one
        """
        if sources != self._sources:
            self._show_sources(tuple(sources))
        self._mode = mode
        self._show_notes({device.source: device.note for device in devices})
        self._show()

    def _show_sources(self, sources):
        """Fill the list; one that is open stays so while devices come and go."""
        same = [name for name, _ in sources] == [name for name, _ in self._sources]
        self._sources = sources
        if not same:
            self.clear()
        for row, (name, label) in enumerate(sources):
            if same:
                self.setItemText(row, label)
            else:
                self.addItem(label, name)
                self.setItemData(row, QSize(0, theme.touch_size(self)), Qt.SizeHintRole)

    def _show_notes(self, notes):
        """Say of each device in its tool tip what has to be done."""
        for row, (name, _) in enumerate(self._sources):
            tip = plain_tip(notes.get(name, ''))
            if tip != (self.itemData(row, Qt.ToolTipRole) or ''):
                self.setItemData(row, tip, Qt.ToolTipRole)
        tip = plain_tip(notes.get(self._mode, ''))
        if tip != self.toolTip():
            self.setToolTip(tip)

    def _on_activated(self, index):
        """Ask for the chosen source; the drop-down goes back to the mode in force until then."""
        name = self.itemData(index)
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
        if self._asked.value is not None:
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
