# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The executable ``gates``: runs :class:`mhri.ros.driving.gates.Gates` as ``/mhri_gates``.

``gates --stand-by`` does so in a process that another one, already loaded, replaces if it is
killed (:mod:`mhri.ros.stand_by`).
"""
import gc
import sys

import rospy

from mhri.ros.driving.gates import Gates
from mhri.ros.driving.gates_state import GatesSpeaker
from mhri.ros.ending import init_node
from mhri.ros.graph import log
from mhri.ros.graph.handshake import limit_handshakes
from mhri.ros.graph.master_watch import MasterWatch
from mhri.ros.graph.rospy_inside import ended_by_hand
from mhri.ros.resources import robot_types
from mhri.ros.stand_by import Memory, stand_by


def main():
    """Run until shut down; the last command to every robot is a zero.

    After ``rosnode kill`` the exit status is 1, so that ``mhri.launch`` restarts it.
    """
    types, errors = robot_types()
    memory = Memory()
    beat = stand_by('the gates', beats=True)
    limit_handshakes()
    init_node('mhri_gates', disable_rostime=True)
    rospy.on_shutdown(beat.end)
    log.install()
    by_hand = ended_by_hand()
    gates = Gates(types, memory)
    speaker = GatesSpeaker(gates.read, gates.mux_heard, beat)
    gates.on_change = speaker.on_change
    rospy.on_shutdown(gates.close)
    MasterWatch(period_s=0.25, patience_s=1.1).start()
    gates.start()
    speaker.start()
    for error in errors:
        rospy.logwarn('robot type left out: %s', error)
    # What is loaded by now stays: searching it would delay a command.
    gc.freeze()
    rospy.spin()
    if by_hand():
        # An error for the launcher: robots must not be left without gates.
        sys.exit('the gates were ended by rosnode kill')
