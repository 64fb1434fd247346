# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Joins one bot window with what feeds it; everything here runs on the GUI thread."""
import os
from datetime import datetime

import cv2

from mhri.core.camera.images import DEPTH, RGB
from mhri.core.robots.mocap import DriftMeter, Pose
from mhri.core.screen.views import StateView
from mhri.gui.camera.camera_view import still_name
from mhri.presenters.draw_guard import DrawGuard
from mhri.ros.robots.bot_feeds import IMU, MOCAP, SCAN

_CAMERA_NAMES = {RGB: 'RGB', DEPTH: 'depth'}


def recordings_folder():
    """Return where recordings and stills go: ``$ROS_HOME``, by default ``~/.ros``."""
    return os.path.expanduser(os.environ.get('ROS_HOME') or '~/.ros')


class WindowHost:
    """One robot's window and its feeds.

    :param window: :class:`mhri.gui.screen.bot_window.BotWindow`
    :param operator: :class:`mhri.ros.screen.backend.ScreenBackend`
    """

    def __init__(self, window, operator):
        self.window = window
        self.guard = DrawGuard(window)
        self._operator = operator
        self._name = window.name
        self._notes = []
        self._drift = DriftMeter()
        # The robot that is highlighted instead of this one: its camera has the full rate then.
        self.behind = ''
        window.camera.transport_chosen.connect(self._choose_transport)
        window.camera.still_requested.connect(self._save_still)
        window.recording.record_requested.connect(self._record)
        window.recording.stop_record_requested.connect(self._stop_recording)
        self._operator_folder()

    def draw(self, view, stop_all):
        """Hand the window what there is.

        :param view: :class:`mhri.core.screen.views.RobotView`
        """
        window = self.window
        window.show_view(view, stop_all)
        feeds = self._operator.feeds(self._name)
        if feeds is None:
            return
        window.offer(feeds.offers())
        feeds.want(window.wanted() | {MOCAP} if window.is_watched() else ())
        window.recording.offer_extras(self._operator.recordable(self._name))
        window.recording.show_recording(self._operator.recordings.status(self._name))
        series = feeds.get(IMU)
        if series is not None:
            window.graph.show_value(series.take())
        scan = feeds.get(SCAN)
        if scan is not None:
            self._draw_scan(scan)
        camera = feeds.get(window.camera.kind) if window.camera.kind in (RGB, DEPTH) else None
        if camera is not None:
            self._draw_camera(camera)
        self._draw_state(view, feeds)
        while self._notes:
            window.camera.show_note(*self._notes.pop())

    def _draw_state(self, view, feeds):
        """Show how old each stream is, and what motion capture says.

        The age of the odometry is that of the link, in the header.
        """
        ages = []
        for key, name in ((IMU, 'IMU'), (SCAN, 'scan'), *_CAMERA_NAMES.items()):
            feed = feeds.get(key)
            if feed is not None:
                ages.append((name, feed.age_s()))
        tracker = feeds.get(MOCAP)
        captured = tracker.pose() if tracker else None
        if captured is not None:
            ages.append(('capture', tracker.age_s()))
        odometry = None if view.x_m is None else Pose(view.x_m, view.y_m, view.heading_rad)
        self.window.state_line.show_state(
            StateView(tuple(ages), view.figures, captured, self._drift.drift(odometry, captured)))

    def _operator_folder(self):
        """Let the file dialog begin where recordings go unless told otherwise."""
        self.window.recording.set_default_path(
            os.path.join(recordings_folder(), '{}_<date-time>.bag'.format(self._name)))

    def _record(self, path, choices):
        self._operator.record(self._name, path, choices)

    def _stop_recording(self):
        self._operator.recordings.stop(self._name)

    def _draw_scan(self, feed):
        scan = feed.take()
        if scan is not None:
            self.window.scan.show_value(scan)
        self.window.scan.show_age(feed.age_s())

    def _draw_camera(self, feed):
        width, height = self.window.camera_size()
        settings = self._operator.settings
        if not self.behind:
            feed.set_view(width, height)
        else:
            small = min(width, settings.thumbnail_width_px)
            feed.set_view(small, max(1, round(height * small / max(1, width))),
                          settings.thumbnail_hz)
        frame = feed.take()
        camera = self.window.camera
        if frame is not None:
            camera.show_frame(frame)
        status = feed.status()
        camera.show_status(status, (settings.thumbnail_hz, self.behind) if self.behind else None)
        if status.age_s is None and status.problem:
            camera.show_placeholder(status.problem)
        camera.show_transports(feed.transports())

    def _choose_transport(self, name):
        feeds = self._operator.feeds(self._name)
        feed = feeds.get(self.window.camera.kind) if feeds else None
        if feed is not None:
            feed.choose(name)

    def _save_still(self, frame):
        """Write the picture on show to the folder of the recordings, off the GUI thread."""
        path = os.path.join(recordings_folder(), still_name(self._name, frame.kind, datetime.now()))
        self._operator.do(self._write_still, path, frame.rgb)

    def _write_still(self, path, rgb):
        """Write a PNG (on the operator's worker); what came of it is shown at the next drawing."""
        try:
            os.makedirs(os.path.dirname(path), exist_ok=True)
            written = cv2.imwrite(path, cv2.cvtColor(rgb, cv2.COLOR_RGB2BGR))
        except (OSError, cv2.error):
            written = False
        self._notes.append(('saved {}'.format(path), True) if written else (
            'cannot write {}: is there room, and permission?'.format(path), False))

    def close(self):
        """Let the feeds rest: a closed window costs nothing."""
        self.guard.end()
        feeds = self._operator.feeds(self._name)
        if feeds is not None:
            feeds.want(())
