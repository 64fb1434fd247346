# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The film of a session, written frame by frame at a constant rate, by OpenCV (FFmpeg)."""
import os

import numpy as np

from mhri.base.opencv import cv2
from mhri.recording.folder import NotASession
from mhri.session.film import cameras_of, frame_count, frame_of, frame_size, Headings, Tile
from mhri.session.ros.report_files import whole

FILM = 'film.mp4'
# H.264, which every browser shows, where there is an encoder; else MPEG-4.
_CODECS = ('avc1', 'mp4v')
_PICTURES = 'sensor_msgs/CompressedImage'
_NS = 10 ** 9
# No camera of a robot has more in each direction; a hostile one may claim to [px].
_LARGEST = 10000


class Film:
    """Reads the pictures of a session in order of time.

    :param teller: the :class:`mhri.session.ros.told.Teller` that has made ``report``
    :raises NotASession: there are no pictures in it
    """

    def __init__(self, session, teller, report):
        self._session, self._teller = session, teller
        self._line, self._headings = report.line, Headings(report)
        topics = [connection.topic for connection in session.bags.connections()
                  if connection.kind == _PICTURES] if session.bags else []
        self._cameras = cameras_of(session.robots, {
            robot.name: robot.number for robot in report.robots}, topics)
        if not self._cameras:
            raise NotASession('{}: no film: no pictures of cameras are recorded in it'.format(
                session.path))
        self._newest, self._decoded, self._speeds = {}, {}, {}

    def write(self, folder, fps, progress):
        """Write the film into a folder (blocking for long); return its path.

        :param progress: called with (frames that are done, all frames)
        :raises OSError: it cannot be written
        """
        path = os.path.join(folder, FILM)
        count = frame_count(self._line.length_s, fps)
        with whole(path) as part:
            writer = _writer(part, fps, frame_size(len(self._cameras)))
            try:
                for number, frame in enumerate(self._frames(count, fps), 1):
                    writer.write(frame)
                    progress(number, count)
            finally:
                writer.release()
            if not os.path.isfile(part) or not os.path.getsize(part):
                raise OSError('{} could not be written: is the disk full?'.format(path))
        return path

    def _frames(self, count, fps):
        """Yield every frame: pictures between two are left out, missing ones are repeated."""
        bags = self._session.bags
        bags.step_s = 0.0
        coming = bags.after(bags.start_ns - 1, self._wanted)
        ahead = next(coming, None)
        for number in range(count):
            at_s = number / fps
            until_ns = bags.start_ns + round(at_s * _NS)
            while ahead is not None and ahead.time_ns <= until_ns:
                self._newest[ahead.connection.topic] = ahead
                ahead = next(coming, None)
            heading, stopped = self._headings.at(at_s)
            yield frame_of([self._tile(camera, until_ns) for camera in self._cameras], heading,
                           stopped)

    def _wanted(self, connection):
        return (connection.kind == _PICTURES and connection.topic in {
            camera.topic for camera in self._cameras}) or self._teller.is_odometry(connection)

    def _tile(self, camera, now_ns):
        recorded = self._newest.get(camera.topic)
        if recorded is None:
            return Tile(camera, speed_mps=self._speed(camera.robot))
        known = self._decoded.get(camera.topic)
        if known is None or known[0] is not recorded:
            picture = self._decode(recorded)
            # A damaged picture leaves the one before it.
            picture = picture if picture is not None else known[1] if known else None
            known = self._decoded[camera.topic] = recorded, picture
        return Tile(camera, known[1], (now_ns - recorded.time_ns) / _NS, self._speed(camera.robot))

    def _speed(self, robot):
        recorded = self._newest.get(self._teller.odometry_topic(robot))
        if recorded is None:
            return None
        if self._speeds.get(robot, (None, None))[0] is not recorded:
            motion = self._teller.motion(recorded)
            self._speeds[robot] = recorded, motion.speed_mps if motion is not None \
                and motion.is_possible() else None
        return self._speeds[robot][1]

    def _decode(self, recorded):
        message = self._teller.message(recorded)
        if message is None or not message.data:
            return None
        try:
            picture = cv2.imdecode(np.frombuffer(message.data, np.uint8), cv2.IMREAD_COLOR)
        except cv2.error:
            return None
        return picture if picture is not None and max(picture.shape) <= _LARGEST else None


def _writer(path, fps, size):
    """Return an open ``cv2.VideoWriter``.

    :raises OSError: there is no encoder, or the file cannot be written
    """
    for codec in _CODECS:
        writer = cv2.VideoWriter(path, cv2.CAP_FFMPEG, cv2.VideoWriter_fourcc(*codec), fps, size)
        if writer.isOpened():
            return writer
        writer.release()
    raise OSError('{} cannot be written: OpenCV has no encoder for it, or the folder takes no '
                  'files'.format(path))
