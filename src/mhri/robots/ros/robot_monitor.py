# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Monitors one robot: odometry, link and the proof of its stops."""
import math
import threading
import time
from dataclasses import replace

from mhri.base.reasons import STOPPED_ALONE
from mhri.base.views import GONE, LIVE, SILENT
from mhri.recording.recording import moment_text
from mhri.robots.figures import FIGURES_S, thinned_words
from mhri.robots.link import link_note, link_state
from mhri.robots.link_quality import link_warning, LinkQuality
from mhri.robots.robot_view import robot_view
from mhri.robots.ros.convert import from_twist, round_trip_s
from mhri.robots.ros.readouts import Readouts
from mhri.robots.ros.streams import (
    BATTERY_CHARGE, CONTROL, DROPPED, FETCHED, HARDWARE_STOP, ODOMETRY, RADIO, RobotStreams)
from mhri.robots.stamp_age import delay_of, StampAge
from mhri.robots.stop_proof import OdometryWitness, StopProof

DROPPED_SHOWN_S = 1.0
# A robot that has taken commands for this long without odometry has none.
MUTE_AFTER_S = 3.0
# Why its sensors are silent, by the state of its link.
_SILENT = {SILENT: 'the robot is silent', GONE: 'the robot is gone'}


class RobotMonitor:
    """A robot's newest state, under a lock for the GUI thread.

    :param name: the robot's namespace
    :param robot_type: :class:`mhri.base.robot_types.RobotType`
    :param drive: :class:`mhri.driving.ros.drive_client.DriveClient`
    :param feeds: :class:`mhri.robots.ros.bot_feeds.BotFeeds` of its tile
    :param clock: function that returns monotonic seconds
    :param wall: function that returns the time of day [s since 1970]
    :param quality: factory of the link measurement
    """

    def __init__(self, name, robot_type, drive, feeds, clock=time.monotonic, wall=time.time,
                 quality=LinkQuality):
        self.name = name
        self.robot_type = robot_type
        self._drive = drive
        self.feeds = feeds
        self._clock = clock
        self._wall = wall
        self._lock = threading.Lock()
        self.added_at = clock()
        self._heard_at = None
        self._reached_at = None
        self._heard_wall = ''
        self._motion = None
        self._quality = quality()
        self._ages = {}
        self._proof, self._follows = None, not self._found_odometry()
        # Odometry that was found is judged here, too: the drive may not have found it.
        self._witness = OdometryWitness(self._follows)
        # Whether stop-all is in force, and the robot's own stop.
        self._stopped = self._alone = False
        self._streams = RobotStreams(
            name, robot_type, (ODOMETRY, BATTERY_CHARGE, HARDWARE_STOP, CONTROL, DROPPED, RADIO,
                               FETCHED), clock, {ODOMETRY: self._on_odometry})
        feeds.others[ODOMETRY.key] = self._streams[ODOMETRY]
        self._readouts = Readouts(name, robot_type, clock)
        self._streams.open(ODOMETRY, BATTERY_CHARGE, HARDWARE_STOP, CONTROL)
        self._readouts.open()

    def on_drive(self, robot):
        """Handle the state of this robot in the drive (``mhri/RobotDrive``), on a ROS thread."""
        with self._lock:
            self._quality.on_round_trip(round_trip_s(robot))
            if not self._is_proven():
                self._witness.on_command(from_twist(robot.sent), self._clock())
            self._follows = robot.odometry_follows and self._is_proven()
            if self._proof is not None:
                self._proof.follows = self._follows
            self._settle(self._stopped, robot.stands == STOPPED_ALONE, self._clock())

    def _on_odometry(self, newest):
        came_at, now, reading = self._wall(), newest.at_s, newest.value
        late_s = 0.0
        if reading is not None:
            self.feeds.frames = reading.frames
        with self._lock:
            # No older value may pass for a new one.
            self._motion = reading and reading.motion
            if reading is not None and reading.header is not None:
                number, stamp_s = reading.header
                late_s = self._ages.setdefault(newest.number, StampAge()).late_s(stamp_s, now)
                self._quality.on_message(number, delay_of(came_at, stamp_s), now)
            self._heard_at = now
            # Malformed messages prove nothing, nor does anything before them.
            if self._motion is not None and not self._is_proven():
                self._witness.on_motion(self._motion, now, math.nan)
            if self._proof is not None and self._motion is not None:
                self._proof.on_motion(self._motion, now, late_s)

    def listen_to_guard(self):
        """Subscribe the streams of the robot's guard, if any (blocking: it asks the master)."""
        robot = self._drive.robot(self.name)
        if robot is not None and robot.guarded:
            self._streams.open(DROPPED, RADIO, FETCHED)

    def on_stop(self, stopped, now):
        """Start (or end) the proof of a stop of all robots; :meth:`on_drive` that of this one."""
        with self._lock:
            self._settle(stopped, self._alone, now)

    def _settle(self, stopped, alone, now):
        """Start a proof with each new stop, and end it with the last one.

        While stop-all is in force, the drive does not report the robot's own stop; once released,
        it does so again, and the proof goes on.
        """
        if stopped and not self._stopped or alone and not self._alone and not stopped:
            self._proof = StopProof(now, self._quality.read(now).round_trip_s,
                                    self.robot_type.silent_after_s)
            self._proof.follows = self._follows
        elif not (stopped or alone):
            self._proof = None
        self._stopped, self._alone = stopped, alone

    def view(self, problem='', no_odometry='', **ours):
        """Return the :class:`RobotView` of this moment; arguments as for :func:`robot_view`.

        :param no_odometry: what there is in place of its odometry, '' for nothing
        """
        now = self._clock()
        connections = self._streams[ODOMETRY].connections()
        with self._lock:
            age = None if self._heard_at is None else now - self._heard_at
            motion, limits = self._motion, self.robot_type.limits
            state = link_state(age, connections, self.robot_type.silent_after_s,
                               self._takes_commands(now))
            if age is not None and (age < 1.0 or not self._heard_wall):
                self._heard_wall = moment_text(self._wall())
            proof = self._proof.view(now) if self._proof else None
            figures = self._with_radio(self._quality.read(now))
        dropped = self._streams[DROPPED].value(DROPPED_SHOWN_S) is not None
        warning = link_warning(figures, dropped) if state == LIVE else ''
        return robot_view({
            'name': self.name, 'type_label': self.robot_type.label,
            'window': self.robot_type.window, 'link': state, 'age_s': age,
            'note': link_note(state, age, self._heard_wall, now - self.added_at, no_odometry)
            or warning
            or self._streams[FETCHED].value() or (motion.note if motion else ''),
            'figures': figures, 'slow': bool(warning), **_numbers(motion),
            'battery': self._streams[BATTERY_CHARGE].value(), 'proof': proof,
            # A live robot with impossible values may well be moving.
            'moving': age is not None and age < 1.0 and not (motion and motion.is_standstill()),
            'hardware_stop': self._streams[HARDWARE_STOP].value_while_connected(),
            'max_linear_mps': limits.linear_mps, 'max_angular_rad_s': limits.angular_rad_s,
            'offers_power': self.robot_type.motor_power is not None,
            'accessories': self._readouts.views(_SILENT.get(state, '')),
        }, self._drive.robot(self.name), self._drive.answers(),
            self._streams[CONTROL].value(), problem,
            '' if self._is_proven() else self._found_odometry(), **ours)

    def _is_proven(self):
        """Return whether its odometry is that of its type, or has followed a command."""
        return self._witness.follows or not self._found_odometry()

    def _found_odometry(self):
        """Return the topic of its odometry if its type does not have it, else ''."""
        return self.robot_type.odometry[-1] if 'odometry' in self.robot_type.found else ''

    def _with_radio(self, figures):
        """Return figures with those of a link to the robot's own master, if there is one."""
        radio = self._streams[RADIO].value(FIGURES_S)
        if radio is None:
            return figures
        known = {key: value for key, value in (
            ('round_trip_s', radio.round_trip), ('loss', radio.loss)) if math.isfinite(value)}
        return replace(figures, thinned='; '.join(thinned_words(radio)), **known)

    def _takes_commands(self, now):
        """Return whether commands have been received for long enough to expect odometry."""
        robot = self._drive.robot(self.name)
        if robot is None or not robot.topic or not self._drive.answers():
            self._reached_at = None
        elif self._reached_at is None:
            self._reached_at = now
        return self._reached_at is not None and now - self._reached_at > MUTE_AFTER_S

    def close(self):
        """Stop listening (blocking: it asks the master)."""
        self.feeds.close()
        self._streams.close()
        self._readouts.close()


def _numbers(motion):
    """Return the numbers of a view from a :class:`Motion`, as {key: value}."""
    keys = 'linear_mps', 'angular_rad_s', 'lateral_mps', 'heading_rad', 'x_m', 'y_m'
    values = {key: getattr(motion, key) for key in keys if motion is not None}
    return {key: value for key, value in values.items()
            if value is not None and math.isfinite(value)}
