#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""One TCP connection of the driving path breaks in the middle of a drive; both its ends live on."""
import os
import socket
import sys
import time

from nav_msgs.msg import Odometry
import rospy
import rostest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.realpath(__file__)), '..'))

from gates_case import GatesCase, ZERO  # noqa: E402
from rostest_tools import measured  # noqa: E402
from support.ros_system import wait_for  # noqa: E402


def break_link(topic, other=''):
    """Break the connection of a publisher or subscriber of this process; return when.

    :param other: the node at the other end of a publisher's
    """
    link, = [link for link in topic.impl.connections if other in ('', link.endpoint_id)]
    when = time.monotonic()
    link.socket.shutdown(socket.SHUT_RDWR)
    return when


class GatesLinksTest(GatesCase):
    """Between the mux, the operator and a robot on the one hand, the gates on the other."""

    def hold_out(self, condition, what):
        """Hold the stick out until something is so."""
        wait_for(lambda: self.mux.say(0.2) and condition(), 30.0, what, poll_s=0.02)

    def waits(self, name, receiver, when):
        """Show that the robot has had nothing but zeros, and drives once the stick is centred."""
        self.hold_out(lambda: self.state.robot(name).stands == 'joining', 'that it waits')
        self.stays_at_rest(receiver, when)
        self.centre(name, receiver)
        self.assertEqual(self.drive(receiver, 0.1), (0.1, 0.0), 'the stick was centred')

    def test_from_the_mux(self):
        (name, receiver), = self.robots(1)
        self.drive(receiver, 0.2)
        when = break_link(self.mux.twist, '/mhri_gates')
        self.first_zero('connection from the mux broken', receiver, when, 0.05)
        self.hold_out(lambda: self.mux.twist.get_num_connections(), 'the gates to listen again')
        self.waits(name, receiver, when)

    def test_from_the_mux_with_its_word_to_stop(self):
        (name, receiver), = self.robots(1)
        self.drive(receiver, 0.2)
        break_link(self.mux.stop_all, '/mhri_gates')
        when = self.mux.stop(True)
        self.hold_out(lambda: self.state.message.stop_all, 'the stop')
        taken = time.monotonic()
        measured('stop-all, its connection broken', taken - when)
        self.stays_at_rest(receiver, taken)
        self.mux.stop(False)
        self.waits(name, receiver, taken)

    def test_from_the_operator(self):
        (name, receiver), = self.robots(1)
        self.drive(receiver, 0.2)
        when = break_link(self.operator.select, '/mhri_gates')
        self.first_zero('connection from the operator broken', receiver, when, 0.05)
        self.hold_out(lambda: self.state.robot(name).obeys == 'operator', 'the selection')
        self.waits(name, receiver, when)

    def test_to_a_robot(self):
        """It listens again as soon as it is told that the gates are there."""
        (name, receiver), = self.robots(1)
        odometry = rospy.Publisher('/{}/odom'.format(name), Odometry, queue_size=1)
        self.addCleanup(odometry.unregister)
        # One that is first heard under way waits, too: not what is meant here.
        wait_for(odometry.get_num_connections, what='the gates to hear the robot')
        beats = rospy.Timer(rospy.Duration(0.1), lambda event: odometry.publish(Odometry()))
        self.addCleanup(beats.shutdown)
        rospy.rostime.wallsleep(0.3)
        self.centre(name, receiver)
        self.drive(receiver, 0.2)
        when = break_link(receiver.subscriber)
        wait_for(lambda: not receiver.connected(), what='the end of the connection')
        self.hold_out(receiver.connected, 'the robot to listen again')
        self.hold_out(lambda: receiver.after(when), 'the first word')
        self.assertEqual(receiver.after(when)[0][1:], ZERO)
        self.waits(name, receiver, when)


if __name__ == '__main__':
    rospy.init_node('gates_links_test')
    rostest.rosrun('mhri', 'gates_links', GatesLinksTest)
