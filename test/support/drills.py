# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The shipped drills with their buildings and bodies, read without ROS."""
from pathlib import Path

from mhri.base.robot_types import Limits
from mhri.drill.scenario import parse_scenario
from mhri.sim.body import parse_bodies
from mhri.sim.plan import parse_plan

RESOURCE = Path(__file__).resolve().parents[2] / 'resource'
DRILLS = RESOURCE / 'drills'
NAMES = sorted(path.stem for path in DRILLS.glob('*.yaml'))
BODIES = parse_bodies((RESOURCE / 'sim' / 'bodies.yaml').read_text(), 'bodies.yaml')
LIMITS = {'turtlebot2': Limits(0.65, 3.14), 'turtlebot3_burger': Limits(0.22, 2.84),
          'turtlebot3_waffle': Limits(0.26, 1.82)}


def drill(name):
    """Return (scenario, plan, {robot: (body, limits)}) of a shipped drill."""
    scenario = parse_scenario((DRILLS / (name + '.yaml')).read_text(), name + '.yaml', name)
    path = DRILLS / 'plans' / scenario.plan
    plan = parse_plan(path.read_text(), scenario.plan)
    return scenario, plan, {robot: (BODIES[kind], LIMITS[kind])
                            for robot, kind in zip(scenario.robots, scenario.types)}
