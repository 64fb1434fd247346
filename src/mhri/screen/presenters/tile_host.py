# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Joins one tile with what feeds it; everything here runs on the GUI thread."""
import os
from dataclasses import replace
from datetime import datetime


from mhri.base.mocap import DriftMeter, Pose
from mhri.base.opencv import cv2
from mhri.base.view_rows import CLOUD, IMU, PICTURES, RGB, SCAN, VIEW_ROWS
from mhri.base.views import StateView
from mhri.camera.budget import DRIVEN, LOOKED_AT, REST
from mhri.camera.gui.camera_view import still_name
from mhri.camera.ros.camera_budget import Wish
from mhri.recording.recording import RECORDING
from mhri.robots.ros.bot_feeds import MOCAP
from mhri.screen.presenters.draw_guard import DrawGuard
from mhri.screen.presenters.rviz_cloud import RvizCloud
from mhri.sensors.nearest import nearest, OLD_S

# Short names of streams.
_SHORT = {IMU: 'IMU', SCAN: 'scan', CLOUD: 'cloud'}


def recordings_folder():
    """Return where recordings and stills go: ``$ROS_HOME``, by default ``~/.ros``."""
    return os.path.expanduser(os.environ.get('ROS_HOME') or '~/.ros')


class TileHost:
    """One robot's tile and its feeds.

    :param window: :class:`mhri.screen.gui.bot_window.BotWindow`
    :param operator: :class:`mhri.screen.ros.backend.ScreenBackend`
    """

    def __init__(self, window, operator):
        self.window = window
        self.guard = DrawGuard(window)
        self._operator = operator
        self._name = window.name
        self._notes = []
        self._drift = DriftMeter()
        self._wired = False
        self._rviz = None
        self._held_back = ''
        self._nearest = None
        window.recording.record_requested.connect(self._record)
        window.recording.stop_record_requested.connect(self._stop_recording)
        self._operator_folder()

    def draw(self, view, stop_all):
        """Hand the tile the newest values.

        :param view: :class:`mhri.base.views.RobotView`
        """
        window, feeds = self.window, self._operator.feeds(self._name)
        if not window.is_watched():
            self._rest(feeds)
            return
        # Anything else matters more than why the picture is slow.
        window.show_view(replace(view, note=view.note or self._held_back), stop_all)
        self._held_back = ''
        if feeds is None:
            return
        window.offer(feeds.offers())
        if not self._wired and feeds.offers() & PICTURES:
            self._wired = True
            window.view('rgb').transport_chosen.connect(self._choose_transport)
            window.view('rgb').still_requested.connect(self._save_still)
        feeds.want(self._wanted() | {MOCAP})
        status = self._operator.recordings.status(self._name)
        window.recording.offer_extras(self._operator.recordable(self._name))
        window.recording.show_recording(status)
        window.header.show_recording(status if status.state == RECORDING else None)
        for key in self._wanted():
            feed = feeds.get(key)
            if key == SCAN and feed is not None:
                self._draw_scan(feed, feeds.frames)
            elif feed is not None:
                self._draw_view(key, feed)
        self._draw_state(view, feeds)
        window.hud.set_extra(self._extra_lines(feeds))
        while self._notes and RGB in feeds.offers():
            window.view('rgb').show_note(*self._notes.pop())

    def _wanted(self):
        """Return the views to be fed: a large tile tells the nearest thing, view or not."""
        wanted = self.window.wanted()
        return wanted | {SCAN} if self.window.header.large else wanted

    def _extra_lines(self, feeds):
        """Return what the numbers over the picture say beside the motion; old scans say nothing."""
        scan = feeds.get(SCAN) if self.window.header.large else None
        if scan is None:
            return ()
        age_s = scan.age_s()
        told = self._nearest is not None and age_s is not None and age_s <= OLD_S
        return (self._nearest.words() if told else '',)

    def _draw_view(self, key, feed):
        """Hand a view what its feed has."""
        widget = self.window.view(key)
        if hasattr(feed, 'set_view'):
            self._draw_camera(widget, feed)
            return
        if key == CLOUD and self._rviz is None:
            self._rviz = RvizCloud(widget, feed)
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
        """Take note of the nearest thing, and show the scan where its view is on show."""
        scan = lasers.take(frames)
        if scan is not None:
            self._nearest = nearest(*scan[:3])
        if SCAN in self.window.wanted():
            widget = self.window.view(SCAN)
            if scan is not None:
                widget.show_value(scan)
            widget.show_age(lasers.age_s())

    def _draw_state(self, view, feeds):
        """Show how old each stream is, and what motion capture says.

        The header shows the age of the odometry as that of the link.
        """
        ages = []
        for row in VIEW_ROWS:
            feed = feeds.get(row.key) if row.key in self.window.wanted() else None
            if feed is not None:
                ages.append((_SHORT.get(row.key, row.label), feed.age_s()))
        tracker = feeds.get(MOCAP)
        captured = tracker.pose() if tracker else None
        if captured is not None:
            ages.append(('capture', tracker.age_s()))
        place = (view.x_m, view.y_m, view.heading_rad)
        odometry = None if None in place else Pose(*place)
        self.window.state_line.show_state(
            StateView(tuple(ages), view.figures, captured, self._drift.drift(odometry, captured)))

    def _operator_folder(self):
        """Start the file dialog in the default folder of recordings."""
        self.window.recording.set_default_path(
            os.path.join(recordings_folder(), '{}_<date-time>.bag'.format(self._name)))

    def _record(self, path, choices):
        self._operator.record(self._name, path, choices)

    def _stop_recording(self):
        self._operator.recordings.stop(self._name)

    def _draw_camera(self, camera, feed):
        """Ask for pictures of the size and rate this tile needs, and show the newest."""
        width, height = self.window.camera_size()
        # A picture that gave its place to the map is still driven by.
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
        # Without a picture, the placeholder says it.
        self._held_back = status.thinned if status.age_s is not None else ''
        camera.show_status(status, None if large else (thumbnail_hz, 'another'))
        if status.age_s is None and status.problem:
            camera.show_placeholder(status.problem)
        camera.show_transports(feed.transports())

    def wishes(self, selected):
        """Return a :class:`Wish` for the picture on show, and one for the point cloud.

        Nobody drives by a cloud: it is never as important as the picture of a driven robot.

        :param selected: whether the robot is checked
        """
        feeds = self._operator.feeds(self._name)
        rest = LOOKED_AT if self.window.header.large else REST
        found = []
        for key, name, importance in (
                (self._picture(), self._name, DRIVEN if selected else rest),
                (CLOUD, self._name + ' cloud', rest)):
            feed = feeds.get(key) if feeds and key in self.window.wanted() else None
            if hasattr(feed, 'grant'):
                found.append(Wish(name, importance, feed, self.window.is_watched()))
        return found

    def _choose_transport(self, name):
        feeds = self._operator.feeds(self._name)
        feed = feeds.get(self._picture()) if feeds else None
        if feed is not None:
            feed.choose(name)

    def _picture(self):
        """Return the key of the picture on show, None without one."""
        return next(iter(self.window.wanted() & PICTURES), None)

    def save_still(self):
        """Save the picture on show as a file, if there is one."""
        frame = self.window.view('rgb').picture.frame if self._picture() else None
        if frame is not None:
            self._save_still(frame)

    def _save_still(self, frame):
        """Write the picture on show to the folder of the recordings, off the GUI thread."""
        path = os.path.join(recordings_folder(), still_name(self._name, frame.kind, datetime.now()))
        self._operator.do(self._write_still, path, frame.rgb)

    def _write_still(self, path, rgb):
        """Write a PNG (on the operator's worker); the next drawing shows the result."""
        try:
            os.makedirs(os.path.dirname(path), exist_ok=True)
            written = cv2.imwrite(path, cv2.cvtColor(rgb, cv2.COLOR_RGB2BGR))
        except (OSError, cv2.error):
            written = False
        self._notes.append(('saved {}'.format(path), True) if written else (
            'cannot write {}: is there room, and permission?'.format(path), False))

    @staticmethod
    def _rest(feeds):
        """Let the feeds rest: a tile that nobody can see costs nothing."""
        if feeds is not None:
            feeds.want(())

    def close(self):
        """Draw no more."""
        self.guard.end()
        self._rest(self._operator.feeds(self._name))
