# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The accessories of a robot in its large tile: buttons, pads and readouts over the picture."""
from functools import partial

from python_qt_binding.QtCore import QCoreApplication, QEvent, QPoint, QRect, QSize, Qt, Signal
from python_qt_binding.QtGui import QPalette
from python_qt_binding.QtWidgets import QWidget

from mhri.accessories import controls
from mhri.accessories.controls import controls_of, HELD_DOWN, MENU, PAD, PRESS, SWITCH
from mhri.accessories.gui.held import AxisPad, HoldButton
from mhri.base.accessories import ON, READOUT
from mhri.base.gui import theme
from mhri.base.gui.controls import Button
from mhri.base.gui.first_press import first_press
from mhri.base.gui.labels import plain_tip, TextLine
from mhri.driving.gui.robot_menu import popup

MORE = 'More'
_PRESSES = frozenset((QEvent.MouseButtonPress, QEvent.MouseButtonDblClick))


class _Switch(Button):
    """A button that is on once that is reported, not once it is pressed."""

    def nextCheckState(self):  # noqa: N802
        """Change nothing."""


class _Readout(TextLine):
    """The value of a sensor on a dark ground.

    :param widest: the longest text that it may have
    """

    def __init__(self, widest, parent=None):
        super().__init__(parent)
        self._widest = widest
        self.setAlignment(Qt.AlignCenter)

    def sizeHint(self):  # noqa: N802
        """Return room for any text and a margin, as high as the buttons."""
        return QSize(theme.text_width(self.font(), self._widest) + self.fontMetrics().height(),
                     theme.touch_size(self))

    def paintEvent(self, event):  # noqa: N802
        """Paint ground and text."""
        painter = theme.smooth_painter(self)
        theme.set_ink(painter, brush=theme.OVER_PICTURE)
        painter.drawRoundedRect(self.rect(), 4, 4)
        painter.end()
        super().paintEvent(event)


