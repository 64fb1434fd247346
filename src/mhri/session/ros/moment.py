# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What a mark keeps of a moment: where every robot is, and what every camera in sight shows."""
import genpy
import numpy as np
import rospy
from sensor_msgs.msg import CompressedImage

from mhri.base.mocap import Pose
from mhri.base.names import topic_of
from mhri.graph.ros.messages import message_class, MessageMissing
from mhri.map.places import composed
from mhri.msg import Places
from mhri.recording.folder import still_name
from mhri.robots.ros.odometry import MOTIONS
from mhri.session.topics import camera_topics

PLACES = '/mhri_tasks/places'
# A picture that is older is not in sight [s].
IN_SIGHT_S = 3.0
_JPEG = b'\xff\xd8'


def read(kind, frame):
    """Return the message of a frame (its length and bytes).

    :raises genpy.DeserializationError: it is none
    """
    message = kind()
    message.deserialize(frame[4:])
    return message


def jpeg_of(frame):
    """Return the jpeg of a compressed picture's frame, None where it is no picture.

    :raises genpy.DeserializationError: it is no ``sensor_msgs/CompressedImage``
    """
    data = bytes(read(CompressedImage, frame).data)
    if data.startswith(_JPEG):
        return data
    from mhri.base.opencv import cv2  # nearly every camera has jpegs: a start does not wait for it
    try:
        pixels = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_COLOR) if data else None
        done, found = cv2.imencode('.jpg', pixels) if pixels is not None else (False, None)
    except cv2.error:
        return None  # more pixels than a jpeg can have
    return found.tobytes() if done else None


class Moment:
    """Reads the newest messages of a :class:`mhri.session.ros.tap.SessionTap`.

    :param robots: :class:`mhri.session.ros.graph_robots.GraphRobots`
    """

    def __init__(self, tap, robots):
        self._tap = tap
        self._robots = robots

    def _odometry(self, robot, kind):
        """Return (Pose, its frame) by a robot's odometry, None without any."""
        for name in kind.odometry:
            source = self._tap.newest(topic_of(robot, name))
            if source is None or source.fields['type'] not in MOTIONS:
                continue
            try:
                message = read(message_class(source.fields['type']), source.frame)
            except (MessageMissing, genpy.DeserializationError) as error:
                rospy.logdebug('%s: %s', source.fields['topic'], error)
                continue
            motion = MOTIONS[source.fields['type']](message)
            if not motion.is_possible():
                continue
            frame = message.header.frame_id if message._has_header else ''
            return Pose(motion.x_m, motion.y_m, motion.heading_rad), frame or robot + '/odom'
        return None

    def _origins(self):
        """Return ({robot: origin of its odometry}, the map's frame) as far as robots are placed."""
        source = self._tap.newest(PLACES)
        if source is None:
            return {}, 'map'
        message = read(Places, source.frame)
        return {place.robot: Pose(place.odometry.x, place.odometry.y, place.odometry.theta)
                for place in message.robots if place.odometry.x == place.odometry.x
                }, message.header.frame_id

    def frame(self):
        """Return the frame in which robots are placed."""
        return self._origins()[1] or 'map'

    def poses(self):
        """Return {robot: [x [m], y [m], heading [rad], frame]} of those that are heard.

        In the frame of the map where a robot is placed, else in that of its odometry.
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
        """Yield (path in the folder, jpeg) of every camera in sight.

        :param stem: what their names begin with, such as the mark's
        """
        pictures = self._tap.pictures(IN_SIGHT_S)
        for robot, kind in list(self._robots.kinds.items()):
            for topic in camera_topics(robot, kind):
                if topic not in pictures or topic.endswith('/compressedDepth'):
                    continue
                jpeg = jpeg_of(pictures[topic].frame)
                if jpeg is not None:
                    yield still_name(stem, robot), jpeg
                    break
