# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The trial of a robot's watchdog, on ROS. It moves the robot: only on request, see the caller."""
import select
import threading
import time

from geometry_msgs.msg import Twist
import rospy
from std_msgs.msg import Bool

from mhri.base.names import topic_of
from mhri.base.robot_types import resolve_robot_type, Seen
from mhri.doctor.watchdog import DONE, unknown, verdict, WatchdogTrial
from mhri.graph.ros.master_api import MasterApi, MasterError
from mhri.graph.ros.messages import MessageMissing
from mhri.graph.ros.resources import robot_types
from mhri.graph.ros.rospy_inside import unsubscribe
from mhri.msg import RobotSelect
from mhri.recording.ros.raw_link import LinkError, RawLink
from mhri.robots.ros.convert import to_twist
from mhri.robots.ros.look import robot_facts
from mhri.robots.ros.odometry import odometry_of

PERIOD_S = 0.05
ZEROS = 10
CONNECT_S = 3.0


class _Refused(Exception):
    """The trial must not begin; (words, remedy)."""


class _Ear:
    """Keeps the newest motion of a robot and when it came."""

    def __init__(self, name, template):
        message_class, self._read = odometry_of(template)
        self._newest = (None, 0.0)
        self._subscribers = [
            rospy.Subscriber(topic_of(name, topic), message_class, self._on_message,
                             queue_size=1, tcp_nodelay=True) for topic in template.odometry]

    def _on_message(self, message):
        self._newest = (self._read(message), time.monotonic())

    def newest(self):
        """Return (motion or None, when [s])."""
        return self._newest

    def close(self):
        """Stop listening."""
        for subscriber in self._subscribers:
            unsubscribe(subscriber)


def measure_watchdog(name):
    """Turn a robot slowly, fall silent, see whether it stops by itself; always end with zeros.

    For a robot on blocks, or a simulated one. Needs ``rospy.init_node``; blocks for at most 10 s.
    Does nothing if the robot is selected in a panel or stop-all is in force.

    :returns: :class:`mhri.doctor.facts.Finding`
    """
    try:
        types = robot_types()[0]
        facts = robot_facts(rospy.get_name(), [name], types)[name]
        template, _ = resolve_robot_type(types, name, facts.parameters, facts.seen or Seen())
        _check_idle(name)
        return _try(name, template)
    except _Refused as error:
        return unknown(name, *error.args)
    except (MasterError, MessageMissing) as error:
        return unknown(name, str(error), 'rosrun mhri mhri_doctor')


def _check_idle(name):
    """Make sure that nobody drives the robot, and that driving is allowed.

    :raises _Refused: with the reason
    """
    if _latched('/robot_controller/stop_all', Bool, lambda message: message.data):
        raise _Refused('stop all is in force, so nothing was tried', 'release it in the panel')
    if _latched('/robot_controller/robot_select', RobotSelect,
                lambda message: name in message.robots):
        raise _Refused('it is selected in a panel, so nothing was tried',
                       'untick it in the panel')


def _latched(topic, message_class, test):
    """Tell whether the newest message of any publisher of a latched topic passes a test.

    :raises _Refused: there is a publisher that does not answer
    """
    api = MasterApi(rospy.get_name(), timeout_s=2.0)
    publishers = dict(api.call('getSystemState')[0]).get(topic, ())
    uris = api.call_many([('lookupNode', node) for node in publishers]) if publishers else []
    return any([test(_first(topic, uri, message_class)) for uri in uris if uri])


def _first(topic, uri, message_class):
    """Return a publisher's latched message.

    :raises _Refused: it gives none
    """
    remedy = 'rosrun mhri mhri_doctor   # mend what it says first'
    try:
        link = RawLink(topic, uri, rospy.get_name(), timeout_s=1.5)
    except LinkError as error:
        raise _Refused('nobody can tell whether it is being driven: {}'.format(error), remedy)
    try:
        deadline = time.monotonic() + 1.5
        while time.monotonic() < deadline:
            frames = link.read()
            if frames:
                return message_class().deserialize(frames[-1][4:])
            select.select([link], [], [], max(0.0, deadline - time.monotonic()))
    except LinkError as error:
        raise _Refused('nobody can tell whether it is being driven: {}'.format(error), remedy)
    finally:
        link.close()
    if message_class is RobotSelect:
        return RobotSelect()  # a panel latches nothing before its first selection
    raise _Refused('nobody can tell whether stop all is in force', remedy)


def _try(name, template):
    """Run the trial."""
    ear = _Ear(name, template)
    publishers = [rospy.Publisher(topic_of(name, topic), Twist, queue_size=1, tcp_nodelay=True)
                  for topic in template.command]
    tick = threading.Event()
    try:
        chosen = _connected(publishers, tick)
        if chosen is None:
            raise _Refused('nobody listens to its velocity, so nothing was tried',
                           'rosrun mhri mhri_doctor {}'.format(name))
        try:
            return _run(name, chosen, ear, tick, min(0.3, template.limits.angular_rad_s))
        finally:
            for _ in range(ZEROS):
                chosen.publish(to_twist(0.0, 0.0))
                tick.wait(PERIOD_S)
    finally:
        for publisher in publishers:
            publisher.unregister()
        ear.close()


def _connected(publishers, tick):
    """Return the first publisher with a subscriber, as the gate chooses; None if there is none."""
    deadline = time.monotonic() + CONNECT_S
    while time.monotonic() < deadline:
        chosen = next((item for item in publishers if item.get_num_connections()), None)
        if chosen is not None:
            tick.wait(4 * PERIOD_S)  # a better one may be connecting
            return next(item for item in publishers if item.get_num_connections())
        tick.wait(PERIOD_S)
    return None


def _run(name, publisher, ear, tick, turn_rad_s):
    """Step the trial until it has an outcome; return the finding."""
    trial = WatchdogTrial(time.monotonic(), turn_rad_s)
    while trial.phase != DONE and not rospy.is_shutdown():
        motion, heard_at = ear.newest()
        turn = trial.step(time.monotonic(), motion, heard_at)
        if turn is not None:
            publisher.publish(to_twist(0.0, turn))
        tick.wait(PERIOD_S)
    if trial.outcome is None:
        raise _Refused('the trial was interrupted', 'start it again')
    return verdict(name, trial.outcome, trial.stopped_s)
