# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The trial of a robot's watchdog on ROS. It moves the robot, so it only runs on request."""
import threading
import time

from geometry_msgs.msg import Twist
import rospy
from std_msgs.msg import Bool

from mhri.base.names import topic_of
from mhri.doctor.watchdog import DONE, unknown, verdict, WatchdogTrial
from mhri.graph.ros.master_api import MasterApi, MasterError
from mhri.graph.ros.messages import MessageMissing
from mhri.graph.ros.resources import robot_types
from mhri.msg import RobotSelect
from mhri.recording.ros.raw_link import LinkError, RawLink
from mhri.robots.ros.convert import to_twist
from mhri.robots.ros.registry import RobotRegistry
from mhri.robots.ros.streams import ODOMETRY

PERIOD_S = 0.05
ZEROS = 10
CONNECT_S = 3.0


class _Refused(Exception):
    """The trial must not begin; its arguments are (reason, remedy)."""


def measure_watchdog(name):
    """Turn a robot slowly, stop publishing, check that it stops by itself; always end with zeros.

    For a robot on blocks, or a simulated one. Requires ``rospy.init_node``; blocks for at most
    10 s. Does nothing if the robot is selected in a panel or stop-all is in force.

    :returns: :class:`mhri.doctor.facts.Finding`
    """
    try:
        template = RobotRegistry(robot_types()[0]).look([name])[name]
        _check_idle(name)
        return _try(name, template)
    except _Refused as error:
        return unknown(name, *error.args)
    except (MasterError, MessageMissing) as error:
        return unknown(name, str(error), 'rosrun mhri mhri_doctor')


def _check_idle(name):
    """Check that the robot is not selected, and that driving is allowed.

    :raises _Refused: it is selected, or stop-all is in force
    """
    if _latched('/robot_controller/stop_all', Bool, lambda message: message.data):
        raise _Refused('stop all is in force, so nothing was tried', 'release it in the panel')
    if _latched('/robot_controller/robot_select', RobotSelect,
                lambda message: name in message.robots):
        raise _Refused('it is selected in a panel, so nothing was tried',
                       'untick it in the panel')


def _latched(topic, message_class, test):
    """Return whether the newest message of any publisher of a latched topic passes a test.

    :raises _Refused: a publisher does not respond
    """
    uris = MasterApi(rospy.get_name(), timeout_s=2.0).publisher_uris(topic)
    return any([test(_first(topic, uri, message_class)) for uri in uris])


def _first(topic, uri, message_class):
    """Return a publisher's latched message.

    :raises _Refused: there is no message in time
    """
    remedy = 'rosrun mhri mhri_doctor   # fix what it reports first'
    try:
        link = RawLink(topic, uri, rospy.get_name(), timeout_s=1.5)
    except LinkError as error:
        raise _Refused('cannot determine whether it is being driven: {}'.format(error), remedy)
    try:
        deadline = time.monotonic() + 1.5
        while time.monotonic() < deadline:
            frames = link.wait(deadline - time.monotonic())
            if frames:
                return message_class().deserialize(frames[-1][4:])
    except LinkError as error:
        raise _Refused('cannot determine whether it is being driven: {}'.format(error), remedy)
    finally:
        link.close()
    if message_class is RobotSelect:
        return RobotSelect()  # before its first selection a panel has no latched message
    raise _Refused('cannot determine whether stop all is in force', remedy)


def _try(name, template):
    """Run the trial."""
    odometry = ODOMETRY.stream(name, template, queue_size=1)
    odometry.open()
    publishers = [rospy.Publisher(topic_of(name, topic), Twist, queue_size=1, tcp_nodelay=True)
                  for topic in template.command]
    tick = threading.Event()
    try:
        chosen = _connected(publishers, tick)
        if chosen is None:
            raise _Refused('nothing subscribes to its velocity, so nothing was tried',
                           'rosrun mhri mhri_doctor {}'.format(name))
        try:
            return _run(name, chosen, odometry, tick, min(0.3, template.limits.angular_rad_s))
        finally:
            for _ in range(ZEROS):
                chosen.publish(to_twist(0.0, 0.0))
                tick.wait(PERIOD_S)
    finally:
        for publisher in publishers:
            publisher.unregister()
        odometry.close()


def _connected(publishers, tick):
    """Return the first publisher with a subscriber, chosen as by the mux; None without one."""
    deadline = time.monotonic() + CONNECT_S
    while time.monotonic() < deadline:
        chosen = next((item for item in publishers if item.get_num_connections()), None)
        if chosen is not None:
            tick.wait(4 * PERIOD_S)  # one of higher priority may be connecting
            return next((item for item in publishers if item.get_num_connections()), None)
        tick.wait(PERIOD_S)
    return None


def _run(name, publisher, odometry, tick, turn_rad_s):
    """Run the trial to its outcome; return the finding."""
    trial = WatchdogTrial(time.monotonic(), turn_rad_s)
    while trial.phase != DONE and not rospy.is_shutdown():
        newest = odometry.newest()
        turn = trial.step(time.monotonic(), newest and newest.value.motion,
                          newest.at_s if newest else 0.0)
        if turn is not None:
            publisher.publish(to_twist(0.0, turn))
        tick.wait(PERIOD_S)
    if trial.outcome is None:
        raise _Refused('the trial was interrupted', 'start it again')
    return verdict(name, trial.outcome, trial.stopped_s)
