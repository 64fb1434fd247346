# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The line at the bottom of the screen, with the most important message."""
from typing import Optional, Tuple

from mhri.base import reasons
from mhri.base.battery import battery_level, FINE, FLAT
from mhri.base.names import listed
from mhri.base.reasons import Reason
from mhri.base.views import GONE, ROS_CONNECTED, ROS_CUT_OFF, ROS_STARTING, ScreenView, SILENT
from mhri.driving.stop_words import stop_words
from mhri.screen.asked import asked_and_done

CALM = 'calm'
ATTENTION = 'attention'
STOPPED = 'stopped'
#: between the robots, their source and its state
BETWEEN = '  \u2013  '
# (sentence, level).
_Line = Tuple[str, str]


def status_line(view: ScreenView, master_uri: str = '') -> _Line:
    """Return the driven robots, their source and what it waits for; or why none can be driven.

    :param view: :class:`mhri.base.views.ScreenView` without its status
    :returns: (sentence, level), never empty
    """
    for rule in (_no_ros, _stopped, _no_service):
        line = rule(view, master_uri)
        if line:
            return line
    for rule in (_not_ours, _no_robots, _lost_robot):
        line = rule(view, master_uri)
        if line:
            return _with_batteries(view, line)
    return _with_batteries(view, _driving(view))


def _no_ros(view: ScreenView, master_uri: str) -> Optional[_Line]:
    if view.ros == ROS_STARTING:
        return 'connecting to ROS', CALM
    if view.ros == ROS_CUT_OFF:
        return 'this screen is cut off and shows nothing new: restart it', STOPPED
    if view.ros != ROS_CONNECTED:
        return ('no ROS master at {}: start roscore there, or set ROS_MASTER_URI; looking again '
                'every second'.format(master_uri), ATTENTION)
    return None


def _stopped(view: ScreenView, _: str) -> Optional[_Line]:
    if view.stop_all:
        return stop_words(view.robots, view.stop_taken, view.answers).sentence, STOPPED
    return None


def _no_service(view: ScreenView, _: str) -> Optional[_Line]:
    return None if view.answers else (Reason(reasons.DRIVE_SILENT).sentence, ATTENTION)


def _not_ours(view: ScreenView, _: str) -> Optional[_Line]:
    if not view.control.ours:
        return 'read-only: {} is in control'.format(view.control.words), CALM
    return None


def _no_robots(view: ScreenView, _: str) -> Optional[_Line]:
    if not view.robots:
        return 'no robots yet: look for connected bots, or add one by its name', CALM
    if not any(robot.selected for robot in view.robots):
        busy = [robot.name for robot in view.robots if robot.on_task]
        words = '{} on a task; '.format(', '.join(busy) if len(busy) <= 3 else '{} robots'.format(
            len(busy))) if busy else ''
        return words + 'no robot selected: check the ones to drive', CALM
    return None


def _lost_robot(view: ScreenView, _: str) -> Optional[_Line]:
    for robot in view.robots:
        if robot.selected and robot.link == SILENT:
            return '{} has sent {}'.format(robot.name, robot.note), ATTENTION
        if robot.selected and robot.link == GONE:
            return '{}: {}'.format(robot.name, robot.note), ATTENTION
    return None


def _driving(view: ScreenView) -> _Line:
    """Return the driven robots, their source, and what it waits for."""
    mode = view.mode or ''
    label = dict(view.sources).get(mode, mode)
    if not view.dead_man:
        label += ' (no dead-man button)'
    who = 'Driving ' + listed([robot.name for robot in view.robots if robot.selected])
    absent = [device.note for device in view.devices if device.source == mode and device.absent]
    if absent:
        return '{}: {}'.format(label, absent[0]), ATTENTION
    waits = waits_words(view)
    if waits:
        between = ': ' if _advised(view) else BETWEEN
        return who + BETWEEN + label + between + waits, \
            CALM if view.waits_for in (reasons.ENABLING, reasons.DEAD_MAN) else ATTENTION
    waiting = [robot.name for robot in view.robots if robot.selected and robot.waits]
    if waiting:
        return BETWEEN.join((who, label, '{}: {}'.format(
            ', '.join(waiting), Reason(reasons.JOINING).what))), ATTENTION
    driven = any(robot.driven and robot.selected for robot in view.robots)
    state = asked_and_done(view.robots) or ('moving' if driven else 'ready')
    return BETWEEN.join((who, label, state)), CALM


def _advised(view: ScreenView) -> bool:
    """Return whether it is known why the active source cannot drive."""
    return view.advice is not None and view.waits_for == reasons.SOURCE


def waits_words(view: ScreenView) -> str:
    """Return what keeps all robots from moving, except STOP ALL; '' for nothing."""
    if view.advice is not None and _advised(view):
        return view.advice.sentence
    names = ('it',) if view.waits_for == reasons.SOURCE else ()
    return Reason(view.waits_for, names).what if view.waits_for not in (
        '', reasons.RELEASE) else ''


def _with_batteries(view: ScreenView, line: _Line) -> _Line:
    """Append the robots with low batteries to a line, the lowest first."""
    low = sorted((robot.battery, robot.name) for robot in view.robots
                 if robot.battery is not None and battery_level(robot.battery) != FINE)
    if not low:
        return line
    flat = battery_level(low[0][0]) == FLAT
    names = ['{} battery {:.0f} %'.format(name, 100.0 * charge) for charge, name in low[:2]]
    if len(low) > 2:
        names[1:] = ['{} more'.format(len(low) - 1)]
    return '; '.join((line[0], ', '.join(names))), STOPPED if flat else ATTENTION
