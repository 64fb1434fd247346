# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The map canvas: painting, zooming, dragging and drawing."""
import math
import time

from python_qt_binding.QtCore import QEvent, QPoint, QPointF, Qt, Signal
from python_qt_binding.QtGui import QImage, QPainter
from python_qt_binding.QtWidgets import QSizePolicy, QToolTip, QWidget

from mhri.base.gui.labels import plain_tip
from mhri.base.gui.long_press import DRAG_PX, LongPress
from mhri.map import gesture
from mhri.map.canvas import Canvas, known_corners, place_words
from mhri.map.gui import map_marks, map_paint
from mhri.map.scene import Scene

ZOOM_STEP = 1.25
# A drag this long draws a heading [px].
AIM_PX = 16
# A click this close to a robot or a mark hits it [px].
_NEAR_PX = 22
# Period of repainting the background with the trails [s]; newer parts are drawn over it.
_TRAILS_S = 1.0
# With "turn" the world is rotated in steps of this [rad].
_TURN_STEP = math.radians(2.0)


class MapCanvas(QWidget):
    """Shows a :class:`mhri.map.scene.Scene`; values in, signals out.

    :param clock: seconds, the clock of the trails
    """

    #: a finished drawing: a :class:`mhri.map.gesture.Act`
    acted = Signal(object)
    #: a click without a tool: the robot there, '' without one
    clicked = Signal(str)
    #: a robot is being dragged from its mark: its name
    carried = Signal(str)
    #: a right click or a long press: position (x, y) [m], and its point on the screen
    menu_requested = Signal(float, float, QPoint)
    #: the tool has changed, or a corner was added
    tool_changed = Signal()
    #: the position of the pointer as text, '' outside
    pointed = Signal(str)
    #: it was painted
    painted = Signal()
    #: zoomed, dragged, following or turning
    view_changed = Signal()

    def __init__(self, parent=None, clock=time.monotonic):
        super().__init__(parent)
        self._clock = clock
        #: the displayed scene
        self.scene = Scene()
        self._grid = self._grid_image = self._memory = None
        #: the background, which rarely changes and is cached
        self.ground = map_paint.Ground()
        self.canvas = Canvas(1, 1)
        self.gesture = gesture.Gesture()
        #: whether the robot in view stays centred; whether its heading is up
        self.follows = self.turns = False
        #: whether trails are coloured by link quality, else by age
        self.by_link = False
        self._fitted = False
        # Length of the shorter side as chosen by the operator [m], None: everything is shown.
        self._span_m = None
        self._taken = (0, 0)
        self._large = True
        self._pressed = self._dragged = None
        # The robot under the press, '' for none; whether a press has to wait for the next repaint.
        self._held = ''
        self._unseen = False
        self._hint = ''
        self._cursor = None
        self._build()
        self._connect()

    def _build(self):
        """Set the fixed properties."""
        self.setObjectName('map_canvas')
        self.setAccessibleName('Map')
        self.setMouseTracking(True)
        self.setFocusPolicy(Qt.NoFocus)
        self.setSizePolicy(QSizePolicy.Expanding, QSizePolicy.Expanding)
        self.setAttribute(Qt.WA_OpaquePaintEvent)
        self._long_press = LongPress(self)

    def _connect(self):
        """Wire the long press."""
        self._long_press.held.connect(self._on_long_press)

    # Content.

    def show_scene(self, scene):
        """Show a scene, and follow the robot in view if enabled."""
        self.scene = scene
        seen = next((robot for robot in scene.robots if robot.looked_at and robot.pose), None)
        if not self._fitted and (self._grid is not None or scene.bounds() is not None) \
                and self.width() > 1:
            self.fit()
        if seen is not None and self._pressed is None and self.gesture.tool == gesture.LOOK:
            if self.turns:
                turn = math.pi / 2.0 - seen.pose.heading_rad
                self._set_canvas(self.canvas.turned(_TURN_STEP * round(turn / _TURN_STEP)))
            if self.follows:
                self._set_canvas(self.canvas.follows(seen.pose.x_m, seen.pose.y_m))
        self.update()

    def show_grid(self, grid):
        """Show another grid map (:class:`mhri.map.grid.Grid`), None without one."""
        self._grid = grid
        self._paint_grid()
        self._fitted = self._fitted and grid is None
        self.update()

    def _paint_grid(self):
        self._grid_image, self._memory = (None, None) if self._grid is None else \
            map_paint.grid_picture(self._grid, self.palette())

    def show_large(self, large):
        """Switch between large, with everything, and small, with only robots and map."""
        self._large = large
        self.update()

    # The viewport.

    def choose(self, follows=None, turns=None, by_link=None):
        """Set the view options; None leaves one unchanged."""
        self.follows = self.follows if follows is None else follows
        self.by_link = self.by_link if by_link is None else by_link
        if turns is not None and turns != self.turns:
            self.turns = turns
            if not turns:
                self._set_canvas(self.canvas.turned(0.0))
        self.show_scene(self.scene)
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
        self._keep_view()
        self.view_changed.emit()

    def fit(self):
        """Show everything: the map, and the placed robots."""
        corners = [corner for corner in self.scene.bounds() or ()]
        if self._grid is not None:
            corners += known_corners(self._grid)
        if corners:
            least, most = map(tuple, ((min(x for x, _ in corners), min(y for _, y in corners)),
                                      (max(x for x, _ in corners), max(y for _, y in corners))))
            self._set_canvas(self.canvas.showing(least, most, self._taken))
            self._fitted, self._span_m = True, None
            self.view_changed.emit()

    def keep_clear(self, taken):
        """Show everything beside what lies over the lower right: its (width, height) [px]."""
        if taken != self._taken:
            self._taken = taken
            if self._fitted and self._span_m is None:
                self.fit()

    def _keep_view(self):
        """Keep what the operator chose to see when the size changes."""
        self._fitted = True
        self._span_m = min(self.width(), self.height()) / self.canvas.px_per_m

    # Drawing.

    def show_hint(self, hint):
        """Show at the pointer what a click would do, and to which robot; '' shows nothing."""
        if hint != self._hint:
            self._hint = hint
            self.update()

    def wait_for_paint(self):
        """Ignore presses until the next repaint: the map is not in sight yet."""
        self._unseen = True

    def choose_tool(self, tool):
        """Select a tool, and take the keyboard focus while it is in use."""
        self.gesture.choose_tool(tool)
        self._pressed = None
        self._take_tool(tool)

    def _take_tool(self, tool):
        """Take cursor and keyboard focus for a tool, or give them back."""
        self.setFocusPolicy(Qt.NoFocus if tool == gesture.LOOK else Qt.StrongFocus)
        if tool == gesture.LOOK:
            self.unsetCursor()
        else:
            self.setCursor(Qt.CrossCursor)
            self.setFocus(Qt.OtherFocusReason)
        self.tool_changed.emit()
        self.update()

    def finish(self):
        """Finish the route or fence being drawn, if it has enough corners."""
        self._end_gesture(self.gesture.finish())

    def _end_gesture(self, act):
        """Deselect the tool, and emit the drawing if it is complete."""
        if act is not None or self.gesture.tool == gesture.LOOK:
            self.choose_tool(gesture.LOOK)
            if act is not None:
                self.acted.emit(act)
        else:
            self.tool_changed.emit()
        self.update()

    def near_m(self):
        """Return the distance within which a click hits something [m]."""
        return _NEAR_PX / self.canvas.px_per_m

    def _at(self, pos):
        return self.canvas.world(pos.x(), pos.y())

    def mousePressEvent(self, event):  # noqa: N802
        """Begin a click, a drag or a gesture; the right button opens the menu."""
        if event.button() == Qt.RightButton:
            self._open_menu(event.pos())
        elif event.button() == Qt.LeftButton and not (
                self._unseen and self.gesture.tool != gesture.LOOK):
            self._pressed, self._dragged = event.pos(), None
            robot = self.scene.at(*self._at(event.pos()), self.near_m())
            self._held = robot.name if robot is not None and not robot.lost else ''
            if self.gesture.tool != gesture.LOOK:
                self.gesture.press(*self._at(event.pos()))
        event.accept()

    def mouseMoveEvent(self, event):  # noqa: N802
        """Drag the map, or draw."""
        self._cursor = event.pos()
        self.pointed.emit(place_words(*self._at(event.pos())))
        if self.gesture.tool == gesture.CARRY and not event.buttons() & Qt.LeftButton:
            # The release went elsewhere: where to is unknown.
            self.choose_tool(gesture.LOOK)
        elif self._pressed is not None:
            if self.gesture.tool == gesture.LOOK:
                self._drag(event.pos())
            self.gesture.drag(*self._at(event.pos()), self._least_m())
        else:
            self._show_pointer(event.pos())
        self.update()

    def _show_pointer(self, pos):
        """Show by the pointer whether there is a robot to be clicked or dragged."""
        if self.gesture.tool == gesture.LOOK:
            if self.scene.at(*self._at(pos), self.near_m()) is None:
                self.unsetCursor()
            else:
                self.setCursor(Qt.PointingHandCursor)

    def _least_m(self):
        """Return how far a drag has to be for a heading, or away from a dragged robot [m]."""
        if not self.gesture.start:
            return AIM_PX / self.canvas.px_per_m
        robot = self.scene.robot(self._held)
        return max(self.near_m(), robot.radius_m if robot is not None else 0.0)

    def _drag(self, pos):
        """Drag the robot under the press, or move the map with the pointer."""
        if self._dragged is None and (pos - self._pressed).manhattanLength() > DRAG_PX:
            if self._held:
                self._carry(self.scene.robot(self._held))
                return
            self._dragged = self._pressed
            if self.follows:
                self.choose(follows=False)
        if self._dragged is not None:
            moved, self._dragged = pos - self._dragged, pos
            self._set_canvas(self.canvas.panned(moved.x(), moved.y()))
            self._keep_view()

    def _carry(self, robot):
        """Start to drag a robot, if it is still on the map."""
        if robot is None or robot.pose is None:
            self._pressed = None
            return
        self.carried.emit(robot.name)
        self.gesture.carry(robot.pose.x_m, robot.pose.y_m)
        self._take_tool(gesture.CARRY)

    def mouseReleaseEvent(self, event):  # noqa: N802
        """End a click, a drag or a gesture."""
        if event.button() != Qt.LeftButton or self._pressed is None:
            return
        dragged, self._pressed, self._dragged = self._dragged, None, None
        place = self._at(event.pos())
        if self.gesture.start and not self.rect().contains(event.pos()):
            self.choose_tool(gesture.LOOK)
        elif self.gesture.tool != gesture.LOOK:
            self._end_gesture(self.gesture.release(*place, self._least_m()))
        elif dragged is None:
            robot = self.scene.at(*place, self.near_m())
            self.clicked.emit(robot.name if robot is not None else '')

    def mouseDoubleClickEvent(self, event):  # noqa: N802
        """Finish a route or a fence at the corner of the first click.

        Any other tool ends with one click, so the first one was before the tool was chosen, e.g.
        on a menu: such a double click acts on nothing.
        """
        if event.button() == Qt.LeftButton and self.gesture.tool in gesture.CORNERS:
            self.finish()
        elif self.gesture.tool == gesture.LOOK:
            self.mousePressEvent(event)

    def _on_long_press(self, _):
        """Open the menu at a long press."""
        if self._pressed is not None and self.gesture.tool == gesture.LOOK:
            pos, self._pressed = self._pressed, None
            self._open_menu(pos)

    def _open_menu(self, pos):
        if self.gesture.tool != gesture.LOOK:
            self.choose_tool(gesture.LOOK)
        self.menu_requested.emit(*self._at(pos), self.mapToGlobal(pos))

    def wheelEvent(self, event):  # noqa: N802
        """Zoom about the pointer."""
        self.zoom(event.angleDelta().y() / 120.0, QPointF(event.pos()) if hasattr(
            event, 'pos') else event.position())
        event.accept()

    def keyPressEvent(self, event):  # noqa: N802
        """Cancel with Escape, finish with Enter, remove a corner with Backspace."""
        if self.gesture.tool == gesture.LOOK:
            event.ignore()
        elif event.key() == Qt.Key_Escape:
            self.choose_tool(gesture.LOOK)
        elif event.key() in (Qt.Key_Return, Qt.Key_Enter):
            self.finish()
        elif event.key() == Qt.Key_Backspace:
            self.gesture.undo()
            self.tool_changed.emit()
            self.update()
        else:
            event.ignore()

    def leaveEvent(self, event):  # noqa: N802
        """Clear the position of the pointer."""
        self._cursor = None
        self.pointed.emit('')
        self.update()

    def resizeEvent(self, event):  # noqa: N802
        """Keep everything in sight or, once the operator has zoomed or moved the map, its view."""
        self._set_canvas(self.canvas.resized(self.width(), self.height()))
        if not self._fitted:
            return
        # From what was chosen, not from the size before: on its way there and back the map would
        # become smaller and smaller.
        if self._span_m is None:
            self.fit()
        else:
            scale = min(self.width(), self.height()) / self._span_m / self.canvas.px_per_m
            self._set_canvas(self.canvas.zoomed(scale, self.width() / 2.0, self.height() / 2.0))

    def changeEvent(self, event):  # noqa: N802
        """Follow the theme."""
        super().changeEvent(event)
        if event.type() == QEvent.PaletteChange:
            self._paint_grid()
            self.update()

    def event(self, event):
        """Show the source of a robot's place as a tool tip."""
        if event.type() == QEvent.ToolTip:
            robot = self.scene.at(*self._at(event.pos()), self.near_m())
            QToolTip.showText(event.globalPos(), plain_tip(self.tip(robot)) if robot else '', self)
            return True
        return super().event(event)

    @staticmethod
    def tip(robot):
        """Return the tool tip of the robot under the pointer."""
        return '{} {}: {}\n{}{}'.format(
            robot.number or '', robot.name, robot.lost or robot.state, robot.text,
            '' if robot.lost else '\ndrag: send {}'.format(robot.name)).strip()

    # Painting.

    def paintEvent(self, event):  # noqa: N802
        """Paint ground, points, goals, marks, robots, and the drawing in progress."""
        painter, palette, scene = QPainter(self), self.palette(), self.scene
        ratio, now_s = self.devicePixelRatioF(), self._clock()
        key = (id(self._grid_image), palette.cacheKey(), scene.fence, self.by_link,
               int(now_s / _TRAILS_S))
        frame = map_paint.stamp(self.ground.pixels(key, self.canvas, ratio, self._paint_ground),
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
        map_marks.paint_flags(painter, self.canvas, palette, scene.flags, self.font())
        # Driven robots are on top.
        robots = sorted(scene.robots, key=lambda robot: (robot.looked_at, robot.selected))
        for robot in robots:
            if robot.pose is not None:
                map_paint.paint_robot(painter, self.canvas, palette, robot, self.font())
        map_paint.paint_labels(painter, self.canvas, palette, robots, self.font(), self._large)
        self._unseen = False
        cursor = None if self._cursor is None else self._at(self._cursor)
        map_marks.paint_drawn(painter, self.canvas, palette, self.gesture, cursor)
        if cursor is not None and self.gesture.tool != gesture.LOOK:
            map_marks.paint_hint(painter, self.canvas, palette, self._hint, cursor,
                                 scene.robot(self._held) if self.gesture.start else None,
                                 self.font())
        map_marks.paint_scale(painter, self.canvas, palette, self.font())
        if self._large and self.by_link:
            map_marks.paint_legend(painter, self.canvas, palette, self.font())
        painter.end()
        self.painted.emit()

    def _paint_ground(self, painter):
        """Paint the cached background."""
        palette = self.palette()
        map_paint.paint_ground(painter, self.canvas, palette, self._grid, self._grid_image)
        map_paint.paint_trails(painter, self.canvas, palette, self.scene.robots, self.by_link,
                               self._clock())
        if self.scene.fence:
            map_paint.paint_fence(painter, self.canvas, palette, self.scene.fence)

    def _paint_tails(self, painter, now_s):
        """Paint the newest end of each trail, which is not in the cached background yet."""
        for robot in self.scene.robots:
            if robot.trail is not None and robot.pose is not None:
                places = robot.trail.tail(now_s - _TRAILS_S)
                if len(places) > 1:
                    painter.setPen(map_paint.trail_ink(robot.number, 0, False, self.palette()))
                    painter.drawPolyline(map_paint.polygon_of(self.canvas.pixels(places)))
