# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A round pad with a knob that springs back: the virtual joystick, and axes of accessories."""
import math

from python_qt_binding.QtCore import QEvent, QPointF, QRectF, Qt, Signal
from python_qt_binding.QtGui import QPalette, QPen
from python_qt_binding.QtWidgets import QWidget

from mhri.base.gui import theme
from mhri.base.gui.painting import Sized
from mhri.driving.gui.hold_limit import HoldLimit

CENTRE_SNAP = 0.08  # largest deflection that is still neutral
AXIS_SNAP = 0.06    # largest deflection of one axis that still counts as 0, to drive straight

#: height of the caption above the pad [line heights]
CAPTION_LINES = 1.4
#: fraction of the pad's radius for the travel of the knob; the rest is for the knob
TRAVEL_SHARE = 0.72
_MAX_LINES = 22    # a pad beyond a hand's reach is slower to use, not more precise

# Events that take the pointer or a control's visibility away release what it holds.
_LOSSES = frozenset((QEvent.WindowDeactivate, QEvent.WindowBlocked, QEvent.Hide, QEvent.FocusOut,
                     QEvent.UngrabMouse, QEvent.TouchCancel))
_TOUCHES = frozenset((QEvent.TouchBegin, QEvent.TouchUpdate, QEvent.TouchEnd))


def is_lost(widget, event):
    """Return whether an event takes a control away from who holds it."""
    kind = event.type()
    return kind in _LOSSES or kind == QEvent.EnabledChange and not widget.isEnabled()


def deflection_of(across, along):
    """Convert the position of the knob into a deflection.

    :param across: distance to the right of the centre, in radii of the knob's travel
    :param along: distance above the centre, in radii
    :returns: (forward, turn), within the unit circle; forward + is ahead, turn + is left; 0 within
        the dead zone, and continuous at its edge
    """
    radius = math.hypot(across, along)
    if radius <= CENTRE_SNAP:
        return 0.0, 0.0
    fraction = (min(1.0, radius) - CENTRE_SNAP) / (1.0 - CENTRE_SNAP)
    return _snapped(along / radius * fraction), _snapped(-across / radius * fraction)


def _snapped(value):
    """Return the value of one axis with its dead zone."""
    size = (abs(value) - AXIS_SNAP) / (1.0 - AXIS_SNAP)
    return math.copysign(min(1.0, size), value) if size > 0.0 else 0.0


