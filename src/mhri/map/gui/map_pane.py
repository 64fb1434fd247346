# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The map pane: tools above the map, zoom at its side, and messages below it."""
from python_qt_binding.QtCore import QPoint, QSize, Signal
from python_qt_binding.QtGui import QPainter, QPalette
from python_qt_binding.QtWidgets import QPushButton, QSizePolicy, QWidget

from mhri.base.gui import theme, words
from mhri.base.gui.flow import FlowLayout, let_height_follow
from mhri.base.gui.labels import TextLine
from mhri.base.gui.layouts import in_column, in_row, TIGHT
from mhri.driving.gui.robot_menu import popup
from mhri.map import gesture
from mhri.map.canvas import place_words
from mhri.map.gui.map_canvas import MapCanvas
from mhri.map.gui.map_menu import fit_rows, place_menu
from mhri.map.gui.map_strip import NameField, UnplacedStrip

TOOLS = {gesture.GOTO: 'Go to', gesture.ROUTE: 'Route', gesture.LEADER: 'Leader',
         gesture.FENCE: 'Fence', gesture.PLACE: 'Place', gesture.MARK: 'Mark'}
_TIPS = {gesture.GOTO: 'send the robot you clicked, else the selected ones, to a place',
         gesture.ROUTE: 'let them patrol along a route', gesture.LEADER: 'let them follow a robot',
         gesture.FENCE: 'draw the fence that no task leaves',
         gesture.PLACE: 'say where the robot stands and looks',
         gesture.MARK: 'give a place a name'}
NOBODY = 'Select a robot first.'
NO_MARK_NAME = 'The mark needs a name.'
# Tools that act on robots.
_FOR_ROBOTS = (gesture.GOTO, gesture.ROUTE, gesture.LEADER, gesture.PLACE)
TRAILS = ('By time', 'By link')
# Space between two buttons [px].
_GAP = 4


