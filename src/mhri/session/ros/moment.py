# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The data of a mark: the pose of every robot, and a still of every active camera."""
import genpy
import rospy
from sensor_msgs.msg import CompressedImage

from mhri.base.geometry import composed, Pose
from mhri.base.names import topic_of
from mhri.graph.ros.messages import message_class, MessageMissing
from mhri.msg import Places
from mhri.recording.folder import still_name
from mhri.robots.ros.odometry import MOTIONS
from mhri.session.topics import camera_topics, is_depth

PLACES = '/mhri_tasks/places'
# A camera is active if its newest picture is at most this old [s].
IN_SIGHT_S = 3.0
_JPEG = b'\xff\xd8'


def read(kind, frame):
    """Return the message of a frame (its length and bytes).

    :raises genpy.DeserializationError: the bytes are malformed
    """
    message = kind()
    message.deserialize(frame[4:])
    return message


def jpeg_of(frame, depth=False):
    """Return the JPEG of a compressed picture's frame, None if it cannot be decoded.

    :param depth: it is a ``compressedDepth`` picture, to be coloured as on the screen
    :raises genpy.DeserializationError: the frame is not a valid ``sensor_msgs/CompressedImage``
    """
    picture = read(CompressedImage, frame)
    data = bytes(picture.data)
    if data.startswith(_JPEG):
        return data
    # Rarely needed: most cameras send JPEGs.
    from mhri.base.opencv import cv2
    from mhri.camera.depth_still import depth_still
    from mhri.camera.image_codec import decode_compressed
    from mhri.camera.images import FrameError
    from mhri.camera.shades import Shades
    try:
        pixels = depth_still(picture.format, data) if depth else Shades().rgb(
            decode_compressed(picture.format, data)[0], 0.0)[0][..., ::-1]
        done, found = cv2.imencode('.jpg', pixels)
    except (cv2.error, FrameError):
        return None  # too large for a JPEG, or no picture
    return found.tobytes() if done else None


class Moment:
    """Reads the newest messages of a :class:`mhri.session.ros.tap.SessionTap`.

    :param robots: :class:`mhri.session.ros.graph_robots.GraphRobots`
    """

    def __init__(self, tap, robots):
        self._tap = tap
        self._robots = robots

    def _odometry(self, robot, kind):
        """Return (Pose, its frame) by a robot's odometry, None if it has none."""
        for name in kind.odometry:
            source = self._tap.newest(topic_of(robot, name))
            if source is None or source.fields['type'] not in MOTIONS:
                continue
            try:
                message = read(message_class(source.fields['type']), source.frame)
            except (MessageMissing, genpy.DeserializationError) as error:
                rospy.logdebug('%s: %s', source.fields['topic'], error)
                continue
            pose = MOTIONS[source.fields['type']](message).pose
            if pose is not None:
                frame = message.header.frame_id if message._has_header else ''
                return pose, frame or robot + '/odom'
        return None

    def _origins(self):
        """Return ({robot: origin of its odometry on the map}, the map's frame)."""
        source = self._tap.newest(PLACES)
        if source is None:
            return {}, 'map'
        message = read(Places, source.frame)
        return {place.robot: Pose(place.odometry.x, place.odometry.y, place.odometry.theta)
                for place in message.robots if place.odometry.x == place.odometry.x
                }, message.header.frame_id

    def frame(self):
        """Return the frame of the map."""
        return self._origins()[1] or 'map'

    def poses(self):
        """Return {robot: [x [m], y [m], heading [rad], frame]} of the robots with odometry.

        The frame is the map's if the robot is placed on the map, else that of its odometry.
        """
        origins, map_frame = self._origins()
        found = {}
        for robot, kind in list(self._robots.kinds.items()):
            odometry = self._odometry(robot, kind)
            if odometry is None:
                continue
            pose, frame = odometry
            if robot in origins:
                pose, frame = composed(origins[robot], pose), map_frame
            found[robot] = [round(pose.x_m, 4), round(pose.y_m, 4), round(pose.heading_rad, 4),
                            frame]
        return found

    def stills(self, stem):
        """Yield (path in the folder, JPEG) of each robot's first active camera, RGB and depth.

        :param stem: start of the file names, such as the mark's name
        """
        pictures = self._tap.pictures(IN_SIGHT_S)
        for robot, kind in list(self._robots.kinds.items()):
            found = set()
            for topic in camera_topics(robot, kind):
                depth = is_depth(topic)
                if topic not in pictures or depth in found:
                    continue
                jpeg = jpeg_of(pictures[topic].frame, depth)
                if jpeg is not None:
                    found.add(depth)
                    yield still_name(stem, robot, depth), jpeg
