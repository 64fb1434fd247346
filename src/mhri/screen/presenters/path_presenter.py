# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Draws the committed path on a robot's picture while its link is slow."""
import time

from mhri.base.accessories import looks_ahead
from mhri.base.view_rows import CAMERAS, FLOOR_CAMERA, RGB
from mhri.base.views import LIVE
from mhri.sensors.committed import SentCommands
from mhri.sensors.floor import floor_path

# The feed is open for this long: camera_info comes with each picture, which costs a slow link.
LOOK_S = 5.0


class PathPresenter:
    """The path on the picture of one tile.

    :param window: :class:`mhri.screen.gui.robot_tile.RobotTile`
    :param clock: function that returns time [s, monotonic]
    """

    def __init__(self, window, clock=time.monotonic):
        self._window = window
        self._clock = clock
        self._sent = SentCommands()
        self._camera = None
        self._path = ()
        self._looks_since = None
        # Whether the camera was turned: what was known of its place is no longer true.
        self._turned = False

    def update(self, view):
        """Handle the newest :class:`mhri.base.views.RobotView`.

        :returns: keys of the feeds that the path needs now
        """
        now = self._clock()
        self._turned = not looks_ahead(view.accessories)
        if self._turned:
            self._camera = self._looks_since = None
        if view.sent is None or view.link != LIVE or view.also_commanded_by \
                or not view.odometry_follows:
            self.rest()
            return frozenset()
        self._sent.add(view.sent, now)
        self._path = self._sent.path(view.figures.round_trip_s, now) \
            if self._window.active_views() & CAMERAS and not self._turned else ()
        if not self._path:
            return frozenset()
        if self._looks_since is None:
            self._looks_since = now
        return frozenset((FLOOR_CAMERA,)) if now - self._looks_since <= LOOK_S else frozenset()

    def draw(self, feeds):
        """Show the path in the picture, or none.

        :param feeds: :class:`mhri.robots.ros.bot_feeds.BotFeeds` of the robot
        """
        feed = feeds.get(FLOOR_CAMERA)
        if feed is not None and not self._turned:
            # tf may come after the type's own place was used.
            self._camera = feed.take(feeds.frames) or self._camera
        if self._window.active_views() & CAMERAS:
            shown = floor_path(self._path, feeds.robot_type.radius_m, self._camera) \
                if self._path and self._camera is not None else None
            self._window.view(RGB).picture.show_path(shown)

    def rest(self):
        """Forget what was sent: the robot may have been told something else meanwhile."""
        self._sent.clear()
        self._path = ()