class MapPane(QWidget):
    """A :class:`MapCanvas` with its controls; values in, signals out.

    Child widgets: ``tool_<tool>``, ``fit_button``, ``done_button``, ``cancel_button``, ``closer``,
    ``wider``, ``all_button``, ``follow_button``, ``turn_button``, ``trails_button``.
    """

    #: robots to a :class:`Pose`; whether its heading was drawn
    goal_drawn = Signal(list, object, bool)
    #: robots along corners
    route_drawn = Signal(list, list)
    #: robots that follow a leader, and the leader
    leader_chosen = Signal(list, str)
    #: a right click or a long press on a robot: its name, and the :class:`QPoint` on the desktop
    robot_menu_requested = Signal(str, QPoint)
    #: corners; none: no fence
    fence_drawn = Signal(list)
    #: a robot and its pose; None: undo that
    robot_placed = Signal(str, object)
    #: a robot, and the robot whose scan it is fitted to; '': the map
    fit_requested = Signal(str, str)
    #: a mark's name, and its pose; None: remove it
    mark_set = Signal(str, object)
    #: a click on a robot
    look_requested = Signal(str)
    #: a click on the small map
    swap_requested = Signal()
    #: the tool was deselected
    done = Signal()

    def __init__(self, parent=None):
        super().__init__(parent)
        self.large = True
        self._names = ()
        #: parameters of the task that is drawn, beside its places: {name: value}
        self.given = {}
        #: the robot clicked last, '' once others were selected or looked at
        self.clicked = ''
        self._tool = gesture.LOOK
        self._answer = ('', theme.TEXT)
        self._build()
        self._connect()
        self._restore()

    def _build(self):
        """Make and place the parts."""
        self.setObjectName('map_pane')
        self.setAutoFillBackground(True)
        self.setFont(theme.base_font(self.font()))
        self.view = MapCanvas(self)
        self.line = TextLine(self)
        self.line.setObjectName('map_line')
        self.place_label = TextLine(self)
        self.place_label.setFont(theme.number_font(self.font()))
        self.place_label.fix_width(place_words(-888.88, -888.88))
        self._build_head()
        foot = in_row((self.line, 1), self.place_label, margins=(8, 0, 8, 3))
        in_column(self.head, (self.view, 1), foot, of=self, margins=TIGHT, gap=4)
        self._build_over()

    def _build_head(self):
        """Create the tools, wrapped to a second line if necessary."""
        self.head = QWidget(self)
        self.head.setContentsMargins(_GAP, _GAP, _GAP, 0)
        row = FlowLayout(self.head, _GAP, _GAP)
        let_height_follow(self.head)
        self.tools = {tool: self._button('tool_' + tool, text, row, _TIPS[tool], True)
                      for tool, text in TOOLS.items()}
        self.fit_button = self._button(
            'fit_button', 'Fit', row, 'find the robot by its laser scan')
        space = QWidget(self.head)
        space.setMinimumSize(1, 1)
        space.setSizePolicy(QSizePolicy.Expanding, QSizePolicy.Fixed)
        row.addWidget(space)
        self.done_button = self._button('done_button', 'Done', row, 'finish the drawing (Enter)')
        self.cancel_button = self._button('cancel_button', 'Cancel', row, 'discard it (Esc)')
        for button in (self.done_button, self.cancel_button):
            # The map must not move when they appear: the operator is about to draw on it.
            policy = button.sizePolicy()
            policy.setRetainSizeWhenHidden(True)
            button.setSizePolicy(policy)

    def _build_over(self):
        """Create the overlays of the map."""
        self.side = QWidget(self.view)
        column = FlowLayout(self.side, _GAP, _GAP)
        self.closer = self._button('closer', '+', column, 'larger (+)')
        self.wider = self._button('wider', '−', column, 'smaller (-)')
        self.all_button = self._button('all_button', 'All', column, 'show everything')
        self.follow_button = self._button(
            'follow_button', 'Follow', column, 'keep the robot you look at in view', True)
        self.turn_button = self._button(
            'turn_button', 'Turn', column, 'ahead of the robot you look at is up', True)
        self.trails_button = self._button(
            'trails_button', TRAILS[0], column,
            'what the colour of a trail says: when a robot was there, or how good its link was')
        buttons = self.side.findChildren(QPushButton)
        for button in buttons:
            button.setMinimumWidth(max(each.minimumWidth() for each in buttons))
        self.strip = UnplacedStrip(self.view)
        self.name_field = NameField(self.view)

    def _button(self, name, text, layout, tip, checkable=False):
        """Create a button of finger size; a click does not take the keyboard focus from driving.

        Tab reaches it.
        """
        button = theme.finger_button(self, name, text, tip, room=0.5)
        button.setCheckable(checkable)
        layout.addWidget(button)
        return button

    def _connect(self):
        """Wire tools, buttons and the map."""
        for tool, button in self.tools.items():
            button.clicked.connect(lambda checked, tool=tool: self.choose_tool(
                tool if checked else gesture.LOOK))
        self.fit_button.clicked.connect(lambda: self.offer_fits())
        self.done_button.clicked.connect(self.view.finish)
        self.cancel_button.clicked.connect(lambda: self.choose_tool(gesture.LOOK))
        self.closer.clicked.connect(lambda: self.view.zoom(1))
        self.wider.clicked.connect(lambda: self.view.zoom(-1))
        self.all_button.clicked.connect(self.view.fit)
        self.follow_button.clicked.connect(lambda on: self.view.choose(follows=on))
        self.turn_button.clicked.connect(lambda on: self.view.choose(turns=on))
        self.trails_button.clicked.connect(
            lambda: self.view.choose(by_link=not self.view.by_link))
        self.strip.chosen.connect(lambda name: self.choose_tool(gesture.PLACE, (name,)))
        self.name_field.named.connect(self._on_named)
        self.name_field.cancelled.connect(self.done)
        self.view.acted.connect(self._on_act)
        self.view.clicked.connect(self._on_click)
        self.view.carried.connect(self._on_carried)
        self.view.menu_requested.connect(self._open_menu)
        self.view.tool_changed.connect(self._on_tool)
        self.view.view_changed.connect(self._show_choices)
        self.view.pointed.connect(lambda text: self.place_label.show_text(text, theme.MUTED))

    def _restore(self):
        """Start without a tool."""
        self._show_tool()
        self._show_choices()

    # Showing.

    def show_scene(self, scene):
        """Show a :class:`mhri.map.scene.Scene`."""
        before = self.view.scene
        seen = next((robot.name for robot in scene.robots if robot.looked_at), '')
        was = next((robot.name for robot in before.robots if robot.looked_at), '')
        if scene.selected != before.selected or seen not in (was, self.clicked):
            # The operator has selected other robots since.
            self.clicked = ''
        self.view.show_scene(scene)
        self.strip.show_robots(scene.robots, scene.answers, self.large)
        self._place_over()

    def targets(self):
        """Return the addressed robots: the one clicked here, else those of the scene."""
        return self.view.scene.targets(self.clicked)

    def show_answer(self, text, good=True):
        """Show the outcome of an action below the map, until the next one."""
        self._answer = text, theme.TEXT if good else theme.ATTENTION
        self._show_tool()

    def show_large(self, large):
        """Switch between the large pane with its tools and a small one, which a click enlarges."""
        if large == self.large:
            return
        self.large = large
        if not large:
            self.choose_tool(gesture.LOOK)
            self.name_field.hide()
        self.view.show_large(large)
        for part in (self.head, self.line, self.place_label, self.side):
            part.setVisible(large)
        self.setToolTip('' if large else 'click, or M: the map large')
        self.show_scene(self.view.scene)

    def is_watched(self):
        """Return whether it is visible."""
        return self.isVisible() and not self.window().isMinimized()

    def _on_tool(self):
        """Show the selected tool, and emit when it was deselected."""
        before, self._tool = self._tool, self.view.gesture.tool
        self._show_tool()
        if before != gesture.LOOK and self._tool == gesture.LOOK:
            self.done.emit()

    def _show_tool(self):
        """Show the selected tool, and how to use it."""
        drawn = self.view.gesture
        for tool, button in self.tools.items():
            _show_checked(button, tool == drawn.tool)
        self.done_button.setVisible(drawn.tool in gesture.CORNERS)
        self.done_button.setEnabled(not drawn.problem())
        self.cancel_button.setVisible(drawn.tool != gesture.LOOK)
        if drawn.tool == gesture.LOOK:
            self.line.show_text(*self._answer)
        else:
            hint = gesture.HINTS[drawn.tool].format(' and '.join(self._names))
            self.line.show_text(hint, theme.DRIVE, words.beginnings(hint))
        self.view.show_hint('' if drawn.tool == gesture.LOOK else hint.partition(':')[0])

    def _show_choices(self):
        """Show the view options."""
        _show_checked(self.follow_button, self.view.follows)
        _show_checked(self.turn_button, self.view.turns)
        self.trails_button.setText(TRAILS[self.view.by_link])

    # Actions.

    def choose_tool(self, tool, robots=(), given=None):
        """Select a tool for robots; none: those of :meth:`targets`. PLACE is for the first one.

        :param given: parameters of the task that is drawn, {name: value}; None for the defaults
        """
        if tool != gesture.LOOK:
            # LOOK ends a tool: what is drawn is for the robots it was chosen for.
            self.given = dict(given or {})
            self._names = (tuple(robots) or self.targets())[:1 if tool == gesture.PLACE else None]
        self._answer = ('', theme.TEXT)
        if tool in _FOR_ROBOTS and not self._names:
            tool, self._answer = gesture.LOOK, (NOBODY, theme.ATTENTION)
        self.name_field.hide()
        self.view.choose_tool(tool)

    def _on_act(self, act):
        """Emit a drawing, for the robots addressed when the tool was selected."""
        names = list(self._names)
        if act.tool == gesture.CARRY:
            self._send_carried(names, act.pose)
        elif act.tool == gesture.GOTO:
            self.goal_drawn.emit(names, act.pose, act.aimed)
        elif act.tool == gesture.ROUTE:
            self.route_drawn.emit(names, list(act.corners))
        elif act.tool == gesture.FENCE:
            self.fence_drawn.emit(list(act.corners))
        elif act.tool == gesture.PLACE:
            self.robot_placed.emit(names[0], self._with_heading(act))
        elif act.tool == gesture.LEADER:
            self._choose_leader(names, act.pose)
        elif act.tool == gesture.MARK:
            self.name_field.ask(act.pose, self.view.canvas.pixel(act.pose.x_m, act.pose.y_m))

    def _with_heading(self, act):
        """Return the pose of a placed robot; without a drag its heading is unchanged."""
        robot = self.view.scene.robot(self._names[0])
        if act.aimed or robot is None or robot.pose is None:
            return act.pose
        return type(act.pose)(act.pose.x_m, act.pose.y_m, robot.pose.heading_rad)

    def _on_carried(self, name):
        """Send the robot that is being dragged, and no other."""
        self._names, self._answer, self.given = (name,), ('', theme.TEXT), {}
        self.name_field.hide()

    def _send_carried(self, names, pose):
        """Send a robot to where its mark was released, unless another one is there."""
        there = self.view.scene.at(pose.x_m, pose.y_m, self.view.near_m())
        if there is not None and there.name not in names:
            self.show_answer('{} stays: {} is there.'.format(names[0], there.name), False)
        else:
            self.goal_drawn.emit(names, pose, False)

    def _choose_leader(self, names, place):
        """Request that robots follow the clicked one."""
        leader = self.view.scene.at(place.x_m, place.y_m, self.view.near_m())
        followers = [name for name in names if leader is None or name != leader.name]
        if leader is None:
            self.show_answer('There is no robot: click one to follow.', False)
        elif not followers:
            self.show_answer('{} cannot follow itself: click another robot.'.format(
                leader.name), False)
        else:
            self.leader_chosen.emit(followers, leader.name)

    def _on_named(self, name, pose):
        """Set the mark at its drawn pose."""
        if name:
            self.mark_set.emit(name, pose)
        else:
            self.show_answer(NO_MARK_NAME, False)
        self.done.emit()

    def _on_click(self, name):
        """Show a clicked robot; on the small map, enlarge the map."""
        if not self.large:
            self.swap_requested.emit()
            return
        self.clicked = name
        if name:
            self.look_requested.emit(name)

    def offer_fits(self, name=''):
        """Show a menu of the targets of a fit, below its button.

        :param name: the robot to fit; by default the first one of :meth:`targets`
        """
        rows = fit_rows(self, name or next(iter(self.targets()), ''))
        if rows:
            popup(self, rows, self.fit_button.mapToGlobal(QPoint(0, self.fit_button.height())),
                  'map_menu')
        else:
            self.show_answer(NOBODY, False)

    def _open_menu(self, x_m, y_m, where):
        """Open the menu of the robot at a position, or of the position."""
        robot = self.view.scene.at(x_m, y_m, self.view.near_m())
        # What was filled in for a tool that was put away is not for what the menu offers.
        self.given = {}
        if robot is not None:
            self.robot_menu_requested.emit(robot.name, where)
        else:
            popup(self, place_menu(self, x_m, y_m), where, 'map_menu')

    # Settings, size.

    def save_settings(self):
        """Return the settings to keep between runs."""
        return {'follow': self.view.follows, 'turn': self.view.turns, 'by_link': self.view.by_link}

    def restore_settings(self, settings):
        """Restore what :meth:`save_settings` returned."""
        self.view.choose(*(settings.get(key) is True for key in ('follow', 'turn', 'by_link')))

    def minimumSizeHint(self):  # noqa: N802
        """Return a minimal size, since the stage determines it."""
        return QSize(4 * self.fontMetrics().height(), 2 * self.fontMetrics().height())

    def resizeEvent(self, event):  # noqa: N802
        """Keep the overlays in the corners of the map."""
        super().resizeEvent(event)
        self._place_over()

    def showEvent(self, event):  # noqa: N802
        """Place the overlays once there is a layout."""
        super().showEvent(event)
        self._place_over()

    def _place_over(self):
        """Place the buttons at the right, and the strip at the upper left."""
        gap = self.fontMetrics().height() // 3
        size = self._side_size(self.view.height() - 2 * gap)
        self.side.setGeometry(self.view.width() - size.width() - gap, gap, size.width(),
                              size.height())
        room = self.view.width() - 2 * gap - (size.width() + gap if self.large else 0)
        self.strip.fit(QPoint(gap, gap), room)

    def _side_size(self, room_px):
        """Return the size [px] of the buttons at the right: as few columns as the height allows."""
        buttons, wide = self.side.layout(), self.closer.minimumWidth()
        for columns in range(1, buttons.count() + 1):
            size = QSize(columns * (wide + _GAP) - _GAP, 0)
            size.setHeight(buttons.heightForWidth(size.width()))
            if size.height() <= room_px:
                break
        return size

    def clear_of_buttons(self, place):
        """Return a :class:`QRect` of this pane, moved to the left of the buttons over the map."""
        side = self.side.geometry().translated(self.view.pos())
        if place.intersects(side):
            place.moveRight(side.left() - self.fontMetrics().height() // 2)
        return place

    def paintEvent(self, event):  # noqa: N802
        """Paint the background of tools and messages."""
        painter = QPainter(self)
        painter.fillRect(self.rect(), self.palette().window())


def _show_checked(button, checked):
    """Show a button as checked, in a distinct colour."""
    button.setChecked(checked)
    palette = QPalette()
    if checked:
        ground = theme.colour(theme.DRIVE, button.parentWidget().palette())
        palette.setColor(QPalette.Button, ground)
        palette.setColor(QPalette.ButtonText, theme.readable_on(ground))
    button.setPalette(palette)
