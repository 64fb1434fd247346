# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The virtual joystick: a round pad with a knob that springs back."""
import math

from python_qt_binding.QtCore import QEvent, QPointF, QRectF, QSize, Qt, Signal
from python_qt_binding.QtGui import QPainter, QPalette, QPen
from python_qt_binding.QtWidgets import QSizePolicy, QWidget

from mhri.base.gui import theme
from mhri.driving.gui.hold_limit import HoldLimit

CENTRE_SNAP = 0.08  # deflection that still is neutral
AXIS_SNAP = 0.06    # deflection of one axis that still is straight, so that one can drive a line

_TRAVEL_SHARE = 0.72  # of the pad's radius; the rest is for the knob
_MOST_LINES = 22    # a pad larger than a hand's reach is slower, not finer

# Whatever takes the pointer or the operator's eye away from the pad lets the stick go.
_LOSSES = frozenset((QEvent.WindowDeactivate, QEvent.WindowBlocked, QEvent.Hide, QEvent.FocusOut,
                     QEvent.UngrabMouse, QEvent.TouchCancel))
_TOUCHES = frozenset((QEvent.TouchBegin, QEvent.TouchUpdate, QEvent.TouchEnd))


def deflection_of(across, along):
    """Turn the place of the knob into a deflection.

    :param across: to the right of the centre, in radii of the pad's travel
    :param along: above the centre, in radii
    :returns: (forward, turn), within the unit circle; forward + is ahead, turn + is left; 0 within
        the dead centre, from there on without a step
    """
    radius = math.hypot(across, along)
    if radius <= CENTRE_SNAP:
        return 0.0, 0.0
    fraction = (min(1.0, radius) - CENTRE_SNAP) / (1.0 - CENTRE_SNAP)
    return _snapped(along / radius * fraction), _snapped(-across / radius * fraction)


def _snapped(value):
    """Return one axis with its own dead centre."""
    size = (abs(value) - AXIS_SNAP) / (1.0 - AXIS_SNAP)
    return math.copysign(min(1.0, size), value) if size > 0.0 else 0.0


