# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The executable ``mhri_replay``: replays a session, a folder of bags or a bag.

It needs a separate master: ``utils/host/mhri_run.sh --replay FOLDER`` starts both. It sets the
parameters ``/<robot>`` of each robot as recorded, ``/mux/sources``, ``/mhri/replay/robots`` ({name:
number}) and ``/mhri/replay/driven`` (whether mhri drove them).
"""
import argparse
import sys

import rosgraph
import rospy

from mhri.base.config import ConfigError
from mhri.base.robot_types import resolve_robot_type
from mhri.driving.ros.mux_file import read_mux_config, shipped_path
from mhri.graph.ros.master_api import MasterApi
from mhri.graph.ros.resources import robot_types
from mhri.graph.ros.service_owner import STOP_SERVICE
from mhri.graph.ros.shutdown import init_node
from mhri.recording.folder import NotASession
from mhri.recording.ros.bag_set import open_session
from mhri.session.foreign import robots_of_topics
from mhri.session.ros.player import Player
from mhri.session.topics import accessory_commands, DRIVE

ROBOTS_PARAMETER, DRIVEN_PARAMETER = '/mhri/replay/robots', '/mhri/replay/driven'


def main():
    """Replay until shut down; exit with 1 and the reason if that is impossible."""
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
        rospy.logwarn('the recording: %s', problem)
    # Recorded topics must not reach driven robots.
    if any(MasterApi(rospy.get_name(), timeout_s=5.0).call_many(
            [('lookupService', STOP_SERVICE)])):
        sys.exit('mhri drives at {}: replay with a master of its own (utils/host/mhri_run.sh '
                 '--replay)'.format(rosgraph.get_master_uri()))
    set_parameters(kept.robots, any(found.topic == DRIVE for found in kept.bags.connections()))
    Player(kept, commands_of(kept.robots, types)).start()
    # The player may be reading when the node ends, so its files are closed with the program.
    rospy.spin()


def set_parameters(robots, driven):
    """Set the parameters that a screen reads before it finds a robot (blocking).

    :param driven: whether the recording has the drive's state; if not, a screen does not expect it
    """
    for name, robot in robots.items():
        rospy.set_param('/' + name, parameters_of(robot))
    rospy.set_param(DRIVEN_PARAMETER, driven)
    rospy.set_param(ROBOTS_PARAMETER, {name: number_of(robot) for name, robot in robots.items()})
    try:
        sources = read_mux_config(shipped_path()).sources
    except (ConfigError, OSError) as error:
        rospy.logwarn('the names of the sources are not known: %s', error)
        return
    rospy.set_param('/mux/sources', [{'name': source.name, 'label': source.label,
                                      'suspend_service': ''} for source in sources])


def parameters_of(robot):
    """Return the recorded parameters of a robot."""
    parameters = robot.get('parameters')
    known = {'robot_type': robot.get('type'), 'robot_model': robot.get('model')}
    return {**(parameters if isinstance(parameters, dict) else {}),
            **{key: value for key, value in known.items() if isinstance(value, str)}}


def commands_of(robots, types):
    """Return the topics that commanded the accessories of robots, absolute."""
    return frozenset(topic for name, robot in robots.items() for topic in accessory_commands(
        name, resolve_robot_type(types, name, parameters_of(robot))[0]))


def number_of(robot):
    """Return the recorded number of a robot, 0 if it has none."""
    number = robot.get('number')
    return number if isinstance(number, int) else 0
