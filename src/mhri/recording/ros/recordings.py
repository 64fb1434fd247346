# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The recordings of all robots in one program: at most one running per robot."""
import threading

from mhri.recording.recording import RECORDING, RecordingLimits, RecordingStatus, topics_of
from mhri.recording.ros.recorder import Recorder

NOTHING = RecordingStatus()


class Recordings:
    """Starts, stops and closes recordings; every method but :meth:`close` returns at once.

    ``limits`` (:class:`RecordingLimits`) apply to recordings started from now on.
    """

    def __init__(self):
        self.limits = RecordingLimits()
        self._lock = threading.Lock()
        self._recorders = {}
        # Stopped recordings with a successor, whose files are still being closed.
        self._closing = []
        self._stopped = set()

    def start(self, robot, robot_type, path='', choices=()):
        """Start recording a robot; a running recording continues unchanged.

        A new recording can start while the previous one is still being closed.

        :param robot_type: :class:`mhri.base.robot_types.RobotType`
        :param path: as the operator typed it, '' for the default
        :param choices: keys of :data:`mhri.recording.recording.CHOICES` besides the IMU
        """
        with self._lock:
            old = self._recorders.get(robot)
            if old is not None and old.status().state == RECORDING:
                if robot not in self._stopped:
                    return
                self._closing = [recorder for recorder in self._closing
                                 if recorder.status().state == RECORDING] + [old]
            recorder = Recorder(robot, topics_of(robot, robot_type, choices), path, self.limits)
            self._stopped.discard(robot)
            self._recorders[robot] = recorder
        recorder.start()

    def stop(self, robot):
        """Stop a robot's recording; its file is closed in the background."""
        with self._lock:
            recorder = self._recorders.get(robot)
            self._stopped.add(robot)
        if recorder is not None:
            recorder.stop()

    def running(self):
        """Return the names of the robots being recorded."""
        with self._lock:
            items = list(self._recorders.items())
        return tuple(robot for robot, recorder in items if recorder.status().state == RECORDING)

    def status(self, robot):
        """Return the :class:`RecordingStatus` of a robot's current or last recording."""
        recorder = self._recorders.get(robot)
        return recorder.status() if recorder else NOTHING

    def close(self):
        """Stop all recordings and wait until their files are complete and closed."""
        with self._lock:
            recorders = self._closing + list(self._recorders.values())
        for recorder in recorders:
            recorder.stop()
        for recorder in recorders:
            recorder.stop(wait=True)