class SpringPad(Sized, QWidget):
    """A pad for mouse or touch; what it holds is in a subclass.

    The knob follows the pointer while it is held and is neutral at any other time: on release, when
    the window loses the focus, is hidden, blocked or disabled, or when the pointer is lost. On a
    remote display (``limit``) also when the pointer has not moved for a second.
    """

    #: its arrows, from the top clockwise: 0 to 3
    ARROWS = (0, 1, 2, 3)

    #: it was released since no events came from the remote display
    ran_out = Signal()

    def __init__(self, parent=None):
        super().__init__(parent)
        self._dragging = False
        self._knob = (0.0, 0.0)
        self._active = True
        self._touch_id = None
        # A scripted drive holds it, not an operator on a remote display.
        self._made_up = False
        self.limit = HoldLimit(self)
        self.limit.ran_out.connect(self._run_out)
        self.setAttribute(Qt.WA_AcceptTouchEvents)
        # A move without a button shows that the release was lost.
        self.setMouseTracking(True)

    @property
    def dragging(self):
        """Whether a pointer holds the knob."""
        return self._dragging

    def centre(self):
        """Release the knob, wherever the pointer is; it has to be grabbed again."""
        self._touch_id = None
        self.limit.end()
        if self._dragging:
            self._dragging = False
            self._place_knob(0.0, 0.0)
            self._hold(0.0, 0.0)

    def _hold(self, across, along):
        """Handle a new place of the knob in radii of its travel: to the right, and up."""
        raise NotImplementedError

    def _is_strong(self, quarter):
        """Return whether to stress one of :attr:`ARROWS`."""
        return False

    def _run_out(self):
        """Release the knob after a time without events from the remote display."""
        self.centre()
        self.ran_out.emit()

    def pad(self):
        """Return the rectangle of the pad, below the caption."""
        return QRectF(self.rect()).adjusted(
            0, CAPTION_LINES * self.fontMetrics().height(), 0, 0)

    def show_active(self, active):
        """Show whether it has an effect; otherwise it moves without one."""
        if active != self._active:
            self._active = active
            self.update()

    def event(self, event):
        """Follow a touch, and release the knob on every kind of loss."""
        if is_lost(self, event):
            self.centre()
        elif event.type() in _TOUCHES:
            self._on_touch(event)
            event.accept()
            return True
        return super().event(event)

    def mousePressEvent(self, event):  # noqa: N802
        """Grab the knob."""
        if event.button() == Qt.LeftButton and self._touch_id is None \
                and self.pad().contains(event.localPos()):
            self._made_up = not event.spontaneous()
            self._take(event.localPos())

    def mouseMoveEvent(self, event):  # noqa: N802
        """Move the knob."""
        if not self._dragging or self._touch_id is not None:
            return
        if event.buttons() & Qt.LeftButton:
            self._follow(event.localPos())
        else:
            self.centre()

    def mouseReleaseEvent(self, event):  # noqa: N802
        """Release the knob."""
        if event.button() == Qt.LeftButton and self._touch_id is None:
            self.centre()

    def _on_touch(self, event):
        """Follow the first finger; further ones are ignored."""
        for point in event.touchPoints():
            if self._touch_id is None and point.state() == Qt.TouchPointPressed \
                    and self.pad().contains(point.pos()):
                self._touch_id = point.id()
                self._made_up = False
                self._take(point.pos())
            elif point.id() == self._touch_id:
                if point.state() == Qt.TouchPointReleased:
                    self.centre()
                else:
                    self._follow(point.pos())
        if event.type() == QEvent.TouchEnd:
            self.centre()

    def _take(self, pos):
        """Start following a pointer."""
        self._dragging = True
        self._follow(pos)

    def _follow(self, pos):
        """Place the knob at the pointer, and hold it there."""
        if not self._made_up:
            self.limit.renew()
        middle, travel = self.pad().center(), self.travel()
        across = (pos.x() - middle.x()) / travel if 1 in self.ARROWS else 0.0
        along = (middle.y() - pos.y()) / travel
        self._place_knob(across, along)
        self._hold(across, along)

    def _place_knob(self, across, along):
        """Show the knob at a position in radii of its travel, clipped to the circle."""
        excess = max(1.0, math.hypot(across, along))
        place = (across / excess, along / excess)
        if place != self._knob:
            self._knob = place
            self.update()

    def travel(self):
        """Return the knob's travel from the centre [px], for a deflection of 1."""
        most = self.fontMetrics().height() * _MAX_LINES
        pad = self.pad()
        return max(8.0, min(pad.width(), pad.height(), most) / 2.0 - 3.0) * TRAVEL_SHARE

    def _paint_caption(self, painter, text):
        """Paint a text on a dark ground above the pad, '' for none."""
        metrics = self.fontMetrics()
        if not text:
            return
        width = min(self.width(), metrics.horizontalAdvance(text) + metrics.height())
        ground = QRectF((self.width() - width) / 2.0, 0, width, 1.2 * metrics.height())
        theme.set_ink(painter, brush=theme.OVER_PICTURE)
        painter.drawRoundedRect(ground, 4, 4)
        painter.setPen(Qt.white)
        painter.drawText(ground, int(Qt.AlignCenter), text)

    def _paint_all(self, painter):
        """Paint the pad and the knob."""
        middle, travel = self.pad().center(), self.travel()
        self._paint_pad(painter, middle, travel)
        knob = QPointF(middle.x() + self._knob[0] * travel, middle.y() - self._knob[1] * travel)
        self._paint_knob(painter, middle, knob, travel / TRAVEL_SHARE * 0.27)

    def _paint_pad(self, painter, middle, travel):
        """Paint the static parts."""
        palette = self.palette()
        pad = travel / TRAVEL_SHARE
        line = theme.line_colour(palette)
        theme.set_ink(painter, QPen(line, 2, Qt.SolidLine if self._active else Qt.DashLine),
                      palette.color(QPalette.Base) if self._active else Qt.NoBrush)
        painter.drawEllipse(middle, pad, pad)
        theme.set_ink(painter, QPen(line, 1, Qt.DotLine))
        painter.drawEllipse(middle, travel, travel)
        painter.drawLine(QPointF(middle.x() - travel, middle.y()),
                         QPointF(middle.x() + travel, middle.y()))
        painter.drawLine(QPointF(middle.x(), middle.y() - travel),
                         QPointF(middle.x(), middle.y() + travel))
        painter.setPen(Qt.NoPen)
        calm = theme.blend(line, palette.color(QPalette.WindowText), 0.35)
        for quarter in self.ARROWS:
            aside = self._is_strong(quarter)
            painter.setBrush(theme.colour(theme.DRIVE, palette) if aside else calm)
            painter.save()
            painter.translate(middle)
            painter.rotate(90.0 * quarter)
            tip, wide = pad * 0.93, pad * (0.1 if aside else 0.055)
            painter.drawPolygon(QPointF(0, -tip), QPointF(wide, wide * 1.5 - tip),
                                QPointF(-wide, wide * 1.5 - tip))
            painter.restore()

    def _paint_knob(self, painter, middle, knob, radius):
        """Paint the moving parts."""
        palette = self.palette()
        ink = theme.colour(theme.DRIVE if self._active else theme.MUTED, palette)
        if self._knob != (0.0, 0.0):
            painter.setPen(QPen(ink, max(3.0, radius * 0.16), Qt.SolidLine, Qt.RoundCap))
            painter.drawLine(middle, knob)
        away = self._dragging or self._knob != (0.0, 0.0)
        theme.set_ink(painter, QPen(ink, 3), ink if away else palette.color(QPalette.Button))
        painter.drawEllipse(knob, radius, radius)
        if not away:
            theme.set_ink(painter, brush=ink)
            painter.drawEllipse(knob, radius * 0.28, radius * 0.28)
