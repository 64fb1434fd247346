# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Why a robot stands still while the stick is held: the first applicable :class:`Reason`."""
from dataclasses import replace
from typing import Callable, Dict, Iterator, Optional, Tuple

from mhri.base import reasons
from mhri.base.numbers import LAST_KEY
from mhri.base.reasons import Reason
from mhri.base.views import (
    GONE, LIVE, RobotView, ROS_CONNECTED, ScreenView, SILENT, VIRTUAL_JOYSTICK, WAITING)

# Time for which a reason must hold before it is shown [s]; motors take a moment to respond.
MOMENT_S = 0.4
MOTORS_S = 1.5
# Codes of ``RobotView.stands`` handled by other rules, or compatible with motion.
_OTHER_RULES = ('', reasons.STOPPED, reasons.NOT_HEARD, reasons.JOINING, reasons.HARDWARE_STOP,
                reasons.POWER_CUT, reasons.LIMIT_RAISED)

# Forward, turn and sideways, each in [-1, 1].
_Stick = Tuple[float, float, float]


def why_still(view: ScreenView, robot: RobotView, stick: _Stick) -> Optional[Reason]:
    """Return why a robot does not follow its command; None if it does, or without a command.

    A pad or pedal commands while it is pushed, or while the mux command is not zero.

    :param view: :class:`mhri.base.views.ScreenView`
    :param robot: :class:`mhri.base.views.RobotView` of one of its robots
    :param stick: deflection of this screen's stick by pointer or keys
    """
    asks = any(stick) or any(view.asked) or view.pushed and view.mode != VIRTUAL_JOYSTICK
    if not asks:
        return None
    rules = (_sideways,) if robot.moving else _RULES
    return next((reason for rule in rules for reason in rule(view, robot, stick)), None)


def _of_screen(view: ScreenView, _: RobotView, __: _Stick) -> Iterator[Reason]:
    """Yield reasons why this screen cannot drive."""
    if view.ros != ROS_CONNECTED:
        yield Reason(reasons.NO_CONNECTION)
    if view.stop_all:
        yield Reason(reasons.STOPPED)
    if not view.control.ours:
        yield Reason(reasons.NOT_OURS, (view.control.who,))
    if not view.answers:
        yield Reason(reasons.DRIVE_SILENT)


def _not_selected(_: ScreenView, robot: RobotView, __: _Stick) -> Iterator[Reason]:
    if robot.selected:
        return
    name = robot.task.label.lower() + '; ' if robot.on_task and robot.task else ''
    yield Reason(reasons.ON_TASK if robot.on_task else reasons.NOT_SELECTED, (name + (
        'press {}'.format(robot.number) if 0 < robot.number <= LAST_KEY
        else 'check it in the list'),))


def _of_source(view: ScreenView, _: RobotView, stick: _Stick) -> Iterator[Reason]:
    """Yield reasons why the active source cannot drive."""
    sources = dict(view.sources)
    source = sources.get(view.mode or '', view.mode or '')
    if any(stick) and view.mode != VIRTUAL_JOYSTICK:
        yield Reason(reasons.OTHER_SOURCE, (
            source, sources.get(VIRTUAL_JOYSTICK, 'Virtual joystick')))
    for device in view.devices:
        if device.source == view.mode and device.absent:
            yield Reason(reasons.DEVICE, (device.note,))
    if view.waits_for == reasons.SOURCE:
        yield view.advice or Reason(reasons.SOURCE, (source,))
    elif view.waits_for and view.waits_for != reasons.RELEASE:
        yield Reason(view.waits_for)


def _not_heard(_: ScreenView, robot: RobotView, __: _Stick) -> Iterator[Reason]:
    if robot.link == SILENT:
        yield Reason(reasons.LINK_SILENT, (robot.note or 'nothing for a while',))
    elif robot.link == GONE:
        yield Reason(reasons.LINK_LOST, (robot.note or 'switched off or out of reach',))
    elif robot.link == WAITING:
        yield Reason(reasons.LINK_LOST, (robot.note or 'nothing received from it yet',))
    elif robot.stands == reasons.NOT_HEARD:
        yield Reason(robot.stands)


def _of_robot(view: ScreenView, robot: RobotView, stick: _Stick) -> Iterator[Reason]:
    """Yield reasons why a live robot cannot move."""
    if not robot.reached:
        yield Reason(reasons.NOT_REACHED)
    if robot.hardware_stop:
        yield Reason(reasons.HARDWARE_STOP)
    power = reasons.power_reason(robot.power)
    if power:
        yield power
    if robot.waits:
        yield Reason(reasons.JOINING)
    if view.mode == VIRTUAL_JOYSTICK and any(stick) \
            and not any(part * limit for part, limit in zip(
                stick, (*view.limits, view.limits[0]))):
        yield Reason(reasons.NO_SPEED)


def _sideways(view: ScreenView, robot: RobotView, stick: _Stick) -> Iterator[Reason]:
    """Yield a reason if a robot, or its group, cannot follow a sideways command."""
    if not robot.selected or not (stick[2] and view.mode == VIRTUAL_JOYSTICK
                                  or view.asked.lateral_mps):
        return
    unable = [other.name for other in view.robots if other.selected and not other.holonomic]
    if not robot.holonomic:
        yield Reason(reasons.NOT_SIDEWAYS)
    elif view.together and unable:
        yield Reason(reasons.TOGETHER, (unable[0],))


def _at_last(_: ScreenView, robot: RobotView, __: _Stick) -> Iterator[Reason]:
    if robot.brake.holds:
        yield Reason(robot.brake.word)
    if robot.stands not in _OTHER_RULES:
        yield Reason(robot.stands)
    # Without odometry it is unknown whether it moves.
    heard = robot.link == LIVE and robot.linear_mps is not None
    if heard and robot.sent and not robot.sent.is_zero():
        yield Reason(reasons.NO_ANSWER)


_RULES: Tuple[Callable[[ScreenView, RobotView, _Stick], Iterator[Reason]], ...] = (
    _of_screen, _not_selected, _of_source, _not_heard, _of_robot, _sideways, _at_last)


class WhyStill:
    """Shows a reason once it has held for a moment, as a robot needs time to follow the stick.

    A reason that no longer holds is dropped at once.
    """

    def __init__(self) -> None:
        self._since: Dict[str, Tuple[Reason, float]] = {}

    def explain(self, view: ScreenView, stick: _Stick, now: float,
                looked_at: str = '') -> ScreenView:
        """Return the view with ``why`` of each robot that is selected or looked at.

        The others rightly stand still: the stick is not meant for them.

        :param now: time [s, monotonic]
        :param looked_at: the robot in view, '' for none
        """
        before, self._since = self._since, {}
        robots = []
        for robot in view.robots:
            meant = robot.selected or robot.name == looked_at
            reason = why_still(view, robot, stick) if meant else None
            if reason:
                said, since = before.get(robot.name, (reason, now))
                since = since if said.code == reason.code else now
                self._since[robot.name] = reason, since
                if now - since >= (MOTORS_S if reason.code == reasons.NO_ANSWER else MOMENT_S):
                    robot = replace(robot, why=reason)
            robots.append(robot)
        return replace(view, robots=tuple(robots))
