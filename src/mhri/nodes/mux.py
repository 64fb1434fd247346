# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The executable ``mux``: reads its parameters and runs :class:`mhri.driving.ros.mux.Mux`.

A standby process, already loaded, supervises it (:mod:`mhri.graph.ros.stand_by`): if the drive is
killed, crashes or hangs, that process sends a zero to every robot at once, and starts the next
drive.
"""
from dataclasses import replace
import gc
import os
import sys

import rosgraph
import rospy

from mhri.base.config import ConfigError
from mhri.driving.drive import LOST
from mhri.driving.io.stop_file import StopFile
from mhri.driving.ros.journal_writer import JournalWriter
from mhri.driving.ros.mux import Mux
from mhri.driving.ros.mux_file import read_mux_config, shipped_path
from mhri.driving.ros.mux_takeover import end_other_muxes, has_address_of_last, KEPT
from mhri.driving.sources import enabling_problem
from mhri.graph.ros import parameters
from mhri.graph.ros.master_api import MasterApi, MasterError
from mhri.graph.ros.resources import robot_types
from mhri.graph.ros.shutdown import start_node
from mhri.graph.ros.stand_by import DRIVE_HUNG_S, Memory, stand_by
from mhri.recording.recording import ros_home


def config_path(argv):
    """Return ``~config`` of a node that does not exist yet, or ''.

    It may still be in the namespace that a launch file or ``ROS_NAMESPACE`` gave the node, see
    :func:`mhri.graph.ros.shutdown.init_node`.

    The file is read before the node takes its name: an error in it must not end the running mux.

    :raises MasterError: the master does not answer
    """
    own = [word.split(':=', 1)[1] for word in argv if word.startswith('_config:=')]
    if own:
        return own[-1]
    name = rosgraph.names.load_mappings(argv).get('__name', 'mux') + '/config'
    found = MasterApi('/mux', timeout_s=5.0).call_many([
        ('getParam', namespace + name)
        for namespace in (rosgraph.names.get_ros_namespace(argv=argv), '/')])
    return found[0] or found[1] or ''


def adjusted(config):
    """Return the configuration with the node's parameters replacing the file's values.

    :raises ConfigError: a parameter cannot be used
    """
    enabling = parameters.text('~enabling', config.enabling or '')
    problem = enabling_problem(config.sources, enabling)
    if problem:
        raise ConfigError(rospy.resolve_name('~enabling'), '', problem)
    config = replace(config, enabling=enabling or None, automatic_switching=parameters.flag(
        '~automatic_switching', config.automatic_switching))
    return config if parameters.flag('~dead_man', config.dead_man) else config.without_dead_man()


def main():
    """Run until shut down; the last command to every robot is a zero.

    Exit with 1 if the sources' file cannot be used, and after ``rosnode kill``, so that it is
    restarted: robots must not be left without a drive.
    """
    # Robots that were stopped alone stay stopped even if they are no longer in the list.
    memory = Memory(fallback={KEPT: LOST})
    undertaker = stand_by('the mux', DRIVE_HUNG_S, memory, always=True)
    try:
        config = read_mux_config(config_path(sys.argv) or shipped_path())
    except (ConfigError, OSError, MasterError) as error:
        sys.exit('the mux cannot start: {}'.format(error))
    by_hand = start_node('mux', disable_rostime=True)
    try:
        config, journal_path = adjusted(config), parameters.text('~journal', '')
    except ConfigError as error:
        sys.exit('the mux cannot start: {}'.format(error))
    types, errors = robot_types()
    stop_file = StopFile(os.path.join(ros_home(os.environ), 'mhri', 'stop'),
                         rosgraph.get_master_uri())
    # After the configuration: what recalls the memory and fails, again and again, discards it.
    if has_address_of_last(memory):
        sys.exit('the mux has the address of the last one; it is started once more')
    end_other_muxes()
    journal = JournalWriter(journal_path) if journal_path else None
    Mux(config, types, memory, stop_file, undertaker, journal).start()
    for error in errors:
        rospy.logwarn('robot type left out: %s', error)
    # The objects loaded by now are permanent: collecting garbage among them would delay a command.
    gc.freeze()
    rospy.spin()
    if by_hand():
        sys.exit('the mux was ended by rosnode kill')
