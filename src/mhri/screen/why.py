# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Why a robot stands though the stick is held: one sentence, with the remedy where there is one."""
from dataclasses import replace
from typing import Callable, Dict, Tuple

from mhri.base.brake_view import standing_words
from mhri.base.numbers import LAST_KEY
from mhri.base.views import (
    GONE, LIVE, PanelView, RobotView, ROS_CONNECTED, SILENT, UNANSWERED, VIRTUAL_JOYSTICK,
    WAITING)
from mhri.robots.gate_words import stands_words

# How long it has to be so before it is said [s]; motors take a moment to answer.
MOMENT_S = 0.4
MOTORS_S = 1.5
NO_ANSWER = 'commands reach it, its motors do not answer'
CENTRE = 'centre the stick to drive'
# What a mux waits for, and what to do about it.
_WAITS = {'neutral': CENTRE, 'enabling': 'press the enabling pedal to drive',
          'dead_man': 'hold the dead-man button to drive'}
# Of ``RobotView.stands`` those that other rules have words for.
_TOLD = ('', 'stopped', 'not_heard', 'joining')

# Forward and turn, each in [-1, 1].
_Stick = Tuple[float, float]


def why_still(view: PanelView, robot: RobotView, stick: _Stick) -> str:
    """Return the sentence; '' while the robot moves, or while nobody asks it to.

    A pad or pedal asks while it is pushed, or the mux commands anything.

    :param view: :class:`mhri.base.views.PanelView`
    :param robot: :class:`mhri.base.views.RobotView`, one of its robots
    :param stick: how pointer or keys hold the stick of this screen
    """
    asks = any(stick) or any(view.asked) or view.pushed and view.mode != VIRTUAL_JOYSTICK
    if not asks or robot.moving:
        return ''
    for rule in _RULES:
        words = rule(view, robot, stick)
        if words:
            return words
    return ''


def _not_connected(view: PanelView, _: RobotView, __: _Stick) -> str:
    return '' if view.ros == ROS_CONNECTED else 'this screen has no connection: see the bottom line'


def _stopped(view: PanelView, _: RobotView, __: _Stick) -> str:
    return 'STOP ALL is in force: release it to drive' if view.stop_all else ''


def _not_in_control(view: PanelView, _: RobotView, __: _Stick) -> str:
    if view.control.ours:
        return ''
    return '{} drives: take control first'.format(
        view.control.who.partition(' since ')[0] or 'somebody else')


def _nobody_decides(view: PanelView, _: RobotView, __: _Stick) -> str:
    if view.mode is None:
        return 'what decides who drives is not running: close this and start mhri again'
    return '' if view.answers else UNANSWERED


def _not_selected(_: PanelView, robot: RobotView, __: _Stick) -> str:
    if robot.selected:
        return ''
    what = 'not selected: {} to drive it'
    if robot.on_task:
        name = robot.task.label.lower() if robot.task else ''
        what = ' '.join(filter(None, ('on a task:', name and name + ';', '{} to take it over')))
    return what.format('press {}'.format(robot.number) if 0 < robot.number <= LAST_KEY
                       else 'check it in the list')


def _another_mode(view: PanelView, _: RobotView, stick: _Stick) -> str:
    if not any(stick) or view.mode == VIRTUAL_JOYSTICK:
        return ''
    sources = dict(view.sources)
    return '{} drives, not this stick: choose "{}" first'.format(
        sources.get(view.mode or '', view.mode),
        sources.get(VIRTUAL_JOYSTICK, 'Virtual joystick'))


def _device(view: PanelView, _: RobotView, __: _Stick) -> str:
    for device in view.devices:
        if device.source == view.mode and device.absent:
            return device.note
    if view.waits_for != 'source':
        return ''
    return view.advice or 'nothing is heard from {} yet'.format(
        dict(view.sources).get(view.mode or '', view.mode))


def _waits(view: PanelView, _: RobotView, __: _Stick) -> str:
    return _WAITS.get(view.waits_for, '')


def _not_heard(_: PanelView, robot: RobotView, __: _Stick) -> str:
    if robot.link == SILENT:
        return 'it has sent {}'.format(robot.note or 'nothing for a while')
    if robot.link == GONE:
        return robot.note or 'switched off or out of reach'
    if robot.link == WAITING:
        return robot.note or 'nothing is heard from it yet'
    return 'the drive service does not hear it' if robot.stands == 'not_heard' else ''


def _unreachable(_: PanelView, robot: RobotView, __: _Stick) -> str:
    return '' if robot.reached else 'nothing on it takes commands: is its driver running?'


def _own_stop(_: PanelView, robot: RobotView, __: _Stick) -> str:
    if robot.hardware_stop:
        return 'its own emergency stop is pressed: unlock it on the robot'
    if robot.power:
        return 'motor power {}'.format(robot.power)
    return ''


def _joins(_: PanelView, robot: RobotView, __: _Stick) -> str:
    return CENTRE if robot.waits else ''


def _no_speed(view: PanelView, _: RobotView, stick: _Stick) -> str:
    if view.mode != VIRTUAL_JOYSTICK or not any(stick) \
            or any(part * limit for part, limit in zip(stick, view.limits)):
        return ''
    return 'the speed limit is 0: raise it'


def _braked(_: PanelView, robot: RobotView, __: _Stick) -> str:
    return standing_words(robot.brake)


def _kept_standing(_: PanelView, robot: RobotView, __: _Stick) -> str:
    return '' if robot.stands in _TOLD else stands_words(robot.stands)


def _no_answer(_: PanelView, robot: RobotView, __: _Stick) -> str:
    # Of a robot without odometry nobody knows whether it moves.
    heard = robot.link == LIVE and robot.linear_mps is not None
    return NO_ANSWER if heard and (robot.sent_mps or robot.sent_rad_s) else ''


_RULES: Tuple[Callable[[PanelView, RobotView, _Stick], str], ...] = (
    _not_connected, _stopped, _not_in_control, _nobody_decides, _not_selected, _another_mode,
    _device, _waits, _not_heard, _unreachable, _own_stop, _joins, _no_speed, _braked,
    _kept_standing, _no_answer)


class WhyStill:
    """Says it once it has lasted a moment: a robot needs time to follow a pushed stick.

    What is no longer so is no longer said.
    """

    def __init__(self) -> None:
        self._since: Dict[str, Tuple[str, float]] = {}

    def tell(self, view: PanelView, stick: _Stick, now: float) -> PanelView:
        """Return the view with ``why`` of each robot.

        :param now: seconds of a clock that never goes back
        """
        before, self._since = self._since, {}
        robots = []
        for robot in view.robots:
            words = why_still(view, robot, stick)
            if words:
                said, since = before.get(robot.name, ('', now))
                self._since[robot.name] = words, since if said == words else now
                if now - self._since[robot.name][1] >= (
                        MOTORS_S if words == NO_ANSWER else MOMENT_S):
                    robot = replace(robot, why=words)
            robots.append(robot)
        return replace(view, robots=tuple(robots))
