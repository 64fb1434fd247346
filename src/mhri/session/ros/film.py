# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Writes the film of a session at a constant frame rate with OpenCV (FFmpeg)."""
from collections import defaultdict
import os

from mhri.base.geometry import composed, Pose
from mhri.base.io.files import whole
from mhri.base.opencv import cv2
from mhri.camera.image_codec import decode_compressed
from mhri.camera.images import FrameError
from mhri.camera.shades import Shades
from mhri.recording.folder import NotASession
from mhri.session.film import (
    cameras_of, frame_count, frame_of, frame_size, Headings, map_size, OLD_S, Tile)
from mhri.session.film_map import FilmMap
from mhri.session.ros.session_reader import PLACES

FILM = 'film.mp4'
# H.264, which every browser plays, if there is an encoder; else MPEG-4.
_CODECS = ('avc1', 'mp4v')
_PICTURES = 'sensor_msgs/CompressedImage'
_NS = 10 ** 9
# Maximum width and height of a picture; larger ones are rejected as hostile [px].
_LARGEST = 10000


class Film:
    """Reads the pictures of a session in order of time.

    :param builder: :class:`mhri.session.ros.session_reader.ReportBuilder` of ``report``
    :raises NotASession: the session has no pictures
    """

    def __init__(self, session, builder, report):
        self._session, self._builder = session, builder
        self._line, self._headings = report.line, Headings(report)
        topics = [connection.topic for connection in session.bags.connections()
                  if connection.kind == _PICTURES] if session.bags else []
        self._cameras = cameras_of(session.robots, {
            robot.name: robot.number for robot in report.robots}, topics)
        if not self._cameras:
            raise NotASession('{}: no film: no pictures of cameras are recorded in it'.format(
                session.path))
        self._newest, self._decoded, self._motions = {}, {}, {}
        self._shades = defaultdict(Shades)
        self._origins = None, {}
        size = map_size(len(self._cameras))
        self._map = FilmMap(report, builder.grid, size) if size else None
        if self._map is not None and not self._map.names:
            self._map = None

    def write(self, folder, fps, progress):
        """Write the film into a folder (blocks for a long time); return its path.

        :param progress: called with (frames written, all frames)
        :raises OSError: the film cannot be written
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
        """Yield every frame, each with the newest picture of every camera."""
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
            the_map = None if self._map is None else self._map.at(at_s, dict(self._poses(until_ns)))
            yield frame_of([self._tile(camera, until_ns) for camera in self._cameras], heading,
                           stopped, the_map)

    def _wanted(self, connection):
        return (connection.kind == _PICTURES and connection.topic in {
            camera.topic for camera in self._cameras}) or self._builder.is_odometry(connection) \
            or self._builder.is_places(connection)

    def _tile(self, camera, now_ns):
        recorded = self._newest.get(camera.topic)
        if recorded is None:
            return Tile(camera, speed_mps=self._speed(camera.robot))
        known = self._decoded.get(camera.topic)
        if known is None or known[0] is not recorded:
            picture = self._decode(recorded)
            # A damaged picture is skipped; the previous one is kept.
            picture = picture if picture is not None else known[1] if known else None
            known = self._decoded[camera.topic] = recorded, picture
        return Tile(camera, known[1], (now_ns - recorded.time_ns) / _NS, self._speed(camera.robot))

    def _poses(self, now_ns):
        """Yield (robot, (its pose on the map, whether it is lost)) of the robots on the map."""
        for robot in self._map.names:
            motion, origin = self._motion(robot), self._origin(robot)
            if motion is None or motion.pose is None or origin is None:
                continue
            recorded = self._newest[self._builder.odometry_topic(robot)]
            yield robot, (composed(origin, motion.pose),
                          (now_ns - recorded.time_ns) / _NS > OLD_S)

    def _origin(self, robot):
        """Return the origin of a robot's odometry in the frame of the map, None if unknown."""
        if not self._map.placed:
            return Pose(0.0, 0.0, 0.0)
        recorded = self._newest.get(PLACES)
        if recorded is not None and recorded is not self._origins[0]:
            known = self._origins[1]
            # A lost robot may have no place any more: it stays where it was.
            self._origins = recorded, {**known, **{
                name: pose for name, pose in self._builder.origins(recorded).items()
                if pose is not None}}
        return self._origins[1].get(robot)

    def _speed(self, robot):
        motion = self._motion(robot)
        return None if motion is None else motion.speed_mps

    def _motion(self, robot):
        """Return the newest possible :class:`Motion` of a robot, None without one."""
        recorded = self._newest.get(self._builder.odometry_topic(robot))
        if recorded is None:
            return None
        if self._motions.get(robot, (None, None))[0] is not recorded:
            motion = self._builder.motion(recorded)
            self._motions[robot] = recorded, motion if motion is not None \
                and motion.is_possible() else None
        return self._motions[robot][1]

    def _decode(self, recorded):
        message = self._builder.message(recorded)
        if message is None:
            return None
        try:
            pixels, size, _ = decode_compressed(message.format, message.data)
        except FrameError:
            return None
        rgb = self._shades[recorded.connection.topic].rgb(pixels, recorded.time_ns / _NS)[0]
        return rgb[..., ::-1] if max(size) <= _LARGEST else None


def _writer(path, fps, size):
    """Return an open ``cv2.VideoWriter``.

    :raises OSError: there is no encoder, or the file cannot be written
    """
    for codec in _CODECS:
        writer = cv2.VideoWriter(path, cv2.CAP_FFMPEG, cv2.VideoWriter_fourcc(*codec), fps, size)
        if writer.isOpened():
            return writer
        writer.release()
    raise OSError('{} cannot be written: OpenCV has no encoder for it, or the folder is not '
                  'writable'.format(path))
