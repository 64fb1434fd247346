# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The executable ``gates``: runs :class:`mhri.ros.driving.gates.Gates` as ``/mhri_gates``.

``gates --stand-by`` does so in a process that another one, all loaded, takes the place of when it
is killed (:mod:`mhri.ros.stand_by`).
"""
import gc
import signal
import sys

import rospy

from mhri.ros.driving.gates import Gates
from mhri.ros.driving.gates_state import GatesSpeaker
from mhri.ros.graph import log
from mhri.ros.graph.handshake import limit_handshakes
from mhri.ros.graph.master_watch import MasterWatch
from mhri.ros.graph.rospy_inside import ended_by_hand
from mhri.ros.resources import robot_types
from mhri.ros.stand_by import stand_by


def main():
    """Run until shut down; the last word to every robot is a zero.

    Ended by ``rosnode kill`` the exit status is 1, so that ``mhri.launch`` starts it again.
    """
    types, errors = robot_types()
    if '--stand-by' in sys.argv:
        stand_by('the gates')
    limit_handshakes()
    rospy.init_node('mhri_gates', disable_rostime=True)
    log.install()
    by_hand = ended_by_hand()
    # A terminal that is closed must not end the gates without a zero.
    signal.signal(signal.SIGHUP, lambda *_: rospy.signal_shutdown('the terminal was closed'))
    gates = Gates(types)
    speaker = GatesSpeaker(gates.read, gates.mux_heard)
    gates.on_change = speaker.on_change
    rospy.on_shutdown(gates.close)
    MasterWatch(period_s=0.25, patience_s=1.1).start()
    gates.start()
    speaker.start()
    for error in errors:
        rospy.logwarn('robot type left out: %s', error)
    # What has been loaded by now stays: looking through it would hold up a command.
    gc.freeze()
    rospy.spin()
    if by_hand():
        # An error to who launched it: robots must not be left without gates.
        sys.exit('the gates were ended by rosnode kill')
