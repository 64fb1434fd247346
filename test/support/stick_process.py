# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A stick as a process: publishes Joy at 50 Hz with the axes last read from its standard input."""
import sys
import threading

import rospy
from sensor_msgs.msg import Joy


def main():
    """Run until shut down or killed."""
    rospy.init_node('stick_process')
    publisher = rospy.Publisher(sys.argv[1], Joy, queue_size=1, tcp_nodelay=True)
    held = []

    def read():
        for line in sys.stdin:
            held[:] = [tuple(float(word) for word in line.split())]

    threading.Thread(target=read, daemon=True).start()
    rate = rospy.Rate(50.0)
    while not rospy.is_shutdown():
        if held:
            publisher.publish(Joy(axes=held[0]))
        rate.sleep()


if __name__ == '__main__':
    main()
