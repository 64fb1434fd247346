#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The programs around the mux in the test of random events: each a process, to be killed.

``soak_process.py robot LOG``         obeys ``cmd_vel`` for ever, and logs what it obeys
``soak_process.py guard FILE``        runs the guard of that file
``soak_process.py operator NAME``     selection, virtual joystick and take-over, as it is told
``soak_process.py pad``               ``/mux_in/ps3joy``, as it is told

Robot and guard are in the namespace of ``ROS_NAMESPACE``. Operator and pad are told by lines on
their standard input. All register again at a new master, as
``turtle_remote.sh`` has a robot do.
"""
import os
import runpy
import sys
import threading
import time

import rospy

from geometry_msgs.msg import Twist
from mhri.graph.ros.master_watch import MasterWatch
from mhri.msg import RobotSelect
from nav_msgs.msg import Odometry
from sensor_msgs.msg import Joy
from std_srvs.srv import Trigger

PERIOD_S = 0.05
# What a stick that is out asks for, as fractions; on the pad forward is -1.
OUT = (0.4, 0.5)
DEAD_MAN, BUTTONS = 4, 17


def robot(log):
    """Have no watchdog: the last command holds. Each is logged: time [s, monotonic], m/s, rad/s."""
    rows = os.open(log, os.O_WRONLY | os.O_CREAT | os.O_APPEND)
    obeyed = [0.0, 0.0]

    def note():
        os.write(rows, '{:.4f} {:.3f} {:.3f}\n'.format(time.monotonic(), *obeyed).encode())

    def obey(message):
        obeyed[:] = message.linear.x, message.angular.z
        note()

    rospy.init_node('base', disable_signals=True)
    MasterWatch().start()
    note()
    publisher = rospy.Publisher('odom', Odometry, queue_size=1, tcp_nodelay=True)
    rospy.Subscriber('cmd_vel', Twist, obey, queue_size=None, tcp_nodelay=True)
    message = Odometry()
    while not rospy.is_shutdown():
        message.header.stamp = rospy.Time.now()
        message.twist.twist.linear.x, message.twist.twist.angular.z = obeyed
        publisher.publish(message)
        time.sleep(PERIOD_S)


def guard(path):
    """Run the real guard; the watch is what turtle_remote.sh does about a new master."""
    def watch():
        while not rospy.core.is_initialized():
            time.sleep(0.02)
        MasterWatch().start()
    threading.Thread(target=watch, daemon=True).start()
    sys.argv = [path]
    runpy.run_path(path, run_name='__main__')


def told(take):
    """Call a function with the words of each line of the standard input, on a thread."""
    def read():
        for line in sys.stdin:
            take(*line.split())
    threading.Thread(target=read, daemon=True).start()


def operator(name):
    """Repeat the selection at 2 Hz and the virtual joystick at 20 Hz."""
    rospy.init_node(name, disable_signals=True)
    MasterWatch().start()
    select = rospy.Publisher('/robot_controller/robot_select', RobotSelect, queue_size=1,
                             latch=True, tcp_nodelay=True)
    joy = rospy.Publisher('/mux_in/joy', Joy, queue_size=1, tcp_nodelay=True)
    state = {'chosen': [], 'out': False}

    def take(word, *rest):
        if word == 'select':
            state['chosen'] = list(rest)
            select.publish(robots=state['chosen'])
        elif word == 'stick':
            state['out'] = rest[0] == 'out'
            joy.publish(axes=[OUT[1], OUT[0]] if state['out'] else [0.0, 0.0])
        else:
            try:
                rospy.ServiceProxy('/mux/take_control', Trigger)()
            except rospy.ServiceException:
                return
            select.publish(robots=state['chosen'])
            print('taken', flush=True)

    select.publish(robots=[])
    print('ready', flush=True)
    told(take)
    count = 0
    while not rospy.is_shutdown():
        count += 1
        joy.publish(axes=[OUT[1], OUT[0]] if state['out'] else [0.0, 0.0])
        if count % 10 == 0:
            select.publish(robots=state['chosen'])
        time.sleep(PERIOD_S)


def pad():
    """Say at 20 Hz and on change what it is told: ``out`` or ``centred``, and the button."""
    rospy.init_node('pad', disable_signals=True)
    MasterWatch().start()
    publisher = rospy.Publisher('/mux_in/ps3joy', Joy, queue_size=1, tcp_nodelay=True)
    state = ['centred', '1']

    def say():
        buttons = [0] * BUTTONS
        buttons[DEAD_MAN] = int(state[1])
        axes = [-OUT[1], -OUT[0]] if state[0] == 'out' else [0.0, 0.0]
        publisher.publish(axes=axes, buttons=buttons)

    def take(*words):
        state[:] = words
        say()

    print('ready', flush=True)
    told(take)
    while not rospy.is_shutdown():
        say()
        time.sleep(PERIOD_S)


if __name__ == '__main__':
    {'robot': robot, 'guard': guard, 'operator': operator, 'pad': pad}[sys.argv[1]](*sys.argv[2:])
