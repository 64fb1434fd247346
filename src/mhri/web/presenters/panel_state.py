# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What a screen shows, as ``mhri/PanelState``, in the words of its widgets."""
import math

from mhri.base.battery import battery_level
from mhri.base.gui import theme
from mhri.base.gui.words import LINK_WORDS
from mhri.base.robot_colours import colour_of
from mhri.base.task_words import task_line
from mhri.base.views import LIVE
from mhri.msg import PanelRobot, PanelState
from mhri.robots.gui.tile_words import (
    drive_state, NOT_CONFIRMED, NOT_SELECTED, sentence_of, trouble_of)
from mhri.screen.status import BETWEEN, waits_words

CALM, ATTENTION, ALARM = LEVELS = 'calm', 'attention', 'alarm'
_OF_TROUBLE = {None: CALM, theme.ATTENTION: ATTENTION, theme.STOP: ALARM}


def _number(value):
    """Return a number for a message, NaN for None."""
    return math.nan if value is None else value


def panel_state(view, picture_of, place_of):
    """Return the ``mhri/PanelState`` of a :class:`mhri.base.views.ScreenView`.

    :param picture_of: function from a robot's name to the picture in its tile: (topic on which it
        is relayed, '' for none; its age [s], None before the first)
    :param place_of: function from a robot's name to (its pose on the map, None if not placed; the
        age of what that rests on [s], None if it does not age)
    """
    robots = [_robot(robot, view.stop_all, picture_of(robot.name), place_of(robot.name))
              for robot in view.robots]
    worst = max((robot for robot in robots if robot.level != CALM),
                key=lambda robot: LEVELS.index(robot.level), default=None)
    return PanelState(
        driving=view.status.partition(BETWEEN)[0],
        mode=dict(view.sources).get(view.mode, view.mode or ''),
        waits_for='' if view.stop_all else waits_words(view),
        stop_all=view.stop_all, linear_mps=view.limits[0], angular_rad_s=view.limits[1],
        worst='{}: {}'.format(worst.name, worst.reason or worst.state) if worst else '',
        robots=robots)


def _robot(view, stop_all, picture, place):
    """Return the ``mhri/PanelRobot`` of a :class:`mhri.base.views.RobotView`."""
    charge, (pose, place_age_s) = battery_level(view.battery), place
    state = drive_state(view, stop_all or view.proof is not None)
    if state == NOT_SELECTED:
        state = '' if view.link == LIVE else LINK_WORDS[view.link]
    level = ALARM if state == NOT_CONFIRMED else _OF_TROUBLE[trouble_of(view, charge)]
    reason, remedy = sentence_of(view, charge, False)[0], ''
    if view.why is not None and reason == view.why.sentence:
        reason, remedy = view.why.what, view.why.remedy
    return PanelRobot(
        name=view.name, number=min(view.number, 255), colour=colour_of(view.number, True),
        level=level, state=state, reason=reason, remedy=remedy, selected=view.selected,
        linear_mps=_number(view.linear_mps), angular_rad_s=_number(view.angular_rad_s),
        battery=_number(view.battery),
        age_s=_number(view.age_s), picture=picture[0], picture_age_s=_number(picture[1]),
        task=task_line(view.task) if view.task else '', placed=pose is not None,
        x=pose.x_m if pose else 0.0, y=pose.y_m if pose else 0.0,
        yaw=pose.heading_rad if pose else 0.0, place_age_s=_number(place_age_s))
