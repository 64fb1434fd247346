# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A robot with an accessory of every kind, as the screen sees it."""
from dataclasses import replace

from mhri.base.limits import ZERO
from mhri.base.robot_types import parse_robot_type
from mhri.base.views import AccessoryView, LIVE, RobotView, ROS_CONNECTED, ScreenView

HEAD = 'name: lab\nlimits: {linear_mps: 0.5, angular_rad_s: 1}\ncommand: [cmd_vel]\n'
ROWS = """
  lamp: {kind: toggle, topic: lamp, state: lamp_state, on_stop: keep, icon: lightbulb}
  siren: {kind: toggle, topic: siren, on_stop: keep}
  horn: {kind: tap, topic: horn, on_stop: keep}
  gripper: {kind: tap, topic: gripper, type: std_msgs/Int32, icon: grab, on_stop: stop,
            choices: {open: {data: 1}, close: {data: 0}}}
  arm: {kind: choice, label: arm pose, topic: arm, type: std_msgs/Int32, state: arm_state,
        on_stop: stop, team: true, choices: {rest: {data: 0}, carry_high: {data: 1}}}
  flipper: {kind: hold, topic: flipper, type: std_msgs/Float64, on_stop: stop}
  winch: {kind: hold, topic: winch, type: std_msgs/Float64, range: [0, 2], on_stop: stop}
  head: {kind: axis2, mode: position, topic: head, type: geometry_msgs/Vector3, icon: move,
         state: head_state, range: [[-1.5, 1.5], [-0.5, 0.8]], on_stop: stop}
  lift: {kind: axis, topic: lift, type: std_msgs/Float64, on_stop: stop}
  gas: {kind: readout, topic: gas, type: std_msgs/Float32, unit: ppm, warn: 50}
"""


def specs(rows=ROWS):
    """Return {key: accessory} of the rows of a type."""
    return {spec.key: spec for spec in parse_robot_type(
        HEAD + 'accessories:' + rows, 'lab.yaml').accessories}


def robot(found, name='bot1', stands='', **states):
    """Return the view of a robot that is driven.

    :param found: {key: accessory}
    :param stands: why none of its accessories obeys
    :param states: {key: what it reports, a choice or values}
    """
    views = []
    for key, spec in found.items():
        state = states.get(key)
        known = {} if state is None else {'known': True, **(
            {'choice': state} if isinstance(state, str) else {'value': state})}
        views.append(AccessoryView(spec, stands=stands, **known))
    return RobotView(name, 'Crawler', link=LIVE, selected=True, sent=ZERO, number=1,
                     accessories=tuple(views))


def screen_of(*robots, **more):
    """Return the view of a screen in control."""
    return replace(ScreenView(ros=ROS_CONNECTED, robots=robots), **more)
