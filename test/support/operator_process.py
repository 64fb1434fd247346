#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""An operator in a process of its own, to be killed: it repeats the selection it was last told."""
import sys
import threading

import rospy

from mhri.msg import RobotSelect


def main():
    """Repeat at 2 Hz what each line of the standard input says: names with spaces between."""
    rospy.init_node('operator_process', anonymous=True, disable_signals=True)
    publisher = rospy.Publisher('/robot_controller/robot_select', RobotSelect, queue_size=1,
                                latch=True)
    chosen, changed = [None], threading.Event()

    def read():
        """Take the lines."""
        for line in sys.stdin:
            chosen[0] = line.split()
            changed.set()

    threading.Thread(target=read, daemon=True).start()
    while not rospy.is_shutdown():
        changed.wait(0.5)
        changed.clear()
        if chosen[0] is not None:
            publisher.publish(robots=chosen[0])


if __name__ == '__main__':
    main()
