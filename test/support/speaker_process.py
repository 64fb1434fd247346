# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A program that publishes Joy or Twist as it is told on its standard input.

A line is: the rate [Hz], 0 for once; the number of buttons; the buttons; the values.
"""
import sys
import threading

from geometry_msgs.msg import Twist
import rospy
from sensor_msgs.msg import Joy


def message_of(kind, buttons, values):
    """Return the message."""
    if kind == 'joy':
        return Joy(axes=values, buttons=buttons)
    message = Twist()
    message.linear.x, message.angular.z = values
    return message


def main():
    """Run until shut down or killed."""
    rospy.init_node('speaker')
    kind, topic = sys.argv[1:3]
    publisher = rospy.Publisher(topic, {'joy': Joy, 'twist': Twist}[kind], queue_size=1)
    changed, said = threading.Condition(), []

    def read():
        for line in sys.stdin:
            words = [float(word) for word in line.split()]
            count = int(words[1])
            message = message_of(kind, [int(word) for word in words[2:2 + count]],
                                 words[2 + count:])
            with changed:
                said[:] = [words[0], message]
                publisher.publish(message)
                changed.notify()

    threading.Thread(target=read, daemon=True).start()
    with changed:
        while not rospy.is_shutdown():
            if said and said[0] and not changed.wait(1.0 / said[0]):
                publisher.publish(said[1])
            elif not (said and said[0]):
                changed.wait(0.1)


if __name__ == '__main__':
    main()
