# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The streams that the link carries between a robot's own master and the host's.

Commands reach the robot only through its guard, which accepts or drops them by its lease.
Velocity topics are never carried, so that nothing can bypass the guard.
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
# Frames with these names are shared by all robots.
SHARED_FRAMES = ('map', 'world', 'mhri_world')
# Maximum rate of each kind of message from the robot [Hz]; 0: no limit. The guard sends few.
RATES_HZ: Dict[str, float] = {
    'odometry': 50.0, 'imu': 100.0, 'scan': 10.0, 'battery': 2.0, 'rgb': 30.0, 'depth': 15.0,
    'cloud': 2.0}
# Weights of states on a radio that cannot carry everything; the default is 1.
WEIGHTS: Dict[str, float] = {'imu': 0.7, 'scan': 0.2}
# Minimum rate of the pose [Hz]: with 20 % loss it is rarely more than 0.25 s late.
MIN_HZ: Dict[str, float] = {'odometry': 8.0}
PICTURES = ('rgb', 'depth', 'cloud')
# Number of frame names at the start of a message, after its number and stamp.
FRAME_NAMES = {'nav_msgs/Odometry': 2, 'sensor_msgs/Imu': 1, 'sensor_msgs/LaserScan': 1,
               'sensor_msgs/BatteryState': 1, 'sensor_msgs/Image': 1,
               'sensor_msgs/CompressedImage': 1, 'sensor_msgs/PointCloud2': 1}
_PACKED = ('/compressed', '/compressedDepth')


@dataclass(frozen=True)
class Stream:
    """One topic carried by the link.

    :param topic: relative to the robot's namespace, or ``/tf``, ``/tf_static``
    :param urgency: :data:`COMMAND`, :data:`STATE` or :data:`PICTURE`
    :param rate_hz: maximum rate [Hz], 0 for no limit
    :param latched: the newest message is also sent to later subscribers
    :param weight: its share relative to others on a radio that cannot carry everything
    :param min_hz: its minimum rate even then
    """

    topic: str
    urgency: str
    rate_hz: float = 0.0
    latched: bool = False
    weight: float = 1.0
    min_hz: float = 0.0


# From the host to the robot, with their ROS types.
DOWN = ((Stream(GUARD_COMMAND, COMMAND), 'geometry_msgs/TwistStamped'),
        (Stream(GUARD_HEARD, COMMAND), 'std_msgs/String'))


def up_streams(robot_type: RobotType) -> List[Stream]:
    """Return the streams that a robot of a type may send to the host."""
    streams = [Stream(GUARD_ECHO, COMMAND), Stream('mhri_guard/state', STATE, latched=True),
               Stream('mhri_guard/dropped', STATE, 10.0),
               Stream(TF, STATE, 20.0, weight=0.7),
               Stream(TF_STATIC, STATE, latched=True)]
    for key, rate_hz in RATES_HZ.items():
        urgency = PICTURE if key in PICTURES else STATE
        for topic in getattr(robot_type, key):
            streams.append(Stream(topic.lstrip('/'), urgency, rate_hz,
                                  weight=WEIGHTS.get(key, 1.0),
                                  min_hz=MIN_HZ.get(key, 0.0)))
            if key in ('rgb', 'depth'):
                streams += [Stream(topic.lstrip('/') + tail, urgency, rate_hz) for tail in _PACKED]
    return list({stream.topic: stream for stream in streams}.values())


def worth_carrying(streams: Collection[Stream], published: Collection[str]) -> List[Stream]:
    """Return the published streams; a raw picture only if it has no compressed version.

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
    """Limits the rate of a stream; times are [s]."""

    def __init__(self, rate_hz: float) -> None:
        self._due = 0.0
        self.change(rate_hz)

    def change(self, rate_hz: float) -> None:
        """Set another rate [Hz], 0 for no limit."""
        self._period_s = 1.0 / rate_hz if rate_hz else 0.0

    def lets(self, now: float) -> bool:
        """Return whether a message at this time may pass."""
        # Half a period early counts as on time, so that a source of about that rate is not thinned.
        if now < self._due - 0.5 * self._period_s:
            return False
        self._due = max(self._due, now - self._period_s) + self._period_s
        return True


def split_frames(text: str) -> Tuple[str, ...]:
    """Return the shared frames of a parameter such as ``map world``."""
    return tuple(text.replace(',', ' ').split())
