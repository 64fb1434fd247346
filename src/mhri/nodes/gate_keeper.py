# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The executable ``gate_keeper``, started by the panel: see :mod:`mhri.ros.keeper`."""
import signal
import sys

from geometry_msgs.msg import Twist
import rospy

from mhri.ros.keeper import Keeper
from mhri.ros.master_watch import log_without_master


def main():
    """Run until the panel is gone; the signals that end a panel's group must not end this first."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    rospy.init_node('mhri_gate_keeper', anonymous=True, disable_signals=True, disable_rostime=True)
    log_without_master()
    keeper = Keeper(sys.stdin, lambda topic: rospy.Publisher(
        topic, Twist, queue_size=1, tcp_nodelay=True))
    for topic in keeper.run():
        rospy.logwarn('the panel was killed while driving: zero sent to %s', topic)
    rospy.signal_shutdown('the panel has ended')
