# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The tiles of all robots: makes and draws them one by one, tears them off, puts them back.

Everything here runs on the GUI thread.
"""
import json
import math
import time

from python_qt_binding.QtCore import QObject, QTimer, Signal
from python_qt_binding.QtGui import QGuiApplication
import rospy

from mhri.base.gui.geometry import geometry_of, in_sight, place_on_another_screen, restore_geometry
from mhri.base.views import ROS_CUT_OFF
from mhri.camera.ros.camera_budget import CameraBudget
from mhri.screen.gui.torn_off import TornOff
from mhri.screen.gui.window_maker import WindowMaker
from mhri.screen.presenters.tile_host import TileHost

# A large tile is as pressing as a small one that has waited so many times as long.
LARGE_FIRST = 4.0
MONITOR_MS = 500
# More tiles than this help nobody: further robots are only in the list.
MOST_TILES = 40


class TilesHost(QObject):
    """Knows the tiles; :attr:`windows` is {name: tile} in the order of the robots.

    :param operator: :class:`mhri.screen.ros.backend.ScreenBackend`
    :param stage: :class:`mhri.screen.gui.stage.Stage`
    :param ui_dir: folder of the forms
    :param tell: function that shows the operator a sentence
    """

    #: a tile was clicked: name of its robot
    clicked = Signal(str)
    #: drive this robot and no other
    drive_requested = Signal(str)
    #: this robot is to go on with the task that it was taken from
    carry_on_requested = Signal(str)
    #: a torn-off tile's window was closed by its frame
    closed = Signal(str)

    def __init__(self, operator, stage, ui_dir, tell, parent=None):
        super().__init__(parent)
        self.windows = {}
        self.hosts = {}
        self._operator = operator
        self._stage = stage
        self._ui_dir = ui_dir
        self._tell = tell
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
        self._timer = QTimer(self)
        self._timer.timeout.connect(self.draw_next)
        # The window manager may take a moment to move windows.
        self._monitors = QTimer(self)
        self._monitors.setSingleShot(True)
        self._monitors.setInterval(MONITOR_MS)
        self._monitors.timeout.connect(self._on_monitor_gone)
        QGuiApplication.instance().screenRemoved.connect(self._on_screen_removed)

    def show_view(self, view, coming=()):
        """Follow a :class:`PanelView`: see whose tile is missing, and have all drawn soon.

        :param coming: names of robots that are in the next views: their tiles have places already
        """
        robots = view.robots[:MOST_TILES]
        names = [robot.name for robot in robots]
        for name in [name for name in self.windows if name not in names]:
            self.drop(name)
        self._robots, self._coming = robots, tuple(coming)
        self._unplaced = True
        self._stage.show_awaited(names)
        now = time.monotonic()
        self._due = sorted((robot for robot in robots if robot.name in self.hosts),
                           key=lambda robot: self._pressing(robot.name, now))
        self._missing = next((robot.name for robot in robots
                              if robot.name not in self.windows and robot.type_label), '')
        self._stopped = view.stop_all
        for tile in self.windows.values():
            tile.show_cut_off(view.ros == ROS_CUT_OFF)
        self._timer.start()
        self._cameras.settle(wish for robot in self._due
                             for wish in self.hosts[robot.name].wishes(robot.selected))

    def show_session(self, lasts_s):
        """Say in every tile for how long the session has been recorded, None where it is not."""
        for tile in self.windows.values():
            tile.header.show_session(lasts_s)

    def _show_tiles(self):
        """Let the stage have the tiles, and know of those that come next; return if that is new."""
        placed = ({robot.name: self.windows[robot.name] for robot in self._robots
                   if robot.name in self.windows},
                  [*(robot.name for robot in self._robots if robot.type_label),
                   *self._coming][:MOST_TILES])
        new, self._placed = placed != self._placed, placed
        self._stage.show_tiles(*placed)
        return new

    @property
    def budget_note(self):
        """A sentence while the camera budget cannot be kept, else ''."""
        return self._cameras.note

    def _pressing(self, name, now):
        """Return a number that is the larger the longer a tile was not drawn: none starves."""
        waited_s = now - self._drawn_at.get(name, -math.inf)
        return waited_s * (LARGE_FIRST if self.windows[name].header.large else 1.0)

    @property
    def lacks_one(self):
        """Whether :meth:`make_missing` has a tile to make."""
        return self._missing not in ('', *self.windows)

    def make_missing(self):
        """Make one tile, of the last view: it takes some time, and has a turn for itself."""
        self.make(self._missing)
        self._unplaced = True
        self._timer.start()

    def draw_next(self):
        """Place all tiles, or draw the most pressing; return whether there is more to do.

        One of it with each turn of the event loop, so that a click never waits for all.
        """
        if self._unplaced:
            self._unplaced = False
            # On a busy computer there is no second turn before the next view.
            if self._show_tiles():
                return True
        if not self._due:
            self._timer.stop()
            return False
        robot = self._due.pop()
        host = self.hosts.get(robot.name)
        if host is not None:
            self._drawn_at[robot.name] = time.monotonic()
            host.guard.run(self._guarded, robot.name, host.draw, robot, self._stopped)
        return bool(self._due)

    def make(self, name):
        """Make a robot's tile; it is shown with the next view."""
        view = self._operator.robot_view(name)
        tile, problem = self._maker.make(view.window, self._ui_dir, name, view.type_label)
        if problem:
            rospy.logwarn('%s: %s', name, problem)
            self._tell('{}: {}'.format(name, problem))
        # Before it is in any window: else it would open as a window of its own.
        tile.setParent(self._stage)
        tile.stop_requested.connect(self._operator.stop_all)
        tile.clicked.connect(self.clicked)
        tile.drive_requested.connect(self.drive_requested)
        tile.tear_requested.connect(self.toggle_torn)
        tile.carry_on_requested.connect(self.carry_on_requested)
        self.windows[name] = tile
        self._keys[name] = view.window
        self.hosts[name] = TileHost(tile, self._operator)
        self._guarded(name, self._furnish, name, tile, view)

    def _furnish(self, name, tile, view):
        """Show a new tile as, and where, it was left."""
        feeds = self._operator.feeds(name)
        if feeds is not None:
            tile.offer(feeds.offers())
        tile.restore_settings(self._looks.get(name, {}))
        tile.show_view(view)
        if name in self._to_tear:
            self._to_tear.discard(name)
            # Where its monitor is gone, the window would lie on the screen.
            if name not in self._places or in_sight(self._places[name]):
                self.toggle_torn(name)

    def _guarded(self, name, job, *args):
        """Do something with a robot's tile; replace a lab's own class by mhri's if it fails."""
        key = self._keys[name]
        try:
            job(*args)
        except BaseException as error:
            if isinstance(error, KeyboardInterrupt) or not self._maker.trusts(key):
                raise
            self._maker.distrust(key, '{} failed ({}: {}); mend it and start mhri again'.format(
                key, type(error).__name__, error))
            self._discard(name)
            self.make(name)
            self._stage.show_tiles({name: self.windows[name] for name in self.windows})

    def show_palette(self, palette):
        """Give the windows of tiles that were torn off the colours of the screen."""
        for window in self._torn.values():
            window.setPalette(palette)

    def toggle_torn(self, name):
        """Put a tile into a window of its own, or back on the stage."""
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
        """See in a moment whose monitor that was."""
        self._monitors.start()

    def _on_monitor_gone(self):
        """Put back the tiles whose windows have no monitor any more."""
        for name in [name for name, window in self._torn.items()
                     if not in_sight(geometry_of(window))]:
            self._put_back(name)
            self._tell('the monitor of {} has gone: it is back on this screen'.format(name))

    def _on_closed(self, name):
        """Put the tile back, and tell that its robot should no longer be driven."""
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
        """Let a robot's tile go, and keep how it looked and whether it was torn off."""
        if name in self.windows:
            self._keep_look(name)
            if name in self._torn:
                self._to_tear.add(name)
            self._discard(name)

    def _discard(self, name):
        """Remove a tile and its feeds."""
        if name in self._torn:
            self._put_back(name)
        self.hosts.pop(name).close()
        self._drawn_at.pop(name, None)
        tile = self.windows.pop(name)
        self._stage.show_tiles(dict(self.windows))
        tile.hide()
        tile.setParent(None)
        tile.deleteLater()

    def recording_wish(self, name):
        """Return (path, choices) of a recording: from its tile, or as last seen there."""
        if name in self.windows:
            row = self.windows[name].recording
            return row.path, row.chosen_extras()
        extras = self._looks.get(name, {}).get('recording', {}).get('extras', ())
        return '', [key for key in self._operator.recordable(name) if key in extras]

    def save_stills(self):
        """Save every picture on show as a file."""
        for host in self.hosts.values():
            host.save_still()

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
        """Return (where torn-off windows were, what tiles show, which are torn off)."""
        for name in self.windows:
            self._keep_look(name)
        return self._places, self._looks, sorted(self._torn)

    def restore_state(self, places, looks, torn):
        """Take back what :meth:`save_state` returned."""
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
