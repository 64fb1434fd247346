# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Connects one tile to its feeds; everything here runs on the GUI thread."""
import os
from dataclasses import replace
from datetime import datetime

from mhri.base.geometry import Pose
from mhri.base.mocap import DriftMeter
from mhri.base.opencv import cv2
from mhri.base.view_rows import CAMERAS, CLOUD, IMU, RGB, SCAN, VIEW_ROWS
from mhri.base.views import StateView
from mhri.camera.budget import DRIVEN, LOOKED_AT, REST
from mhri.camera.gui.camera_view import still_name
from mhri.camera.ros.camera_budget import PictureRequest
from mhri.recording.recording import RECORDING, ros_home
from mhri.robots.ros.streams import MOCAP
from mhri.screen.presenters.draw_guard import DrawGuard
from mhri.screen.presenters.path_presenter import PathPresenter
from mhri.sensors.nearest import nearest, OLD_S

# Short names of streams.
_SHORT = {IMU: 'IMU', SCAN: 'scan', CLOUD: 'cloud'}


class TilePresenter:
    """One robot's tile and its feeds.

    :param window: :class:`mhri.screen.gui.robot_tile.RobotTile`
    :param operator: :class:`mhri.screen.ros.backend.ScreenBackend`
    """

    def __init__(self, window, operator):
        self.window = window
        self.guard = DrawGuard(window)
        self._operator = operator
        self._name = window.name
        self._notes = []
        self._drift = DriftMeter()
        self._path = PathPresenter(window)
        self._wired = False
        self._held_back = ''
        self._nearest = None
        window.recording.record_requested.connect(self._record)
        window.recording.stop_record_requested.connect(self._stop_recording)
        window.recording.set_default_path(os.path.join(
            ros_home(os.environ), '{}_<date-time>.bag'.format(self._name)))

    def draw(self, view, stop_all):
        """Show the newest values in the tile.

        :param view: :class:`mhri.base.views.RobotView`
        """
        window, feeds = self.window, self._operator.feeds(self._name)
        if not window.is_watched():
            self._path.rest()
            self._rest(feeds)
            return
        # Any other note has priority over the reason for a slow picture.
        window.show_view(replace(view, note=view.note or self._held_back), stop_all)
        self._held_back = ''
        if feeds is None:
            return
        window.offer(feeds.offers())
        if not self._wired and feeds.offers() & CAMERAS:
            self._wired = True
            window.view('rgb').transport_chosen.connect(self._choose_transport)
            window.view('rgb').still_requested.connect(self._save_still)
        feeds.request(self._view_keys() | self._path.update(view) | {MOCAP.key})
        status = self._operator.recordings.status(self._name)
        window.recording.offer_extras(self._operator.recordable(self._name))
        window.recording.show_recording(status)
        window.header.show_recording(status if status.state == RECORDING else None)
        for key in self._view_keys():
            feed = feeds.get(key)
            if key == SCAN and feed is not None:
                self._draw_scan(feed, feeds.frames)
            elif feed is not None:
                self._draw_view(key, feed)
        self._path.draw(feeds)
        self._draw_state(view, feeds)
        window.hud.set_extra(self._extra_lines(feeds))
        while self._notes and RGB in feeds.offers():
            window.view('rgb').show_note(*self._notes.pop())

    def _view_keys(self):
        """Return the views to feed; a large tile always needs the scan, for the clearance."""
        views = self.window.active_views()
        return views | {SCAN} if self.window.header.large else views

    def _extra_lines(self, feeds):
        """Return extra lines for the numbers over the picture, an empty one if the scan is old."""
        scan = feeds.get(SCAN) if self.window.header.large else None
        if scan is None:
            return ()
        age_s = scan.age_s()
        recent = self._nearest is not None and age_s is not None and age_s <= OLD_S
        return (self._nearest.words() if recent else '',)

    def _draw_view(self, key, feed):
        """Show the newest value of a feed in its view."""
        widget = self.window.view(key)
        if hasattr(widget, 'show_frame'):
            self._draw_camera(widget, feed)
            return
        value = feed.take()
        if value is not None:
            widget.show_value(value)
        widget.show_age(feed.age_s())
        if hasattr(feed, 'status'):
            status = feed.status()
            widget.show_status(status)
            if status.thinned:
                self._held_back = self._held_back or 'point cloud ' + status.thinned

    def _draw_scan(self, lasers, frames):
        """Update the nearest obstacle, and show the scan if its view is visible."""
        scan = lasers.take(frames)
        if scan is not None:
            self._nearest = nearest(*scan[:3])
        if SCAN in self.window.active_views():
            widget = self.window.view(SCAN)
            if scan is not None:
                widget.show_value(scan)
            widget.show_age(lasers.age_s())

    def _draw_state(self, view, feeds):
        """Show the age of each stream, and the pose by motion capture.

        The age of the odometry is not among them: the header shows it as that of the link.
        """
        ages = []
        for row in VIEW_ROWS:
            feed = feeds.get(row.key) if row.key in self.window.active_views() else None
            if feed is not None:
                ages.append((_SHORT.get(row.key, row.label), feed.age_s()))
        tracker = feeds.get(MOCAP.key)
        captured = tracker.value() if tracker else None
        if captured is not None:
            ages.append(('capture', tracker.age_s()))
        place = (view.x_m, view.y_m, view.heading_rad)
        odometry = None if None in place else Pose(*place)
        self.window.state_line.show_state(
            StateView(tuple(ages), view.figures, captured, self._drift.drift(odometry, captured)))

    def _record(self, path, choices):
        self._operator.record(self._name, path, choices)

    def _stop_recording(self):
        self._operator.recordings.stop(self._name)

    def _draw_camera(self, camera, feed):
        """Request pictures at the size and rate of this tile, and show the newest."""
        width, height = self.window.camera_size()
        # A picture swapped with the map is still the one to drive by.
        large = self.window.header.large or self.window.full_rate
        settings = self._operator.settings
        thumbnail_hz = settings.thumbnail_hz
        if large:
            feed.set_view(width, height)
        else:
            feed.set_view(min(width, settings.thumbnail_width_px), height, thumbnail_hz)
        frame = feed.take()
        if frame is not None:
            camera.show_frame(frame)
        status = feed.status()
        # Without a picture, the placeholder shows the reason.
        self._held_back = status.thinned if status.age_s is not None else ''
        camera.show_status(status, None if large else (thumbnail_hz, 'another'))
        if status.age_s is None and status.problem:
            camera.show_placeholder(status.problem)
        camera.show_transports(feed.transports())

    def picture_requests(self, selected):
        """Return a :class:`PictureRequest` each for the visible picture and the point cloud.

        A cloud is less important than the picture of a driven robot, as it is not used to drive.

        :param selected: whether the robot is selected
        """
        feeds = self._operator.feeds(self._name)
        rest = LOOKED_AT if self.window.header.large else REST
        found = []
        for key, name, importance in (
                (self._picture(), self._name, DRIVEN if selected else rest),
                (CLOUD, self._name + ' cloud', rest)):
            feed = feeds.get(key) if feeds and key in self.window.active_views() else None
            if hasattr(feed, 'grant'):
                found.append(PictureRequest(name, importance, feed, self.window.is_watched()))
        return found

    def _choose_transport(self, name):
        feeds = self._operator.feeds(self._name)
        feed = feeds.get(self._picture()) if feeds else None
        if feed is not None:
            feed.choose(name)

    def _picture(self):
        """Return the key of the visible picture of a camera, None without one."""
        return next(iter(self.window.active_views() & CAMERAS), None)

    def picture(self):
        """Return (topic, age [s]) of the picture in the tile; '' and None for none."""
        feeds, key = self._operator.feeds(self._name), self._picture()
        feed = feeds.get(key) if feeds and key and self.window.is_watched() else None
        return (feed.topic, feed.age_s()) if feed is not None else ('', None)

    def save_still(self):
        """Save the visible picture as a file, if there is one."""
        frame = self.window.view('rgb').picture.frame if self._picture() else None
        if frame is not None:
            self._save_still(frame)

    def _save_still(self, frame):
        """Save a picture to the folder of recordings, off the GUI thread."""
        name = still_name(self._name, frame.kind, datetime.now())
        path = os.path.join(ros_home(os.environ), name)
        self._operator.do(self._write_still, path, frame.rgb)

    def _write_still(self, path, rgb):
        """Write a PNG (on a worker of the backend); the next redraw shows the result."""
        try:
            os.makedirs(os.path.dirname(path), exist_ok=True)
            written = cv2.imwrite(path, cv2.cvtColor(rgb, cv2.COLOR_RGB2BGR))
        except (OSError, cv2.error):
            written = False
        self._notes.append(('saved {}'.format(path), True) if written else (
            'cannot write {}: is there room, and permission?'.format(path), False))

    @staticmethod
    def _rest(feeds):
        """Suspend the feeds, so that a hidden tile costs nothing."""
        if feeds is not None:
            feeds.request(())

    def close(self):
        """Stop drawing."""
        self.guard.end()
        self._rest(self._operator.feeds(self._name))
