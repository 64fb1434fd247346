# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The executable ``gate_keeper``, started by the panel: see :mod:`mhri.ros.driving.keeper`."""
import gc
import os
import signal
import sys

import rospy

from mhri.ros.driving.gates import GateBank
from mhri.ros.driving.keeper import Keeper, Words
from mhri.ros.graph.master_watch import MasterWatch


def main():
    """Run until the panel is gone; the signals that end a panel's group must not end this first.

    The last word on the command line is the file descriptor to answer by.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    if not sys.argv[1:] or not sys.argv[-1].isdigit():
        sys.exit('gate_keeper: the panel starts this; it is of no use by itself')
    words = Words(sys.stdin, lambda: os._exit(0))
    rospy.init_node('mhri_gate_keeper', anonymous=True, disable_signals=True, disable_rostime=True)
    MasterWatch().start()
    bank = GateBank()
    bank.start(hear_selection=False)
    # What has been loaded by now stays: looking through it would hold up a command.
    gc.freeze()
    for name in Keeper(words, int(sys.argv[-1]), bank).run():
        rospy.logwarn('the panel was killed while driving: zero sent to %s', name)
    rospy.signal_shutdown('the panel has ended')
