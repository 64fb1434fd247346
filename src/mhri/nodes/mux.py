# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The executable ``mux``: reads its parameters and runs :class:`mhri.driving.ros.mux.Mux`.

``mux --stand-by`` does so in a process that another one, already loaded, replaces if it is
killed (:mod:`mhri.graph.ros.stand_by`).
"""
from dataclasses import replace
import gc
import sys

import rosgraph
import rospy

from mhri.base.config import ConfigError
from mhri.driving.ros.mux import Mux, STOP_PARAMETER
from mhri.driving.ros.mux_takeover import end_other_muxes
from mhri.driving.sources import enabling_problem, parse_mux_config
from mhri.graph.ros import log, parameters
from mhri.graph.ros.ending import init_node
from mhri.graph.ros.master_api import MasterApi, MasterError
from mhri.graph.ros.peers import limit_peers
from mhri.graph.ros.resources import profile_reader, read_text, resource_path
from mhri.graph.ros.stand_by import stand_by


def config_path(argv):
    """Return ``~config`` of a node that does not exist yet, or ''.

    The file is read before the node takes its name: a mistake in it must not end the running mux.

    :raises MasterError: no master answers
    """
    own = [word.split(':=', 1)[1] for word in argv if word.startswith('_config:=')]
    if own:
        return own[-1]
    mappings = rosgraph.names.load_mappings(argv)
    name = rosgraph.names.resolve_name(
        mappings.get('__name', 'mux'), rosgraph.names.get_ros_namespace(argv=argv))
    return MasterApi(name, timeout_s=5.0).call_many([('getParam', name + '/config')])[0] or ''


def adjusted(config):
    """Return the configuration with the node's parameters in place of the file's values.

    :raises ConfigError: a parameter that cannot be used
    """
    enabling = parameters.text('~enabling', config.enabling or '')
    problem = enabling_problem(config.sources, enabling)
    if problem:
        raise ConfigError(rospy.resolve_name('~enabling'), '', problem)
    config = replace(config, enabling=enabling or None, automatic_switching=parameters.flag(
        '~automatic_switching', config.automatic_switching))
    return config if parameters.flag('~dead_man', config.dead_man) else config.without_dead_man()


def main():
    """Run until shut down; exit with 1 if the sources' file cannot be used."""
    beat = stand_by('the mux', beats=True)
    try:
        path = config_path(sys.argv) or resource_path('mux.yaml')
        config = parse_mux_config(read_text(path), path, profile_reader(path))
    except (ConfigError, OSError, MasterError) as error:
        sys.exit('the mux cannot start: {}'.format(error))
    limit_peers()
    init_node('mux')
    rospy.on_shutdown(beat.end)
    log.install()
    stopped = bool(rospy.get_param(STOP_PARAMETER, False))
    try:
        config = adjusted(config)
    except ConfigError as error:
        sys.exit('the mux cannot start: {}'.format(error))
    end_other_muxes()
    Mux(config, beat).start(stopped)
    if stopped:
        rospy.logwarn('stop-all was in force when the last mux ended: it still is')
    # What is loaded by now stays: searching it would delay a command.
    gc.freeze()
    rospy.spin()
