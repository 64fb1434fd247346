# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What the link carries between a robot's own master and the host's, and how.

Commands go down through the guard on the robot alone: its lease is the one rule for what is obeyed.
A velocity topic itself is not carried, so that nothing drives around the guard.
"""
from dataclasses import dataclass
from typing import Collection, Dict, List, Tuple

from mhri.base.robot_types import RobotType

# Classes of streams, the most urgent first.
COMMAND, STATE, PICTURE = 'command', 'state', 'picture'
TF, TF_STATIC = '/tf', '/tf_static'
TF_TYPE = 'tf2_msgs/TFMessage'
GUARD_COMMAND = 'mhri_guard/command'
GUARD_ECHO = 'mhri_guard/echo'
GUARD_HEARD = 'mhri_guard/heard'
# A frame of this name is everybody's.
SHARED_FRAMES = ('map', 'world', 'mhri_world')
# At most so many messages of a kind go up in a second; 0 is all of them. The guard's are few.
RATES_HZ: Dict[str, float] = {
    'odometry': 50.0, 'imu': 100.0, 'scan': 10.0, 'battery': 2.0, 'rgb': 30.0, 'depth': 15.0,
    'cloud': 2.0}
# Where a radio does not bear all, states go in these proportions; what has none counts as one.
WEIGHTS: Dict[str, float] = {'imu': 0.7, 'scan': 0.2}
# Before all that, so much of the pose: losing a fifth, it is seldom older by more than 0.25 s [Hz].
LEAST_HZ: Dict[str, float] = {'odometry': 8.0}
PICTURES = ('rgb', 'depth', 'cloud')
# How many frame names a message begins with, behind number and stamp.
FRAME_NAMES = {'nav_msgs/Odometry': 2, 'sensor_msgs/Imu': 1, 'sensor_msgs/LaserScan': 1,
               'sensor_msgs/BatteryState': 1, 'sensor_msgs/Image': 1,
               'sensor_msgs/CompressedImage': 1, 'sensor_msgs/PointCloud2': 1}
_PACKED = ('/compressed', '/compressedDepth')


@dataclass(frozen=True)
class Stream:
    """One topic that is carried.

    :param topic: relative to the robot's namespace, or ``/tf``, ``/tf_static``
    :param urgency: :data:`COMMAND`, :data:`STATE` or :data:`PICTURE`
    :param rate_hz: the most messages in a second, 0 for all
    :param latched: the newest message is for those who come later, too
    :param weight: how often it goes beside others where a radio does not bear all
    :param least_hz: and at least so often
    """

    topic: str
    urgency: str
    rate_hz: float = 0.0
    latched: bool = False
    weight: float = 1.0
    least_hz: float = 0.0


# From the host to the robot, with their ROS types.
DOWN = ((Stream(GUARD_COMMAND, COMMAND), 'geometry_msgs/TwistStamped'),
        (Stream(GUARD_HEARD, COMMAND), 'std_msgs/String'))


def up_streams(robot_type: RobotType) -> List[Stream]:
    """Return what may go from a robot of a type to the host, if it is there."""
    streams = [Stream(GUARD_ECHO, COMMAND), Stream('mhri_guard/state', STATE, latched=True),
               Stream('mhri_guard/dropped', STATE, 10.0),
               Stream(TF, STATE, 20.0, weight=0.7),
               Stream(TF_STATIC, STATE, latched=True)]
    for key, rate_hz in RATES_HZ.items():
        urgency = PICTURE if key in PICTURES else STATE
        for topic in getattr(robot_type, key):
            streams.append(Stream(topic.lstrip('/'), urgency, rate_hz,
                                  weight=WEIGHTS.get(key, 1.0),
                                  least_hz=LEAST_HZ.get(key, 0.0)))
            if key in ('rgb', 'depth'):
                streams += [Stream(topic.lstrip('/') + tail, urgency, rate_hz) for tail in _PACKED]
    return list({stream.topic: stream for stream in streams}.values())


def worth_carrying(streams: Collection[Stream], published: Collection[str]) -> List[Stream]:
    """Return the streams that are published; a raw picture only where there is no packed one.

    :param published: topics as in :class:`Stream`
    """
    return [stream for stream in streams if stream.topic in published
            and not any(stream.topic + tail in published for tail in _PACKED)]


def full_topic(namespace: str, topic: str) -> str:
    """Return the absolute name of a stream's topic on one side.

    :param namespace: of the robot on that side, such as ``/bot1``; '' for a robot without one
    """
    return topic if topic.startswith('/') else '{}/{}'.format(namespace, topic)


def key_of(robot: str, host: str, way: str, topic: str) -> str:
    """Return the key expression of a stream between a robot and one host.

    :param host: its name, such as ``host:lab`` (see :mod:`mhri.link.keys`)
    :param way: ``up`` or ``down``
    """
    return 'mhri/{}/{}/{}/{}'.format(robot, host, way, topic.lstrip('/'))


class Pace:
    """Lets through at most so many messages of a stream in a second; times are [s]."""

    def __init__(self, rate_hz: float) -> None:
        self._due = 0.0
        self.change(rate_hz)

    def change(self, rate_hz: float) -> None:
        """Go over to another rate [Hz], 0 for all."""
        self._period_s = 1.0 / rate_hz if rate_hz else 0.0

    def lets(self, now: float) -> bool:
        """Tell whether a message of this moment goes on."""
        # Half a period early is on time: a source of about that rate keeps its rhythm.
        if now < self._due - 0.5 * self._period_s:
            return False
        self._due = max(self._due, now - self._period_s) + self._period_s
        return True


def split_frames(text: str) -> Tuple[str, ...]:
    """Return the frames that are everybody's, from a parameter such as ``map world``."""
    return tuple(text.replace(',', ' ').split())
