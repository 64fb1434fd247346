# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The map on the screen: tools above it, zoom at its side, and below it what came of an act."""
from python_qt_binding.QtCore import QPoint, QSize, Qt, Signal
from python_qt_binding.QtGui import QPainter, QPalette
from python_qt_binding.QtWidgets import (
    QHBoxLayout, QMenu, QPushButton, QSizePolicy, QVBoxLayout, QWidget)

from mhri.base.gui import theme, words
from mhri.base.gui.flow import FlowLayout, let_height_follow
from mhri.base.gui.labels import TextLine
from mhri.driving.gui.stop_clear import room_px
from mhri.map import gesture
from mhri.map.canvas import place_words
from mhri.map.gui.map_canvas import MapCanvas
from mhri.map.gui.map_menu import fit_rows, menu_rows
from mhri.map.gui.map_strip import NameField, UnplacedStrip

TOOLS = {gesture.GOTO: 'Go to', gesture.ROUTE: 'Route', gesture.LEADER: 'Leader',
         gesture.FENCE: 'Fence', gesture.PLACE: 'Place', gesture.MARK: 'Mark'}
_TIPS = {gesture.GOTO: 'send the robot you clicked, else the selected ones, to a place',
         gesture.ROUTE: 'let them patrol along a route', gesture.LEADER: 'let them follow a robot',
         gesture.FENCE: 'draw the fence that no task leaves',
         gesture.PLACE: 'say where the robot stands and looks',
         gesture.MARK: 'give a place a name'}
NOBODY = 'Select a robot, or look at one: nobody is meant.'
NO_MARK_NAME = 'The mark needs a name.'
# Tools that mean robots.
_FOR_ROBOTS = (gesture.GOTO, gesture.ROUTE, gesture.LEADER, gesture.PLACE)
TRAILS = ('By time', 'By link')
# Between two buttons [px].
_GAP = 4


