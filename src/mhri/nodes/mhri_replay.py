# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The executable ``mhri_replay``: replays a session, a folder of bags or a bag.

It needs a master of its own: ``utils/host/mhri_run.sh --replay FOLDER`` starts both. Parameters it
sets: ``/<robot>`` of each robot as recorded, ``/mux/sources``, ``/mhri/replay/robots`` ({name:
number}), ``/mhri/replay/driven`` (whether mhri drove them).
"""
import argparse
import sys

import rosgraph
import rospy

from mhri.base.config import ConfigError
from mhri.driving.sources import parse_mux_config
from mhri.graph.ros.ending import init_node
from mhri.graph.ros.in_force import STOP_SERVICE, TAKE_SERVICE
from mhri.graph.ros.master_api import MasterApi
from mhri.graph.ros.resources import profile_reader, read_text, resource_path, robot_types
from mhri.recording.folder import NotASession
from mhri.recording.ros.bag_set import open_session
from mhri.session.foreign import robots_of_topics
from mhri.session.ros.player import Player

ROBOTS_PARAMETER, DRIVEN_PARAMETER = '/mhri/replay/robots', '/mhri/replay/driven'
GATES = '/gates/state'


def main():
    """Replay until shut down; exit with 1 and a sentence if that cannot be."""
    parser = argparse.ArgumentParser(prog='mhri_replay', description=__doc__.split('\n')[0])
    parser.add_argument('path', help="a session's folder, a folder of bags, or a bag")
    path = parser.parse_args(rospy.myargv(sys.argv)[1:]).path
    types, _ = robot_types()
    try:
        kept = open_session(path, lambda topics, name: robots_of_topics(topics, types, name))
    except NotASession as error:
        sys.exit('cannot replay {}'.format(error))
    init_node('mhri_replay')
    for problem in kept.bags.problems:
        rospy.logwarn('left out: %s', problem)
    # What is recorded of robots must not meet those that drive.
    taken = MasterApi(rospy.get_name(), timeout_s=5.0).call_many(
        [('lookupService', name) for name in (STOP_SERVICE, TAKE_SERVICE)])
    if any(taken):
        sys.exit('mhri drives at {}: replay with a master of its own (utils/host/mhri_run.sh '
                 '--replay)'.format(rosgraph.get_master_uri()))
    set_parameters(kept.robots, any(found.topic == GATES for found in kept.bags.connections()))
    Player(kept).start()
    # The player may be reading when the node ends: its files are closed with the program.
    rospy.spin()


def set_parameters(robots, driven):
    """Set what a screen asks for before it knows a robot (blocking).

    :param driven: whether mhri drove them: else nobody misses its word
    """
    for name, robot in robots.items():
        parameters = robot.get('parameters')
        known = {'robot_type': robot.get('type'), 'robot_model': robot.get('model')}
        rospy.set_param('/' + name, {
            **(parameters if isinstance(parameters, dict) else {}),
            **{key: value for key, value in known.items() if isinstance(value, str)}})
    rospy.set_param(DRIVEN_PARAMETER, driven)
    rospy.set_param(ROBOTS_PARAMETER, {name: number_of(robot) for name, robot in robots.items()})
    path = resource_path('mux.yaml')
    try:
        sources = parse_mux_config(read_text(path), path, profile_reader(path)).sources
    except (ConfigError, OSError) as error:
        rospy.logwarn('the names of the sources are not known: %s', error)
        return
    rospy.set_param('/mux/sources', [{'name': source.name, 'label': source.label,
                                      'suspend_service': ''} for source in sources])


def number_of(robot):
    """Return the number of a robot as recorded, 0 if there is none."""
    number = robot.get('number')
    return number if isinstance(number, int) else 0