class AccessoryBar(QWidget):
    """Controls of one robot; the tile gives it room, and what does not fit is in its menu.

    :param remote: the kind of remote display, see :class:`HoldLimit`
    :param rows: function of a robot's name that returns the rows of its menu of accessories
    """

    #: an accessory is to act once: key, choice
    used = Signal(str, str)
    #: an accessory is held: key, values from -1 to 1; zeros once it is released
    held = Signal(str, tuple)
    #: a control that has no effect was pressed: key, why
    refused = Signal(str, str)
    #: what was held was released since no events came from the remote display
    ran_out = Signal()

    def __init__(self, name, remote, rows, parent=None):
        super().__init__(parent)
        self._name, self._remote, self._rows = name, remote, rows
        self._views, self._whys = {}, {}
        # [(control, its widget)]; a readout has no control.
        self._items = []
        self._room = (0, 0)
        self._build()

    def _build(self):
        """Set what stays as it is."""
        self.setObjectName('accessories')
        palette = theme.over_picture(self.palette())
        palette.setColor(QPalette.Disabled, QPalette.ButtonText, theme.blend(
            palette.color(QPalette.Button), palette.color(QPalette.ButtonText), 0.5))
        self.setPalette(palette)
        self._more = theme.finger_button(
            self, 'accessories_more', MORE, 'more accessories', room=0.5)
        self._more.clicked.connect(self._open_more)

    def show_accessories(self, shown):
        """Show the accessories of the robot.

        :param shown: pairs (:class:`AccessoryView`, why it does not obey or '')
        """
        specs = [view.spec for view in self._views.values()]
        self._views = {view.spec.key: view for view, _ in shown}
        self._whys = {view.spec.key: why for view, why in shown}
        if [view.spec for view, _ in shown] != specs:
            self._make_all()
        for control, widget in self._items:
            self._show(control, widget)

    def release(self):
        """Release what is held; it has to be pressed again."""
        for control, widget in self._items:
            if control.kind in (HELD_DOWN, PAD):
                widget.centre()

    def _make_all(self):
        """Make a widget for each control, pads after the buttons."""
        for _, widget in self._items:
            widget.hide()
            widget.deleteLater()
        found = [control for view in self._views.values() for control in controls_of(view.spec)
                 or (controls.Control(READOUT, view.spec, view.spec.label),)]
        self._items = [(control, self._make(control))
                       for control in sorted(found, key=lambda control: control.kind == PAD)]
        # The tile lays it out anew.
        QCoreApplication.postEvent(self.parentWidget(), QEvent(QEvent.LayoutRequest))

    def _make(self, control):
        """Make the widget of a control."""
        key, kind = control.spec.key, control.kind
        if kind == READOUT:
            return _Readout(controls.widest_readout(control.spec), self)
        if kind == PAD:
            widget = AxisPad(control, self)
            widget.moved.connect(partial(self.held.emit, key))
        elif kind == HELD_DOWN:
            widget = self._dressed(HoldButton(control.label, self), control)
            widget.pressed.connect(partial(self.held.emit, key, control.value))
            widget.released.connect(partial(self.held.emit, key, (0.0,)))
        else:
            widget = self._dressed((_Switch if kind == SWITCH else Button)(control.label, self),
                                   control)
            widget.setCheckable(kind == SWITCH)
            widget.clicked.connect(partial(self._click, control, widget))
        if kind in (HELD_DOWN, PAD):
            widget.limit.remote = self._remote
            widget.ran_out.connect(self.ran_out)
        widget.installEventFilter(self)
        return widget

    def _dressed(self, button, control):
        """Return a button with its icon, wide enough for each of its texts."""
        theme.for_fingers(button, 'accessory_' + control.spec.key, control.label)
        if control.spec.icon:
            button.set_icon(control.spec.icon)
        button.setMinimumWidth(button.minimumWidth() + theme.touch_size(self) // 2 + max(
            theme.text_width(self.font(), text) for text in self._texts(control)))
        return button

    @staticmethod
    def _texts(control):
        """Return all texts that a button may have."""
        states = {SWITCH: ('on', 'off', controls.UNKNOWN), MENU: (
            controls.UNKNOWN, *(choice.replace('_', ' ') for choice, _ in control.spec.choices))}
        return ['{} {}'.format(control.label, state).strip()
                for state in states.get(control.kind, ('',))]

    def _show(self, control, widget):
        """Show the state of a control, and whether it obeys."""
        key = control.spec.key
        view, why = self._views[key], self._whys[key]
        if control.kind == READOUT:
            widget.show_text(controls.readout_text(view), theme.ATTENTION if controls.warns(
                view) else theme.TEXT if view.known else theme.MUTED)
            return
        if widget.isEnabled() != (not why):
            widget.setEnabled(not why)
        if control.kind in (SWITCH, MENU):
            text = '{} {}'.format(control.label, controls.reported(view))
            if text != widget.text():
                widget.setText(text)
                widget.setAccessibleName(text)
        if control.kind == SWITCH:
            widget.setChecked(view.known and view.choice == ON)
        elif control.kind == PAD:
            widget.show_active(not why)
        tip = plain_tip('{}: {}'.format(control.label, why)) if why else ''
        if tip != widget.toolTip():
            widget.setToolTip(tip)
            widget.setAccessibleDescription(why)

    def _click(self, control, widget):
        """Use an accessory; ask for a choice if the next one is not evident."""
        key = control.spec.key
        choice = control.choice if control.kind == PRESS else \
            controls.next_choice(self._views[key]) if control.kind == SWITCH else None
        if choice is not None:
            self.used.emit(key, choice)
            return
        popup(self.window(), [(word.replace('_', ' '), partial(self.used.emit, key, word))
                              for word, _ in control.spec.choices],
              widget.mapToGlobal(QPoint(0, widget.height())), 'accessory_menu')

    def _open_more(self):
        popup(self.window(), self._rows(self._name),
              self._more.mapToGlobal(QPoint(0, self._more.height())), 'accessory_menu')

    def eventFilter(self, watched, event):  # noqa: N802
        """Say on a press why it has no effect; a click that began on another robot is none."""
        if event.type() not in _PRESSES:
            return False
        if first_press.of('', event):
            # The tiles moved with its first press.
            return True
        key = next(control.spec.key for control, widget in self._items if widget is watched)
        if self._whys[key]:
            self.refused.emit(key, self._whys[key])
        return bool(self._whys[key])

    def changeEvent(self, event):  # noqa: N802
        """Follow the text size."""
        super().changeEvent(event)
        if event.type() == QEvent.FontChange and self._items:
            self._make_all()
            for control, widget in self._items:
                self._show(control, widget)

    def fit(self, place, width, height):
        """Lie at a :class:`QPoint` of the tile within a room [px].

        :returns: its height [px], 0 if nothing fits
        """
        self._room = width, height
        self.move(place)
        return self._place()

    def _place(self):
        """Place what fits in lines from the left, the rest in the menu; return the height."""
        widgets = [widget for _, widget in self._items]
        boxes = self._lines(widgets)
        if len(boxes) < len(widgets):
            kept = [*boxes, self._more]
            boxes = self._lines(kept)
            while self._more not in boxes and len(kept) > 1:
                del kept[-2]
                boxes = self._lines(kept)
        whole = QRect(0, 0, 0, 0)
        for widget in (*widgets, self._more):
            box = boxes.get(widget)
            widget.setVisible(box is not None)
            if box is not None:
                widget.setGeometry(box)
                whole = whole.united(box)
        self.resize(whole.size())
        return whole.height()

    def _lines(self, widgets):
        """Return {widget: place} of those that fit."""
        boxes, x, y, high, gap = {}, 0, 0, 0, 2 * theme.GRID
        for widget in widgets:
            need = widget.sizeHint().expandedTo(widget.minimumSize())
            if x and x + need.width() > self._room[0] \
                    and y + high + gap + need.height() <= self._room[1]:
                x, y, high = 0, y + high + gap, 0
            if x + need.width() <= self._room[0] and y + need.height() <= self._room[1]:
                boxes[widget] = QRect(QPoint(x, y), need)
                x, high = x + need.width() + gap, max(high, need.height())
        return boxes
