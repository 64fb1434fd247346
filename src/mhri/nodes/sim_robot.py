# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The executable ``sim_robot``: a simulated robot in the namespace it is started in.

Parameters: ``robot_type`` and ``robot_model`` of the robot's namespace (its template),
``~accessories`` (true: those of ``mhri/accessories`` of its namespace that the simulator knows are
simulated as well, see :mod:`mhri.sim.ros.tools_node`), ``~plan`` (path, default
``resource/sim/plan.yaml``), ``~x``, ``~y`` [m], ``~yaw`` [rad] (default: the plan's start pose for
the number at the end of the name), ``~depth_format`` (``png`` or ``rvl``, of compressedDepth),
``~mocap`` (true: a motion capture system reports its pose), ``~placed`` (true: tf has the pose of
its odometry in the frame ``map``), ``~map`` (true: it publishes the plan as ``/map``; only one
robot should), ``~seed`` (integer; default: random).
"""
import random
import re
import sys
import time
from urllib.parse import urlparse

import numpy as np
import rosgraph
import rosgraph.network
import rospy

from mhri.base.config import ConfigError, short, shown
from mhri.base.robot_types import resolve_robot_type
from mhri.graph.ros import parameters
from mhri.graph.ros.master_watch import MasterWatch
from mhri.graph.ros.resources import read_resource, read_text, resource_path, robot_types
from mhri.graph.ros.shutdown import start_node
from mhri.map.ros.map_source import publish_map
from mhri.sensors.readings import no_return_of
from mhri.sim.body import Body, Bumper, parse_bodies
from mhri.sim.floor_map import grid_of_plan
from mhri.sim.plan import parse_plan
from mhri.sim.ros.camera_node import DEPTH_FORMATS, SimCamera
from mhri.sim.ros.fault_node import Failing
from mhri.sim.ros.node import SimRobot
from mhri.sim.ros.tools_node import SimTools
from mhri.sim.sensors import ImuSensor, Laser
from mhri.sim.world import World, world_path, WorldFull


ACCESSORIES = 'mhri/accessories'
# Bounds of a start pose [m, rad], beyond any building and heading; NaN is refused, too.
FARTHEST = 1000.0


def start_pose(plan, name, radius_m):
    """Return (x, y, yaw) [m, m, rad]: the given parameters, else a start pose of the plan.

    :raises ConfigError: one is not a number, or the body would overlap a wall or a landmark
    """
    number = re.search(r'(\d+)\Z', name)
    pose = list(plan.starts[(int(number.group(1)) - 1 if number else 0) % len(plan.starts)])
    for index, key in enumerate(('x', 'y', 'yaw')):
        value = rospy.get_param('~' + key, '')
        if value != '':
            try:
                pose[index] = float(value)
            except (TypeError, ValueError):
                raise ConfigError(rospy.resolve_name('~' + key), '',
                                  'expected a number, got {}'.format(shown(value)))
    if not (all(abs(part) <= FARTHEST for part in pose)
            and plan.distance(pose[0], pose[1]) >= radius_m):
        raise ConfigError(rospy.resolve_name('~x'), '', 'a body of {:g} m radius cannot stand at '
                          'x {:g}, y {:g} of this plan'.format(radius_m, pose[0], pose[1]))
    return tuple(pose)


def building_key(plan):
    """Return the key that identifies a building to its robots: the master and the plan.

    One master has several addresses (``localhost``, the host's name, each of its interfaces).
    """
    uri = urlparse(rosgraph.get_master_uri())
    local = rosgraph.network.is_local_address(uri.hostname)
    return '{}:{}/{}'.format('localhost' if local else uri.hostname, uri.port, plan.name)


def body_type(name, template):
    """Return the :class:`BodyType` of a template and its model.

    :raises ConfigError: the template or the model has no body type
    """
    bodies = parse_bodies(read_resource('sim', 'bodies.yaml'), resource_path('sim', 'bodies.yaml'))
    key = template.name if template.model is None else '{}_{}'.format(template.name, template.model)
    if key not in bodies:
        raise ConfigError('/' + name, 'robot_type', 'no simulated body for {!r}; there are '
                          '{}'.format(key, ', '.join(sorted(bodies))))
    return bodies[key]


def seed_of():
    """Return the parameter ``~seed``, an integer >= 0; None if it is not set.

    :raises ConfigError: it is not such a number
    """
    seed = rospy.get_param('~seed', None)
    if seed is not None and (type(seed) is not int or seed < 0):
        raise ConfigError(rospy.resolve_name('~seed'), '',
                          'expected a whole number from 0 up, got {}'.format(shown(seed)))
    return seed


def build(name, of_robot):
    """Create the :class:`SimRobot` described by the parameters of a robot's namespace.

    :raises ConfigError: an unknown type or model, a plan or a start place that cannot be used
    :raises WorldFull: the building has too many robots
    :raises OSError: a file cannot be read
    """
    template, errors = resolve_robot_type(robot_types()[0], name, of_robot)
    if errors:
        raise errors[0]
    kind = body_type(name, template)
    path = parameters.text('~plan', '') or resource_path('sim', 'plan.yaml')
    plan = parse_plan(read_text(path), path)
    pose = start_pose(plan, name, kind.radius_m)
    seed = seed_of()
    chance = random.Random(seed)
    laser = Laser(plan.walls, kind.scan_min_m, kind.scan_max_m, np.random.default_rng(seed),
                  nothing=no_return_of(template.no_return, kind.scan_max_m)[0])
    shared = world_path(building_key(plan))
    world = World(shared, name, kind, time.monotonic)
    body = Body(kind, template.limits, pose, Bumper(kind.radius_m, plan.distance, world.discs),
                chance)
    failing = Failing(name, template, body, shared, plan.distance)
    failing.serve()
    tools = SimTools(name, template, failing, plan.gas)
    SimCamera(name, template, plan, lambda: (body.x, body.y, body.yaw), world.others,
              parameters.choice('~depth_format', DEPTH_FORMATS), failing, tools).start()
    if parameters.flag('~map', False):
        publish_map(grid_of_plan(plan))
    return SimRobot(name, template, body, ImuSensor(chance), laser, world, plan.discs(),
                    failing, tools, parameters.flag('~mocap', False),
                    parameters.flag('~placed', False))


def main():
    """Run until shut down; exit with 1 and a reason if the robot cannot be built."""
    start_node('base', namespace=None)
    name = rospy.get_namespace().strip('/')
    if not name or '/' in name:
        rospy.logfatal('start a simulated robot inside a group named after it: '
                       'roslaunch mhri turtlebot.launch name:=bot1')
        sys.exit(1)
    try:
        # Those of a lab have drivers of their own.
        keys = ('robot_type', 'robot_model') + (
            (ACCESSORIES,) if parameters.flag('~accessories', False) else ())
        of_robot = {key: rospy.get_param(key) for key in keys if rospy.has_param(key)}
        robot = build(name, dict(of_robot, mhri={'accessories': of_robot[ACCESSORIES]})
                      if ACCESSORIES in of_robot else of_robot)
    except (ConfigError, WorldFull, OSError, ValueError) as error:
        rospy.logfatal('%s cannot be simulated: %s', name, short(error))
        sys.exit(1)
    MasterWatch(parameters={rospy.resolve_name(key): value
                            for key, value in of_robot.items()}).start()
    robot.run()
