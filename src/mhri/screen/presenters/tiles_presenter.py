# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The tiles of all robots: creates, draws, tears off and puts back, one at a time.

Everything here runs on the GUI thread.
"""
import json
import math
import time

from python_qt_binding.QtCore import QObject, QPoint, QTimer, Signal
from python_qt_binding.QtGui import QGuiApplication
import rospy

from mhri.base.gui.geometry import geometry_of, in_sight, place_on_another_screen, restore_geometry
from mhri.base.gui.text_size import change_text_size
from mhri.base.views import ROS_CUT_OFF
from mhri.camera.ros.camera_budget import CameraBudget
from mhri.screen.gui.torn_off import TornOff
from mhri.screen.gui.window_maker import WindowMaker
from mhri.screen.presenters.tile_presenter import TilePresenter

# Weight of the waiting time of a large tile, relative to a small one.
LARGE_FIRST = 4.0
MONITOR_MS = 500
# Further robots are only in the list.
MAX_TILES = 40


class TilesPresenter(QObject):
    """Creates and draws the tiles; :attr:`windows` is {name: tile} in the order of the robots.

    :param operator: :class:`mhri.screen.ros.backend.ScreenBackend`
    :param stage: :class:`mhri.screen.gui.stage.Stage`
    :param ui_dir: folder of the forms
    :param show_text: function that shows the operator a sentence
    """

    #: a tile was clicked: name of its robot
    clicked = Signal(str)
    #: drive this robot and no other
    drive_requested = Signal(str)
    #: stop this robot alone
    stop_robot_requested = Signal(str)
    #: continue the interrupted task of this robot
    carry_on_requested = Signal(str)
    #: the menu of this robot, at a place on the desktop
    menu_requested = Signal(str, QPoint)
    #: the user closed the window of a torn-off tile: name of its robot
    closed = Signal(str)

    def __init__(self, operator, stage, ui_dir, show_text, parent=None):
        super().__init__(parent)
        self.windows = {}
        self.presenters = {}
        self._operator = operator
        self._stage = stage
        self._ui_dir = ui_dir
        self._show_text = show_text
        self._maker = WindowMaker()
        self._cameras = CameraBudget(lambda: operator.settings)
        self._keys = {}
        self._places = {}
        self._looks = {}
        self._torn = {}
        self._to_tear = set()
        self._due = []
        self._robots = self._coming = ()
        self._unplaced, self._placed = False, None
        self._missing = ''
        self._drawn_at = {}
        self._stopped = False
        self._timer = QTimer(self, timeout=self.draw_next)
        # The window manager may take a moment to move windows.
        self._monitors = QTimer(self, singleShot=True, interval=MONITOR_MS)
        self._monitors.timeout.connect(self._on_monitor_gone)
        QGuiApplication.instance().screenRemoved.connect(self._on_screen_removed)

    def show_view(self, view, coming=()):
        """Handle a :class:`ScreenView`: find a missing tile, and queue all tiles for drawing.

        :param coming: names of robots in upcoming views, to reserve places for their tiles
        """
        robots = view.robots[:MAX_TILES]
        names = [robot.name for robot in robots]
        for name in [name for name in self.windows if name not in names]:
            self.drop(name)
        self._robots, self._coming = robots, tuple(coming)
        self._unplaced = True
        self._stage.invitation.show_awaited(names)
        now = time.monotonic()
        self._due = sorted((robot for robot in robots if robot.name in self.presenters),
                           key=lambda robot: self._pressing(robot.name, now))
        self._missing = next((robot.name for robot in robots
                              if robot.name not in self.windows and robot.type_label), '')
        self._stopped = view.stop_all
        for tile in self.windows.values():
            tile.show_cut_off(view.ros == ROS_CUT_OFF)
        self._timer.start()
        self._cameras.settle(
            request for robot in self._due
            for request in self.presenters[robot.name].picture_requests(robot.selected))

    def show_session(self, lasts_s):
        """Show the duration of the session's recording in every tile, None if not recording."""
        for tile in self.windows.values():
            tile.header.show_session(lasts_s)

    def _show_tiles(self):
        """Pass current and upcoming tiles to the stage; return whether they changed."""
        placed = ({robot.name: self.windows[robot.name] for robot in self._robots
                   if robot.name in self.windows},
                  [*(robot.name for robot in self._robots if robot.type_label),
                   *self._coming][:MAX_TILES])
        new, self._placed = placed != self._placed, placed
        self._stage.show_tiles(*placed)
        return new

    @property
    def budget_note(self):
        """A sentence while the camera budget cannot be kept, else ''."""
        return self._cameras.note

    def _pressing(self, name, now):
        """Return the urgency of drawing a tile, which grows with time, so that none starves."""
        waited_s = now - self._drawn_at.get(name, -math.inf)
        return waited_s * (LARGE_FIRST if self.windows[name].header.large else 1.0)

    @property
    def lacks_one(self):
        """Whether :meth:`make_missing` has a tile to create."""
        return self._missing not in ('', *self.windows)

    def make_missing(self):
        """Create one tile missing in the last view; slow, so call it in a separate turn."""
        self.make(self._missing)
        self._unplaced = True
        self._timer.start()

    def draw_next(self):
        """Place all tiles, or draw the most urgent one; return whether there is more to do.

        One step per turn of the event loop, so that a click never waits for all of them.
        """
        if self._unplaced:
            self._unplaced = False
            # If nothing changed, draw now: a busy computer has no turn left before the next view.
            if self._show_tiles():
                return True
        if not self._due:
            self._timer.stop()
            return False
        robot = self._due.pop()
        presenter = self.presenters.get(robot.name)
        if presenter is not None:
            self._drawn_at[robot.name] = time.monotonic()
            presenter.guard.run(self._guarded, robot.name, presenter.draw, robot, self._stopped)
        return bool(self._due)

    def make(self, name):
        """Create a robot's tile; it is shown with the next view."""
        view = self._operator.robot_view(name)
        tile, problem = self._maker.make(view.window, self._ui_dir, name, view.type_label)
        if problem:
            rospy.logwarn('%s: %s', name, problem)
            self._show_text('{}: {}'.format(name, problem))
        # Set a parent first, else it would open as a separate window.
        tile.setParent(self._stage)
        tile.stop_requested.connect(self._operator.stop_all)
        tile.stop_robot_requested.connect(self.stop_robot_requested)
        tile.clicked.connect(self.clicked)
        tile.drive_requested.connect(self.drive_requested)
        tile.tear_requested.connect(self.toggle_torn)
        tile.carry_on_requested.connect(self.carry_on_requested)
        tile.menu_requested.connect(self.menu_requested)
        self.windows[name] = tile
        self._keys[name] = view.window
        self.presenters[name] = TilePresenter(tile, self._operator)
        self._guarded(name, self._furnish, name, tile, view)

    def _furnish(self, name, tile, view):
        """Restore the appearance and position of a new tile."""
        feeds = self._operator.feeds(name)
        if feeds is not None:
            tile.offer(feeds.offers())
        tile.restore_settings(self._looks.get(name, {}))
        tile.show_view(view)
        if name in self._to_tear:
            self._to_tear.discard(name)
            # If its monitor is gone, its window would cover the screen.
            if name not in self._places or in_sight(self._places[name]):
                self.toggle_torn(name)

    def _guarded(self, name, job, *args):
        """Run a job on a robot's tile; if a lab's own class fails, replace it by mhri's."""
        key = self._keys[name]
        try:
            job(*args)
        except BaseException as error:
            if isinstance(error, KeyboardInterrupt) or not self._maker.trusts(key):
                raise
            self._maker.distrust(key, '{} failed ({}: {}); fix it and start mhri again'.format(
                key, type(error).__name__, error))
            self._discard(name)
            self.make(name)
            self._stage.show_tiles({name: self.windows[name] for name in self.windows})

    def show_palette(self, palette):
        """Apply the palette of the screen to the windows of torn-off tiles."""
        for window in self._torn.values():
            window.setPalette(palette)

    def show_text_size(self, before, percent):
        """Apply a change of the screen's text size [%] to the windows of torn-off tiles."""
        for window in self._torn.values():
            change_text_size(window, before, percent)

    def toggle_torn(self, name):
        """Move a tile into a separate window, or back to the stage."""
        if name in self._torn:
            self._put_back(name)
            return
        window = self._torn[name] = TornOff(self.windows[name])
        window.closed.connect(self._on_closed)
        if not (name in self._places and restore_geometry(window, self._places[name])):
            place_on_another_screen(window, self._stage.window())
        window.show()
        self._stage.refresh()

    def _on_screen_removed(self, _):
        """Check soon which windows were on that monitor."""
        self._monitors.start()

    def _on_monitor_gone(self):
        """Put back the tiles whose windows no longer have a monitor."""
        for name in [name for name, window in self._torn.items()
                     if not in_sight(geometry_of(window))]:
            self._put_back(name)
            self._show_text('the monitor of {} has gone: it is back on this screen'.format(name))

    def _on_closed(self, name):
        """Put the tile back, and signal that its robot must no longer be driven."""
        self._put_back(name)
        self.closed.emit(name)

    def _put_back(self, name):
        window = self._torn.pop(name)
        self._places[name] = geometry_of(window)
        tile = window.tile
        window.give_back()
        tile.setParent(self._stage)
        self._stage.refresh()

    def drop(self, name):
        """Remove a robot's tile; remember its appearance and whether it was torn off."""
        if name in self.windows:
            self._keep_look(name)
            if name in self._torn:
                self._to_tear.add(name)
            self._discard(name)

    def _discard(self, name):
        """Remove a tile and its feeds."""
        if name in self._torn:
            self._put_back(name)
        self.presenters.pop(name).close()
        self._drawn_at.pop(name, None)
        tile = self.windows.pop(name)
        self._stage.show_tiles(dict(self.windows))
        tile.hide()
        tile.setParent(None)
        tile.deleteLater()

    def recording_wish(self, name):
        """Return (path, choices) of a recording, from the tile or its saved settings."""
        if name in self.windows:
            row = self.windows[name].recording
            return row.path, row.chosen_extras()
        extras = self._looks.get(name, {}).get('recording', {}).get('extras', ())
        return '', [key for key in self._operator.recordable(name) if key in extras]

    def picture_of(self, name):
        """Return (topic, age [s]) of the picture in a robot's tile; '' and None for none."""
        presenter = self.presenters.get(name)
        return presenter.picture() if presenter is not None else ('', None)

    def save_stills(self):
        """Save every visible picture as a file."""
        for presenter in self.presenters.values():
            presenter.save_still()

    def _keep_look(self, name):
        tile = self.windows[name]
        if name in self._torn:
            self._places[name] = geometry_of(self._torn[name])
        try:
            look = tile.save_settings()
            json.dumps(look)
        except BaseException as error:
            if isinstance(error, KeyboardInterrupt) or not self._maker.trusts(self._keys[name]):
                raise
            rospy.logwarn('the look of the window of %s is not kept: %s', name, error)
            return
        self._looks[name] = look

    def save_state(self):
        """Return (geometries of torn-off windows, settings of tiles, names of torn-off tiles)."""
        for name in self.windows:
            self._keep_look(name)
        return self._places, self._looks, sorted(self._torn)

    def restore_state(self, places, looks, torn):
        """Apply the result of :meth:`save_state`."""
        self._places.update(places)
        self._looks.update(looks)
        self._to_tear.update(torn)

    def close(self):
        """Stop drawing and remove all tiles."""
        self._timer.stop()
        QGuiApplication.instance().screenRemoved.disconnect(self._on_screen_removed)
        self._monitors.stop()
        for name in list(self.windows):
            self._keep_look(name)
            self._discard(name)