class VirtualJoystick(QWidget):
    """Rotation and translation at once, by mouse or touch.

    The knob follows the pointer while it is held and is neutral at any other time: on release, when
    the window loses the focus, is hidden, blocked or disabled, or when the pointer is lost. On a
    remote display (``limit``) also when the pointer has not moved for a second.
    """

    #: forward (ahead +) and turn (left +), each in [-1, 1]; on every change, at once
    moved = Signal(float, float)
    #: it was let go since nothing came from the remote display
    ran_out = Signal()

    def __init__(self, parent=None):
        super().__init__(parent)
        self._dragging = False
        self._deflection = (0.0, 0.0)
        self._knob = (0.0, 0.0)
        self._active = True
        self._touch_id = None
        # A scripted drive holds it, and no hand over a connection.
        self._made_up = False
        self.limit = HoldLimit(self)
        self.limit.ran_out.connect(self._run_out)
        self.setAttribute(Qt.WA_AcceptTouchEvents)
        # Seen without a button, a move says that the release was lost.
        self.setMouseTracking(True)
        self.setSizePolicy(QSizePolicy.Expanding, QSizePolicy.Expanding)

    @property
    def dragging(self):
        """Whether a pointer holds the knob."""
        return self._dragging

    def deflection(self):
        """Return (forward, turn) as held by the pointer; (0, 0) while nobody holds the knob."""
        return self._deflection

    def centre(self):
        """Let the knob go, wherever the pointer is; it has to be taken again."""
        self._touch_id = None
        self.limit.end()
        if self._dragging:
            self._dragging = False
            self._set_deflection((0.0, 0.0))
        self.show_keys(0.0, 0.0)

    def _run_out(self):
        """Let go what nobody has shown to be held still."""
        self.centre()
        self.ran_out.emit()

    def show_keys(self, forward, turn):
        """Show a deflection held by keys; the pointer wins while it holds the knob."""
        if not self._dragging:
            self._place_knob(-turn, forward)

    def show_active(self, active):
        """Show whether this stick is the one that drives; it moves without effect otherwise."""
        if active != self._active:
            self._active = active
            self.update()

    def sizeHint(self):  # noqa: N802
        """Return a comfortable size."""
        side = self.fontMetrics().height() * 13
        return QSize(side, side)

    def minimumSizeHint(self):  # noqa: N802
        """Return the least that can be steered with."""
        side = self.fontMetrics().height() * 7
        return QSize(side, side)

    def event(self, event):
        """Follow a touch, and let go on every kind of loss."""
        kind = event.type()
        if kind in _LOSSES or (kind == QEvent.EnabledChange and not self.isEnabled()):
            self.centre()
        elif kind in _TOUCHES:
            self._on_touch(event)
            event.accept()
            return True
        return super().event(event)

    def mousePressEvent(self, event):  # noqa: N802
        """Take the knob."""
        if event.button() == Qt.LeftButton and self._touch_id is None:
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
        """Let the knob go."""
        if event.button() == Qt.LeftButton and self._touch_id is None:
            self.centre()

    def _on_touch(self, event):
        """Follow the first finger; further ones are for other things."""
        for point in event.touchPoints():
            if self._touch_id is None and point.state() == Qt.TouchPointPressed:
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
        """Begin to follow a pointer."""
        self._dragging = True
        self._follow(pos)

    def _follow(self, pos):
        """Place the knob where the pointer is, at most at the rim."""
        if not self._made_up:
            self.limit.renew()
        middle, travel = QRectF(self.rect()).center(), self.travel()
        across = (pos.x() - middle.x()) / travel
        along = (middle.y() - pos.y()) / travel
        excess = max(1.0, math.hypot(across, along))
        self._place_knob(across / excess, along / excess)
        self._set_deflection(deflection_of(across, along))

    def _set_deflection(self, deflection):
        """Tell of a changed deflection."""
        if deflection != self._deflection:
            self._deflection = deflection
            self.moved.emit(*deflection)

    def _place_knob(self, across, along):
        """Show the knob at a place in radii of its travel; outside the circle it stays on it."""
        excess = max(1.0, math.hypot(across, along))
        place = (across / excess, along / excess)
        if place != self._knob:
            self._knob = place
            self.update()

    def travel(self):
        """Return how far [px] the knob travels from the centre of the widget: deflection 1."""
        most = self.fontMetrics().height() * _MOST_LINES
        return max(8.0, min(self.width(), self.height(), most) / 2.0 - 3.0) * _TRAVEL_SHARE

    def paintEvent(self, event):  # noqa: N802
        """Paint the pad and the knob."""
        painter = QPainter(self)
        painter.setRenderHint(QPainter.Antialiasing)
        middle, travel = QRectF(self.rect()).center(), self.travel()
        self._paint_pad(painter, middle, travel)
        knob = QPointF(middle.x() + self._knob[0] * travel, middle.y() - self._knob[1] * travel)
        self._paint_knob(painter, middle, knob, travel / _TRAVEL_SHARE * 0.27)

    def _paint_pad(self, painter, middle, travel):
        """Paint what stands still."""
        palette = self.palette()
        pad = travel / _TRAVEL_SHARE
        line = theme.line_colour(palette)
        painter.setPen(QPen(line, 2, Qt.SolidLine if self._active else Qt.DashLine))
        painter.setBrush(palette.color(QPalette.Base) if self._active else Qt.NoBrush)
        painter.drawEllipse(middle, pad, pad)
        painter.setBrush(Qt.NoBrush)
        painter.setPen(QPen(line, 1, Qt.DotLine))
        painter.drawEllipse(middle, travel, travel)
        painter.drawLine(QPointF(middle.x() - travel, middle.y()),
                         QPointF(middle.x() + travel, middle.y()))
        painter.drawLine(QPointF(middle.x(), middle.y() - travel),
                         QPointF(middle.x(), middle.y() + travel))
        painter.setPen(Qt.NoPen)
        painter.setBrush(theme.blend(line, palette.color(QPalette.WindowText), 0.35))
        for quarter in range(4):
            painter.save()
            painter.translate(middle)
            painter.rotate(90.0 * quarter)
            tip, wide = pad * 0.93, pad * 0.055
            painter.drawPolygon(QPointF(0, -tip), QPointF(wide, wide * 1.5 - tip),
                                QPointF(-wide, wide * 1.5 - tip))
            painter.restore()

    def _paint_knob(self, painter, middle, knob, radius):
        """Paint what moves."""
        palette = self.palette()
        ink = theme.colour(theme.DRIVE if self._active else theme.MUTED, palette)
        if self._knob != (0.0, 0.0):
            painter.setPen(QPen(ink, max(3.0, radius * 0.16), Qt.SolidLine, Qt.RoundCap))
            painter.drawLine(middle, knob)
        away = self._dragging or self._knob != (0.0, 0.0)
        painter.setPen(QPen(ink, 3))
        painter.setBrush(ink if away else palette.color(QPalette.Button))
        painter.drawEllipse(knob, radius, radius)
        if not away:
            painter.setPen(Qt.NoPen)
            painter.setBrush(ink)
            painter.drawEllipse(knob, radius * 0.28, radius * 0.28)