class MapPane(QWidget):
    """A :class:`MapCanvas` and what acts on it; values in, signals out.

    Child widgets: ``tool_<tool>``, ``fit_button``, ``done_button``, ``cancel_button``, ``closer``,
    ``wider``, ``all_button``, ``follow_button``, ``turn_button``, ``trails_button``.
    """

    #: robots to a :class:`Pose`; whether its heading was drawn
    goal_drawn = Signal(list, object, bool)
    #: robots along corners
    route_drawn = Signal(list, list)
    #: robots after their leader
    leader_chosen = Signal(list, str)
    #: the tasks of robots are to end
    end_requested = Signal(list)
    #: corners; none: no fence
    fence_drawn = Signal(list)
    #: a robot, and where it is; None: take that back
    robot_placed = Signal(str, object)
    #: a robot, and the other one whose scan counts; '': the map
    fit_requested = Signal(str, str)
    #: a mark's name, and its pose; None: take it away
    mark_set = Signal(str, object)
    #: a click on a robot
    look_requested = Signal(str)
    #: a click on the small map
    swap_requested = Signal()
    #: no tool is in the hand any more
    done = Signal()

    def __init__(self, parent=None):
        super().__init__(parent)
        self.large = True
        self._names = ()
        self._clicked = ''
        self._to_place = ''
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
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(3)
        column.addWidget(self.head)
        column.addWidget(self.view, 1)
        foot = QHBoxLayout()
        foot.setContentsMargins(8, 0, 8, 3)
        foot.addWidget(self.line, 1)
        foot.addWidget(self.place_label)
        column.addLayout(foot)
        self._build_over()

    def _build_head(self):
        """Make the tools, on a second line where one is too short."""
        self.head = QWidget(self)
        self.head.setContentsMargins(_GAP, _GAP, _GAP, 0)
        row = FlowLayout(self.head, _GAP, _GAP)
        let_height_follow(self.head)
        self.tools = {tool: self._button('tool_' + tool, text, row, _TIPS[tool], True)
                      for tool, text in TOOLS.items()}
        self.fit_button = self._button(
            'fit_button', 'Fit', row, 'let what its laser sees say where the robot is')
        space = QWidget(self.head)
        space.setMinimumSize(1, 1)
        space.setSizePolicy(QSizePolicy.Expanding, QSizePolicy.Fixed)
        row.addWidget(space)
        self.done_button = self._button('done_button', 'Done', row, 'end what is drawn (Enter)')
        self.cancel_button = self._button('cancel_button', 'Cancel', row, 'drop it (Esc)')
        for button in (self.done_button, self.cancel_button):
            # The map must not move when they come: somebody is about to draw on it.
            policy = button.sizePolicy()
            policy.setRetainSizeWhenHidden(True)
            button.setSizePolicy(policy)

    def _build_over(self):
        """Make what lies over the map."""
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
        """Make a button that a finger can hit; a click does not take the keyboard from what drives.

        Tab comes to it.
        """
        button = QPushButton(text, self)
        button.setObjectName(name)
        button.setFont(theme.base_font(self.font()))
        button.setToolTip(tip)
        button.setCheckable(checkable)
        button.setFocusPolicy(Qt.TabFocus)
        touch = theme.touch_size(self)
        button.setMinimumSize(max(touch, theme.text_width(button.font(), text) + touch // 2), touch)
        layout.addWidget(button)
        return button

    def _connect(self):
        """Wire tools, buttons and the map."""
        for tool, button in self.tools.items():
            button.clicked.connect(lambda checked, tool=tool: self.take(
                tool if checked else gesture.LOOK))
        self.fit_button.clicked.connect(self._offer_fits)
        self.done_button.clicked.connect(self.view.finish)
        self.cancel_button.clicked.connect(lambda: self.take(gesture.LOOK))
        self.closer.clicked.connect(lambda: self.view.zoom(1))
        self.wider.clicked.connect(lambda: self.view.zoom(-1))
        self.all_button.clicked.connect(self.view.fit)
        self.follow_button.clicked.connect(lambda on: self.view.choose(follows=on))
        self.turn_button.clicked.connect(lambda on: self.view.choose(turns=on))
        self.trails_button.clicked.connect(
            lambda: self.view.choose(by_link=not self.view.by_link))
        self.strip.chosen.connect(lambda name: self.take(gesture.PLACE, name))
        self.name_field.named.connect(self._on_named)
        self.name_field.cancelled.connect(self.done)
        self.view.acted.connect(self._on_act)
        self.view.clicked.connect(self._on_click)
        self.view.menu_requested.connect(self._open_menu)
        self.view.tool_changed.connect(self._on_tool)
        self.view.view_changed.connect(self._show_choices)
        self.view.pointed.connect(lambda text: self.place_label.show_text(text, theme.MUTED))

    def _restore(self):
        """Begin with no tool in the hand."""
        self._show_tool()
        self._show_choices()

    # What is shown.

    def show_scene(self, scene):
        """Show a :class:`mhri.map.scene.Scene`."""
        before = self.view.scene
        seen = next((robot.name for robot in scene.robots if robot.looked_at), '')
        was = next((robot.name for robot in before.robots if robot.looked_at), '')
        if scene.selected != before.selected or seen not in (was, self._clicked):
            # The operator has chosen others since.
            self._clicked = ''
        self.view.show_scene(scene)
        self.strip.show_robots(scene.robots, scene.answers, self.large)
        self._place_over()

    def targets(self):
        """Return the robots that an act is for: the one clicked here, else as the scene says."""
        return self.view.scene.targets(self._clicked)

    def show_answer(self, text, good=True):
        """Say below the map what came of an act; it stays until the next one."""
        self._answer = text, theme.TEXT if good else theme.ATTENTION
        self._show_tool()

    def show_large(self, large):
        """Be the large pane, with its tools, or a small one: a click makes that large."""
        if large == self.large:
            return
        self.large = large
        if not large:
            self.take(gesture.LOOK)
            self.name_field.hide()
        self.view.show_large(large)
        for part in (self.head, self.line, self.place_label, self.side):
            part.setVisible(large)
        self.setToolTip('' if large else 'click, or M: the map large')
        self.show_scene(self.view.scene)

    def is_watched(self):
        """Tell whether anybody can see it."""
        return self.isVisible() and not self.window().isMinimized()

    def _on_tool(self):
        """Show the tool in the hand, and tell when it was put away."""
        before, self._tool = self._tool, self.view.gesture.tool
        self._show_tool()
        if before != gesture.LOOK and self._tool == gesture.LOOK:
            self.done.emit()

    def _show_tool(self):
        """Show which tool is in the hand, and what to do with it."""
        drawn = self.view.gesture
        for tool, button in self.tools.items():
            _show_checked(button, tool == drawn.tool)
        self.done_button.setVisible(drawn.tool in gesture.CORNERS)
        self.done_button.setEnabled(not drawn.problem())
        self.cancel_button.setVisible(drawn.tool != gesture.LOOK)
        if drawn.tool == gesture.LOOK:
            self.line.show_text(*self._answer)
        else:
            who = [self._to_place] if drawn.tool == gesture.PLACE else self._names
            hint = gesture.HINTS[drawn.tool].format(' and '.join(who))
            self.line.show_text(hint, theme.DRIVE, words.beginnings(hint))

    def _show_choices(self):
        """Show how the map is looked at."""
        _show_checked(self.follow_button, self.view.follows)
        _show_checked(self.turn_button, self.view.turns)
        self.trails_button.setText(TRAILS[self.view.by_link])

    # What is done.

    def take(self, tool, robot=''):
        """Take a tool into the hand; PLACE is for a robot, by default the first that is meant."""
        self._names = self.targets()
        self._to_place = robot or next(iter(self._names), '')
        self._answer = ('', theme.TEXT)
        if tool in _FOR_ROBOTS and not (self._to_place if tool == gesture.PLACE else self._names):
            tool, self._answer = gesture.LOOK, (NOBODY, theme.ATTENTION)
        self.name_field.hide()
        self.view.take(tool)

    def _on_act(self, act):
        """Tell what was drawn, for those who were meant when the tool was taken."""
        names = list(self._names)
        if act.tool == gesture.GOTO:
            self.goal_drawn.emit(names, act.pose, act.aimed)
        elif act.tool == gesture.ROUTE:
            self.route_drawn.emit(names, list(act.corners))
        elif act.tool == gesture.FENCE:
            self.fence_drawn.emit(list(act.corners))
        elif act.tool == gesture.PLACE:
            self.robot_placed.emit(self._to_place, self._with_heading(act))
        elif act.tool == gesture.LEADER:
            self._choose_leader(names, act.pose)
        elif act.tool == gesture.MARK:
            self.name_field.ask(act.pose, self.view.canvas.pixel(act.pose.x_m, act.pose.y_m))

    def _with_heading(self, act):
        """Return where a robot was placed; without a drag it looks as it did before."""
        robot = self.view.scene.robot(self._to_place)
        if act.aimed or robot is None or robot.pose is None:
            return act.pose
        return type(act.pose)(act.pose.x_m, act.pose.y_m, robot.pose.heading_rad)

    def _choose_leader(self, names, place):
        """Let robots follow the one that was clicked."""
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
        """Put the mark where it was drawn."""
        if name:
            self.mark_set.emit(name, pose)
        else:
            self.show_answer(NO_MARK_NAME, False)
        self.done.emit()

    def _on_click(self, name):
        """Look at a robot; the small map becomes large."""
        if not self.large:
            self.swap_requested.emit()
            return
        self._clicked = name
        if name:
            self.look_requested.emit(name)

    def _offer_fits(self):
        """Ask to what the robot is to be fitted."""
        self._names = self.targets()
        rows = fit_rows(self, next(iter(self._names), ''))
        if rows:
            self._popup(rows, self.fit_button.mapToGlobal(QPoint(0, self.fit_button.height())))
        else:
            self.show_answer(NOBODY, False)

    def _open_menu(self, x_m, y_m, where):
        """Offer what can be done at a place."""
        self._names = self.targets()
        self._popup(menu_rows(self, x_m, y_m), where)

    def _popup(self, rows, where):
        """Show a menu; it blocks nothing."""
        menu = QMenu(self)
        menu.setObjectName('map_menu')
        menu.setFont(self.font())
        # Lower rows rather than a menu that finds no room above STOP ALL.
        least, room = self.fontMetrics().height(), room_px(where) - self.fontMetrics().height()
        menu.setStyleSheet('QMenu::item {{ min-height: {}px; padding: 0 1em; }}'.format(
            max(least, min(theme.touch_size(self), room // max(1, len(rows))))))
        menu.setAttribute(Qt.WA_DeleteOnClose)
        for text, act in rows:
            menu.addAction(text).triggered.connect(lambda checked=False, act=act: act())
        menu.popup(where)

    # Settings, size.

    def save_settings(self):
        """Return what is kept between runs."""
        return {'follow': self.view.follows, 'turn': self.view.turns, 'by_link': self.view.by_link}

    def restore_settings(self, settings):
        """Take back what :meth:`save_settings` returned."""
        self.view.choose(*(settings.get(key) is True for key in ('follow', 'turn', 'by_link')))

    def minimumSizeHint(self):  # noqa: N802
        """Return next to nothing: the stage says how large it is."""
        return QSize(4 * self.fontMetrics().height(), 2 * self.fontMetrics().height())

    def resizeEvent(self, event):  # noqa: N802
        """Keep what lies over the map in its corners."""
        super().resizeEvent(event)
        self._place_over()

    def showEvent(self, event):  # noqa: N802
        """Place them once the layout has been made."""
        super().showEvent(event)
        self._place_over()

    def _place_over(self):
        """Place buttons and strip: at the right, and at the upper left."""
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
        """Paint the ground of tools and line."""
        painter = QPainter(self)
        painter.fillRect(self.rect(), self.palette().window())


def _show_checked(button, checked):
    """Show a button checked, in a colour that a glance tells apart."""
    button.setChecked(checked)
    palette = QPalette()
    if checked:
        ground = theme.colour(theme.DRIVE, button.parentWidget().palette())
        palette.setColor(QPalette.Button, ground)
        palette.setColor(QPalette.ButtonText, theme.readable_on(ground))
    button.setPalette(palette)
