# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The executable ``gates``: runs :class:`mhri.driving.ros.gates.Gates` as ``/mhri_gates``.

``gates --stand-by`` does so in a process that another one, already loaded, replaces if it is
killed (:mod:`mhri.graph.ros.stand_by`).
"""
import gc
import struct
import sys

import rospy

from mhri.base.config import ConfigError
from mhri.driving.ros.gates import Gates, KEPT
from mhri.driving.ros.gates_state import GatesSpeaker
from mhri.driving.settings import Settings
from mhri.driving.sources import parse_mux_config
from mhri.graph.ros import log
from mhri.graph.ros.ending import init_node
from mhri.graph.ros.master_watch import MasterWatch
from mhri.graph.ros.peers import limit_peers
from mhri.graph.ros.resources import profile_reader, read_text, resource_path, robot_types
from mhri.graph.ros.rospy_inside import ended_by_hand
from mhri.graph.ros.stand_by import Memory, stand_by


def first_settings():
    """Return the :class:`Settings` until an operator sets others: the limits of ``mux.yaml``.

    Where the mux's own file (``/mux/config``) cannot be used, those of the file that mhri brings.
    """
    usual = resource_path('mux.yaml')
    path = rospy.get_param('/mux/config', usual)
    for path in (path if isinstance(path, str) and path else usual, usual):
        try:
            config = parse_mux_config(read_text(path), path, profile_reader(path))
            break
        except (ConfigError, OSError) as error:
            rospy.logwarn('the speed limits of %s cannot be read: %s', path, error)
    else:
        sys.exit('the gates cannot start: no speed limits')
    # As the message carries them.
    return Settings(*struct.unpack('<2f', struct.pack(
        '<2f', config.linear_mps, config.angular_rad_s)))


def main():
    """Run until shut down; the last command to every robot is a zero.

    After ``rosnode kill`` the exit status is 1, so that ``mhri.launch`` restarts it.
    """
    types, errors = robot_types()
    memory = Memory()
    beat = stand_by('the gates', beats=True)
    limit_peers()
    init_node('mhri_gates', disable_rostime=True)
    rospy.on_shutdown(beat.end)
    log.install()
    by_hand = ended_by_hand()
    # The next process must not lose time over a file: robots wait for its zero.
    settings = first_settings() if memory.recall(KEPT) is None else None
    gates = Gates(types, memory, settings)
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
