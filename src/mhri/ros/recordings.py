# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The recordings of all robots of one program: at most one for each at a time."""
from mhri.core.recording import RECORDING, RecordingStatus, topics_of
from mhri.ros.recorder import Recorder

NOTHING = RecordingStatus()


class Recordings:
    """Starts, stops and closes; every method but :meth:`close` returns at once."""

    def __init__(self):
        self._recorders = {}

    def start(self, robot, robot_type, path='', choices=()):
        """Begin to record a robot; one that is being recorded goes on as it is.

        :param robot_type: :class:`mhri.core.robot_types.RobotType`
        :param path: as the operator typed it, '' for the default
        :param choices: keys of :data:`mhri.core.recording.CHOICES` besides the IMU
        """
        old = self._recorders.get(robot)
        if old is None or old.status().state != RECORDING:
            recorder = Recorder(robot, topics_of(robot, robot_type, choices), path)
            self._recorders[robot] = recorder
            recorder.start()

    def stop(self, robot):
        """End the recording of a robot; its file is closed in the background."""
        if robot in self._recorders:
            self._recorders[robot].stop()

    def status(self, robot):
        """Return the :class:`RecordingStatus` of a robot's present or last recording."""
        recorder = self._recorders.get(robot)
        return recorder.status() if recorder else NOTHING

    def close(self):
        """End them all and wait until their files are closed whole."""
        for recorder in self._recorders.values():
            recorder.stop()
        for recorder in self._recorders.values():
            recorder.stop(wait=True)
