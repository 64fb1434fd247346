#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A real node with an ailment, for the tests of the doctor: a process of its own."""
import argparse
import os
import sys
import time

from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
import roslib.message
import rospy
from sensor_msgs.msg import LaserScan

from mhri.msg import ControlMode, DriveState, RobotSelect

TICK_S = 0.05


class Changed(Odometry):
    """An Odometry of another release: the same name, another definition."""

    _md5sum = '0123456789abcdef0123456789abcdef'


class Mover:
    """A body that turns as it was last told: for ever, unless it has a watchdog.

    :param watchdog_s: stops by itself when nothing came for so long [s]; 0 is never
    """

    def __init__(self, topic, watchdog_s):
        self._watchdog_s = watchdog_s
        self._turn, self._at = 0.0, 0.0
        rospy.Subscriber(topic, Twist, self._on_twist, queue_size=1)

    def _on_twist(self, message):
        self._turn, self._at = message.angular.z, time.monotonic()
        print('told', self._turn, flush=True)

    def turn(self):
        if self._watchdog_s and time.monotonic() - self._at > self._watchdog_s:
            return 0.0
        return self._turn


class Mux:
    """Says a state at 2 Hz, as the mux does."""

    def __init__(self):
        self._mode = rospy.Publisher('/mux/mode', ControlMode, queue_size=1, latch=True)
        self._publisher = rospy.Publisher('/mux/state', DriveState, queue_size=1, latch=True)
        self._say()
        self._timer = rospy.Timer(rospy.Duration(0.5), self._say)

    def _say(self, _=None):
        state = DriveState()
        state.header.stamp = rospy.Time.now()
        self._publisher.publish(state)


def parse(arguments):
    parser = argparse.ArgumentParser()
    parser.add_argument('--publish', nargs=2, action='append', default=[], help='topic type')
    parser.add_argument('--subscribe', nargs=2, action='append', default=[], help='topic type')
    parser.add_argument('--odometry', help='topic, sent at 20 Hz')
    parser.add_argument('--offset', type=float, default=0.0, help='of its clock [s]')
    parser.add_argument('--frames', nargs=2, default=['', ''], help='of its odometry')
    parser.add_argument('--scan', type=float, help='each beam of its laser says this [m]')
    parser.add_argument('--respawn', action='store_true', help='start again, as often as it ends')
    parser.add_argument('--changed', action='store_true', help='odometry of another definition')
    parser.add_argument('--obey', help='topic of the velocity that its odometry follows')
    parser.add_argument('--select', help='select this robot again and again, as a panel does')
    parser.add_argument('--mux', action='store_true', help='say what the mux says')
    parser.add_argument('--watchdog', type=float, default=0.0)
    return parser.parse_args(arguments)


def respawn():
    """Return in a new process whenever the one before has ended, which takes no time."""
    while os.fork():
        os.wait()
    rospy.on_shutdown(lambda: os._exit(0))


def main():
    options = parse(rospy.myargv()[1:])
    if options.respawn:
        respawn()
    rospy.init_node('patient')
    for topic, kind in options.publish:
        rospy.Publisher(topic, roslib.message.get_message_class(kind), queue_size=1)
    for topic, kind in options.subscribe:
        rospy.Subscriber(topic, roslib.message.get_message_class(kind), lambda message: None)
    mover = Mover(options.obey, options.watchdog) if options.obey else None
    if options.mux:
        Mux()
    if options.select:
        panel = rospy.Publisher('/robot_controller/robot_select', RobotSelect, queue_size=1,
                                latch=True)
        wish = RobotSelect(robots=[options.select])
        panel.publish(wish)
        rospy.Timer(rospy.Duration(0.5), lambda _: panel.publish(wish))
    kind = Changed if options.changed else Odometry
    publisher = options.odometry and rospy.Publisher(options.odometry, kind, queue_size=1)
    laser = rospy.Publisher('scan', LaserScan, queue_size=1) if options.scan is not None else None
    print('ready', flush=True)
    if not publisher:
        rospy.spin()
        sys.exit()
    while not rospy.is_shutdown():
        message = kind(child_frame_id=options.frames[1])
        message.header.frame_id = options.frames[0]
        message.header.stamp = rospy.Time.from_sec(time.time() + options.offset)
        message.twist.twist.angular.z = mover.turn() if mover else 0.0
        publisher.publish(message)
        if laser is not None:
            laser.publish(range_min=0.12, range_max=3.5, angle_increment=0.1,
                          ranges=[options.scan] * 60)
        time.sleep(TICK_S)


if __name__ == '__main__':
    main()
