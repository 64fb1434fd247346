# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The streams of a robot, a row for each; the rows of its sensors are in their own packages."""
import math
import threading
import time
from typing import Any, Callable, NamedTuple

from geometry_msgs.msg import PoseStamped, TwistStamped
import rospy
from sensor_msgs.msg import BatteryState
from std_msgs.msg import String

from mhri.base.battery import Charge
from mhri.base.geometry import Pose, rotation_words
from mhri.base.names import topic_of
from mhri.base.plausible import PLACE, sifted
from mhri.graph.ros.messages import message_class, MessageMissing, read_field
from mhri.graph.ros.stream import Stream
from mhri.msg import LinkControl
from mhri.robots.figures import FETCHING, FETCHING_WORD, FIGURES, read_figures
from mhri.robots.ros.convert import yaw_of
from mhri.robots.ros.odometry import odometry_of


class StreamRow(NamedTuple):
    """A stream: its key, and a function of a robot's name and :class:`RobotType`.

    The function returns (topics, relative to the robot's namespace or absolute, () for a robot
    without the stream; class of their messages; function that reads one, see :class:`Stream`).

    :raises MessageMissing: (the function) the package of its messages is not installed
    """

    key: str
    of: Callable[[str, Any], tuple]
    buff_size: int = 65536

    def stream(self, name, robot_type, clock=time.monotonic, on_message=None, **options):
        """Return this :class:`Stream` of a robot; arguments as there.

        :raises MessageMissing: the package of its messages is not installed
        """
        topics, *kind = self.of(name, robot_type)
        return Stream([topic_of(name, topic) for topic in topics], *kind, clock=clock,
                      on_message=on_message, buff_size=self.buff_size, **options)


class RobotStreams:
    """The streams of one robot, by their rows.

    :param rows: a :class:`StreamRow` each; one whose messages are not installed is logged and
        stays silent
    :param on_message: {row: function}, see :class:`Stream`
    :param options: of ``rospy.Subscriber``
    """

    def __init__(self, name, robot_type, rows, clock=time.monotonic, on_message=None, **options):
        self._streams, self._problems = {}, {}
        self._switching = threading.Lock()
        for row in rows:
            try:
                self._streams[row] = row.stream(
                    name, robot_type, clock, (on_message or {}).get(row), **options)
            except MessageMissing as error:
                rospy.logwarn('%s: cannot read its %s: %s', name, row.key, error)
                self._streams[row] = Stream((), None, clock=clock)
                self._problems[row] = str(error)

    def __getitem__(self, row):
        """Return the :class:`Stream` of a row."""
        return self._streams[row]

    def problem(self, row):
        """Return why a row cannot be read, '' if it can."""
        return self._problems.get(row, '')

    def open(self, *rows):
        """Subscribe streams (blocking: it asks the master)."""
        with self._switching:
            for row in rows:
                self._streams[row].open()

    def close(self):
        """Unregister all of them (blocking: it asks the master)."""
        with self._switching:
            for stream in self._streams.values():
                stream.close()


def _odometry(_, kind):
    return (kind.odometry, *odometry_of(kind))


def _battery(_, kind):
    charge = Charge(kind.battery_unit)
    return kind.battery, BatteryState, lambda message, note: charge.read(message.percentage)


def _hardware_stop(_, kind):
    """Read whether a robot's own emergency stop holds it."""
    spec = kind.hardware_stop
    if spec is None:
        return (), None
    found = message_class(spec.kind)
    try:
        read_field(found(), spec.field)
    except AttributeError:
        raise MessageMissing('{} has no field {}'.format(spec.kind, spec.field)) from None
    return [spec.name], found, lambda message, note: read_field(message, spec.field) in spec.stopped


def _read_pose(message, note):
    """Return the :class:`Pose` in a ``geometry_msgs/PoseStamped``, NaN for impossible values."""
    place, turn = message.pose.position, message.pose.orientation
    (x, y), problem = sifted((PLACE,) * 2, (place.x, place.y))
    heading_rad = yaw_of(turn)
    if problem or math.isnan(heading_rad):
        note(problem or rotation_words(turn.x, turn.y, turn.z, turn.w))
    return Pose(x, y, heading_rad)


def _read_fetching(message, _):
    text = message.data[:80]
    return text if text.startswith(FETCHING_WORD) else ''


#: :class:`mhri.robots.ros.odometry.Reading`
ODOMETRY = StreamRow('odometry', _odometry)
#: charge in [0, 1], None if unknown
BATTERY_CHARGE = StreamRow('battery', _battery)
#: whether the robot's own emergency stop holds it; valid while a publisher is connected, since
#: many publish only once, latched
HARDWARE_STOP = StreamRow('hardware_stop', _hardware_stop)
#: :class:`Pose` by motion capture of the rigid body with the robot's name, NaN if impossible
MOCAP = StreamRow('mocap', lambda name, _: (
    ['/vrpn_client_node/{}/pose'.format(name)], PoseStamped, _read_pose))
#: ``mhri/LinkControl``: the host in control of a linked robot; silent for other robots
CONTROL = StreamRow('control', lambda name, _: (
    ['/{}/mhri_link/state'.format(name)], LinkControl))
#: the late commands that its guard dropped
DROPPED = StreamRow('dropped', lambda name, _: (
    ['/{}/mhri_guard/dropped'.format(name)], TwistStamped))
#: figures of a link to the robot's own master, and what it fetches from there; '': nothing
RADIO = StreamRow('radio', lambda name, _: (
    ['/{}/{}'.format(name, FIGURES)], String, lambda message, note: read_figures(message.data)))
FETCHED = StreamRow('fetched', lambda name, _: (
    ['/{}/{}'.format(name, FETCHING)], String, _read_fetching))
