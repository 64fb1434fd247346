# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The shipped simulated robot, which writes down what it is told and how its body moves.

``logged_sim.py LOG COMMAND...``: a line of ``LOG.told`` is a command, one of ``LOG.moved`` what the
body does, both: when [s, CLOCK_MONOTONIC], m/s, rad/s. A line of ``LOG.echo`` is when by the time
of day its guard said which command it has obeyed last, and that, <session>:<number>. ``COMMAND``
are its velocity topics. The robot's namespace is that of ``ROS_NAMESPACE``.
"""
import sys
import threading
import time

from geometry_msgs.msg import Twist, TwistStamped
from nav_msgs.msg import Odometry
import rospy

from mhri.nodes.sim_robot import main


def listen(path, topics):
    """Write down what comes, once the node is there."""
    told, moved, echo = (open('{}.{}'.format(path, what), 'a', buffering=1)
                         for what in ('told', 'moved', 'echo'))

    def note(twist, log):
        log.write('{!r} {!r} {!r}\n'.format(time.monotonic(), twist.linear.x, twist.angular.z))

    def note_echo(message):
        echo.write('{!r} {}\n'.format(message.header.stamp.to_sec(),
                                      message.header.frame_id.rpartition(':')[0]))

    while not rospy.core.is_initialized():
        time.sleep(0.02)
    for topic in topics:
        rospy.Subscriber(topic, Twist, note, told, queue_size=50, tcp_nodelay=True)
    rospy.Subscriber('odom', Odometry, lambda message: note(message.twist.twist, moved),
                     queue_size=50)
    rospy.Subscriber('mhri_guard/echo', TwistStamped, note_echo, queue_size=50, tcp_nodelay=True)


if __name__ == '__main__':
    words = rospy.myargv(sys.argv)[1:]
    threading.Thread(target=listen, args=(words[0], words[1:]), daemon=True).start()
    main()
