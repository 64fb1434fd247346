# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The map itself: painted, zoomed, dragged, and drawn on."""
import math
import time

from python_qt_binding.QtCore import QEvent, QPoint, QPointF, Qt, QTimer, Signal
from python_qt_binding.QtGui import QImage, QPainter
from python_qt_binding.QtWidgets import QSizePolicy, QToolTip, QWidget

from mhri.base.gui.labels import plain_tip
from mhri.map import gesture
from mhri.map.canvas import Canvas, known_corners, place_words
from mhri.map.gui import map_marks, map_paint
from mhri.map.scene import Scene

ZOOM_STEP = 1.25
# A press that moves by more is a drag, and no click [px]; a heading is drawn by so long a drag.
DRAG_PX, AIM_PX = 8, 16
LONG_PRESS_MS = 600
# A click so near to a robot or a mark is on it [px].
_NEAR_PX = 22
# The ground is painted again as often as this for the trails [s]; what is newer is drawn over it.
_TRAILS_S = 1.0
# With "turn" the world is turned in steps of this [rad].
_TURN_STEP = math.radians(2.0)


class MapCanvas(QWidget):
    """Shows a :class:`mhri.map.scene.Scene`; values in, signals out.

    :param clock: seconds, of the clock that trails are written by
    """

    #: what was drawn: a :class:`mhri.map.gesture.Act`
    acted = Signal(object)
    #: a click without a tool: the robot there, '' for none
    clicked = Signal(str)
    #: a right click or a long press: place (x, y) [m], and where it is on the screen
    menu_requested = Signal(float, float, QPoint)
    #: another tool is in the hand, or a corner more
    tool_changed = Signal()
    #: the place under the pointer in words, '' for none
    pointed = Signal(str)
    #: it was painted
    painted = Signal()
    #: zoomed, dragged, following or turning
    view_changed = Signal()

    def __init__(self, parent=None, clock=time.monotonic):
        super().__init__(parent)
        self._clock = clock
        self._scene = Scene()
        self._grid = self._grid_image = self._memory = None
        self._ground = map_paint.Ground()
        self.canvas = Canvas(1, 1)
        self.gesture = gesture.Gesture()
        self._fitted = self._by_link = self._follows = self._turns = False
        self._large = True
        self._pressed = self._dragged = None
        self._cursor = None
        self._build()
        self._connect()

    def _build(self):
        """Set what never changes."""
        self.setObjectName('map_canvas')
        self.setAccessibleName('Map')
        self.setMouseTracking(True)
        self.setFocusPolicy(Qt.NoFocus)
        self.setSizePolicy(QSizePolicy.Expanding, QSizePolicy.Expanding)
        self.setAttribute(Qt.WA_OpaquePaintEvent)
        self._long_press = QTimer(self)
        self._long_press.setSingleShot(True)
        self._long_press.setInterval(LONG_PRESS_MS)

    def _connect(self):
        """Wire the long press."""
        self._long_press.timeout.connect(self._on_long_press)

    # What is shown.

    @property
    def scene(self):
        """The scene on show."""
        return self._scene

    def show_scene(self, scene):
        """Show a scene; what follows the robot looked at, follows."""
        self._scene = scene
        seen = next((robot for robot in scene.robots if robot.looked_at and robot.pose), None)
        if not self._fitted and (self._grid is not None or scene.bounds() is not None) \
                and self.width() > 1:
            self.fit()
        if seen is not None and self._pressed is None and self.gesture.tool == gesture.LOOK:
            if self._turns:
                turn = math.pi / 2.0 - seen.pose.heading_rad
                self._set_canvas(self.canvas.turned(_TURN_STEP * round(turn / _TURN_STEP)))
            if self._follows:
                self._set_canvas(self.canvas.follows(seen.pose.x_m, seen.pose.y_m))
        self.update()

    def show_grid(self, grid):
        """Show another map of cells (:class:`mhri.map.grid.Grid`); None for none."""
        self._grid = grid
        self._paint_grid()
        self._fitted = self._fitted and grid is None
        self.update()

    def _paint_grid(self):
        self._grid_image, self._memory = (None, None) if self._grid is None else \
            map_paint.grid_picture(self._grid, self.palette())

    def show_large(self, large):
        """Be large, with everything, or small, with robots and map alone."""
        self._large = large
        self.update()

    # How it is looked at.

    @property
    def follows(self):
        """Whether the robot looked at is kept in the middle."""
        return self._follows

    @property
    def turns(self):
        """Whether ahead of the robot looked at is up."""
        return self._turns

    @property
    def by_link(self):
        """Whether the colour of a trail says how good the link was, or else when it was."""
        return self._by_link

    def choose(self, follows=None, turns=None, by_link=None):
        """Choose how it is looked at; None leaves it."""
        self._follows = self._follows if follows is None else follows
        self._by_link = self._by_link if by_link is None else by_link
        if turns is not None and turns != self._turns:
            self._turns = turns
            if not turns:
                self._set_canvas(self.canvas.turned(0.0))
        self.show_scene(self._scene)
        self.view_changed.emit()

    def _set_canvas(self, canvas):
        """Show another part of the world."""
        if canvas != self.canvas:
            self.canvas = canvas
            self.update()

    def zoom(self, steps, at=None):
        """Zoom in (> 0) or out, about a :class:`QPointF` or the middle."""
        at = at or QPointF(self.width() / 2.0, self.height() / 2.0)
        self._set_canvas(self.canvas.zoomed(ZOOM_STEP ** steps, at.x(), at.y()))
        self._fitted = True
        self.view_changed.emit()

    def fit(self):
        """Show all there is: the map, and the robots that are placed."""
        corners = [corner for corner in self._scene.bounds() or ()]
        if self._grid is not None:
            corners += known_corners(self._grid)
        if corners:
            least, most = map(tuple, ((min(x for x, _ in corners), min(y for _, y in corners)),
                                      (max(x for x, _ in corners), max(y for _, y in corners))))
            self._set_canvas(self.canvas.showing(least, most))
            self._fitted = True
            self.view_changed.emit()

    @property
    def grounds_painted(self):
        """How often the ground was painted: what is not drawn anew costs little."""
        return self._ground.painted

    # What is drawn on it.

    def take(self, tool):
        """Take a tool into the hand; the keyboard comes here meanwhile."""
        self.gesture.take(tool)
        self._pressed = None
        self.setFocusPolicy(Qt.NoFocus if tool == gesture.LOOK else Qt.StrongFocus)
        if tool == gesture.LOOK:
            self.unsetCursor()
        else:
            self.setCursor(Qt.CrossCursor)
            self.setFocus(Qt.OtherFocusReason)
        self.tool_changed.emit()
        self.update()

    def finish(self):
        """End the route or the fence that is drawn, if it has enough corners."""
        self._tell(self.gesture.finish())

    def _tell(self, act):
        """Put the tool away and tell what was drawn, if it is complete."""
        if act is not None:
            self.take(gesture.LOOK)
            self.acted.emit(act)
        else:
            self.tool_changed.emit()
        self.update()

    def near_m(self):
        """Return how near to something a click is on it [m]."""
        return _NEAR_PX / self.canvas.px_per_m

    def _at(self, pos):
        return self.canvas.world(pos.x(), pos.y())

    def mousePressEvent(self, event):  # noqa: N802
        """Begin a click, a drag or a gesture; the right button opens the menu."""
        if event.button() == Qt.RightButton:
            self._open_menu(event.pos())
        elif event.button() == Qt.LeftButton:
            self._pressed, self._dragged = event.pos(), None
            if self.gesture.tool == gesture.LOOK:
                self._long_press.start()
            else:
                self.gesture.press(*self._at(event.pos()))
        event.accept()

    def mouseMoveEvent(self, event):  # noqa: N802
        """Drag the map, or draw."""
        self._cursor = event.pos()
        self.pointed.emit(place_words(*self._at(event.pos())))
        if self._pressed is not None:
            self.gesture.drag(*self._at(event.pos()), AIM_PX / self.canvas.px_per_m)
            if self.gesture.tool == gesture.LOOK:
                self._drag(event.pos())
        self.update()

    def _drag(self, pos):
        """Move the map with the pointer."""
        if self._dragged is None and (pos - self._pressed).manhattanLength() > DRAG_PX:
            self._long_press.stop()
            self._dragged = self._pressed
            if self._follows:
                self.choose(follows=False)
        if self._dragged is not None:
            moved, self._dragged = pos - self._dragged, pos
            self._fitted = True
            self._set_canvas(self.canvas.panned(moved.x(), moved.y()))

    def mouseReleaseEvent(self, event):  # noqa: N802
        """End a click, a drag or a gesture."""
        self._long_press.stop()
        if event.button() != Qt.LeftButton or self._pressed is None:
            return
        dragged, self._pressed, self._dragged = self._dragged, None, None
        place = self._at(event.pos())
        if self.gesture.tool != gesture.LOOK:
            self._tell(self.gesture.release(*place, AIM_PX / self.canvas.px_per_m))
        elif dragged is None:
            robot = self._scene.at(*place, self.near_m())
            self.clicked.emit(robot.name if robot is not None else '')

    def mouseDoubleClickEvent(self, event):  # noqa: N802
        """End a route or a fence at the corner that the first click has made."""
        if event.button() == Qt.LeftButton and self.gesture.tool in gesture.CORNERS:
            self.finish()
        else:
            self.mousePressEvent(event)

    def _on_long_press(self):
        """Open the menu where a finger rests."""
        if self._pressed is not None:
            pos, self._pressed = self._pressed, None
            self._open_menu(pos)

    def _open_menu(self, pos):
        self._long_press.stop()
        if self.gesture.tool != gesture.LOOK:
            self.take(gesture.LOOK)
        self.menu_requested.emit(*self._at(pos), self.mapToGlobal(pos))

    def wheelEvent(self, event):  # noqa: N802
        """Zoom about the pointer."""
        self.zoom(event.angleDelta().y() / 120.0, QPointF(event.pos()) if hasattr(
            event, 'pos') else event.position())
        event.accept()

    def keyPressEvent(self, event):  # noqa: N802
        """Cancel with Escape, end with Enter, take a corner back with Backspace."""
        if self.gesture.tool == gesture.LOOK:
            event.ignore()
        elif event.key() == Qt.Key_Escape:
            self.take(gesture.LOOK)
        elif event.key() in (Qt.Key_Return, Qt.Key_Enter):
            self.finish()
        elif event.key() == Qt.Key_Backspace:
            self.gesture.undo()
            self.tool_changed.emit()
            self.update()
        else:
            event.ignore()

    def leaveEvent(self, event):  # noqa: N802
        """Forget the pointer."""
        self._cursor = None
        self.pointed.emit('')
        self.update()

    def resizeEvent(self, event):  # noqa: N802
        """Keep the same place in the middle."""
        before = self.canvas
        self._set_canvas(before.resized(self.width(), self.height()))
        # As much of the world as before is on show.
        if before.width > 1 and self._fitted:
            factor = min(self.width() / before.width, self.height() / before.height)
            self._set_canvas(self.canvas.zoomed(factor, self.width() / 2.0, self.height() / 2.0))

    def changeEvent(self, event):  # noqa: N802
        """Follow the theme."""
        super().changeEvent(event)
        if event.type() == QEvent.PaletteChange:
            self._paint_grid()
            self.update()

    def event(self, event):
        """Say of a robot what its place rests on."""
        if event.type() == QEvent.ToolTip:
            robot = self._scene.at(*self._at(event.pos()), self.near_m())
            QToolTip.showText(event.globalPos(), plain_tip(self.tip(robot)) if robot else '', self)
            return True
        return super().event(event)

    @staticmethod
    def tip(robot):
        """Return what is said of a robot under the pointer."""
        return '{} {}: {}\n{}'.format(robot.number or '', robot.name, robot.state,
                                      robot.text).strip()

    # How it is painted.

    def paintEvent(self, event):  # noqa: N802
        """Paint ground, points, goals, marks, robots, and what is being drawn."""
        painter, palette, scene = QPainter(self), self.palette(), self._scene
        ratio, now_s = self.devicePixelRatioF(), self._clock()
        key = (id(self._grid_image), palette.cacheKey(), scene.fence, self._by_link,
               int(now_s / _TRAILS_S))
        frame = map_paint.stamp(self._ground.pixels(key, self.canvas, ratio, self._paint_ground),
                                self.canvas, ratio, scene.robots, palette)
        height, width = frame.shape
        image = QImage(frame.data, width, height, 4 * width, QImage.Format_RGB32)
        image.setDevicePixelRatio(ratio)
        painter.drawImage(QPointF(0, 0), image)
        painter.setRenderHint(QPainter.Antialiasing)
        self._paint_tails(painter, now_s)
        for goal in scene.goals:
            map_marks.paint_goal(painter, self.canvas, palette, goal, scene, self.font())
        map_marks.paint_leaders(painter, self.canvas, palette, scene)
        for mark in scene.marks:
            map_marks.paint_mark(painter, self.canvas, palette, mark, self.font())
        # Those that are driven lie on top.
        for robot in sorted(scene.robots, key=lambda robot: (robot.looked_at, robot.selected)):
            if robot.pose is not None:
                map_paint.paint_robot(painter, self.canvas, palette, robot, self.font())
        cursor = None if self._cursor is None else self._at(self._cursor)
        map_marks.paint_drawn(painter, self.canvas, palette, self.gesture, cursor)
        map_marks.paint_scale(painter, self.canvas, palette, self.font())
        if self._large and self._by_link:
            map_marks.paint_legend(painter, self.canvas, palette, self.font())
        painter.end()
        self.painted.emit()

    def _paint_ground(self, painter):
        """Paint what seldom changes."""
        palette = self.palette()
        map_paint.paint_ground(painter, self.canvas, palette, self._grid, self._grid_image)
        map_paint.paint_trails(painter, self.canvas, palette, self._scene.robots, self._by_link,
                               self._clock())
        if self._scene.fence:
            map_paint.paint_fence(painter, self.canvas, palette, self._scene.fence)

    def _paint_tails(self, painter, now_s):
        """Paint the newest end of each trail, which the ground does not have yet."""
        for robot in self._scene.robots:
            if robot.trail is not None and robot.pose is not None:
                places = robot.trail.tail(now_s - _TRAILS_S)
                if len(places) > 1:
                    painter.setPen(map_paint.trail_ink(robot.number, 0, False, self.palette()))
                    painter.drawPolyline(map_paint.polygon_of(self.canvas.pixels(places)))
