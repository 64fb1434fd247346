# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The line at the bottom of the screen: the one thing that matters now."""
from typing import Optional, Tuple

from mhri.base.battery import battery_level, FINE, FLAT
from mhri.base.views import (
    GONE, PanelView, ROS_CONNECTED, ROS_CUT_OFF, ROS_STARTING, SILENT, UNANSWERED)
from mhri.driving.stop_words import stop_words
from mhri.screen.asked import asked_and_done

CALM = 'calm'
ATTENTION = 'attention'
STOPPED = 'stopped'
# A sentence and its level.
_Line = Tuple[str, str]


def status_line(view: PanelView, waits_for: Optional[str], master_uri: str = '') -> _Line:
    """Return who is driven, by what and what it waits for; or what keeps everything from working.

    :param view: :class:`mhri.base.views.PanelView`, its status not yet filled
    :param waits_for: the last word of ``/mux/waits_for``; None if the mux has not been heard
    :returns: (sentence, level), never empty
    """
    for rule in (_no_ros, _stopped, _no_mux, _no_gates):
        line = rule(view, waits_for, master_uri)
        if line:
            return line
    for rule in (_not_ours, _no_robots, _lost_robot):
        line = rule(view, waits_for, master_uri)
        if line:
            return _with_batteries(view, line)
    return _with_batteries(view, _driving(view, waits_for))


def _no_ros(view: PanelView, _: Optional[str], master_uri: str) -> Optional[_Line]:
    if view.ros == ROS_STARTING:
        return 'connecting to ROS', CALM
    if view.ros == ROS_CUT_OFF:
        return 'this screen is cut off and shows nothing new: restart it', STOPPED
    if view.ros != ROS_CONNECTED:
        return ('no ROS master at {}: start roscore there, or set ROS_MASTER_URI; looking again '
                'every second'.format(master_uri), ATTENTION)
    return None


def _stopped(view: PanelView, _: Optional[str], __: str) -> Optional[_Line]:
    if view.stop_all:
        return stop_words(view.robots, view.stop_taken, view.answers).sentence, STOPPED
    return None


def _no_mux(view: PanelView, _: Optional[str], __: str) -> Optional[_Line]:
    if view.mode is None:
        return 'what decides who drives is not running: close this and start mhri again', ATTENTION
    return None


def _no_gates(view: PanelView, _: Optional[str], __: str) -> Optional[_Line]:
    if not view.answers:
        return UNANSWERED + ': no robot can be driven, and those that were stand', ATTENTION
    return None


def _not_ours(view: PanelView, _: Optional[str], __: str) -> Optional[_Line]:
    if not view.control.ours:
        return 'only looking on: {} drives'.format(view.control.who or 'somebody else'), CALM
    return None


def _no_robots(view: PanelView, _: Optional[str], __: str) -> Optional[_Line]:
    if not view.robots:
        return 'no robots yet: look for connected bots, or add one by its name', CALM
    if not any(robot.selected for robot in view.robots):
        busy = [robot.name for robot in view.robots if robot.on_task]
        words = '{} on a task; '.format(', '.join(busy) if len(busy) <= 3 else '{} robots'.format(
            len(busy))) if busy else ''
        return words + 'no robot selected: check the ones to drive', CALM
    return None


def _lost_robot(view: PanelView, _: Optional[str], __: str) -> Optional[_Line]:
    for robot in view.robots:
        if robot.selected and robot.link == SILENT:
            return '{} has sent {}'.format(robot.name, robot.note), ATTENTION
        if robot.selected and robot.link == GONE:
            return '{}: {}'.format(robot.name, robot.note), ATTENTION
    return None


def _driving(view: PanelView, waits_for: Optional[str]) -> _Line:
    """Return who is driven, by what, and what it waits for."""
    mode = view.mode or ''
    label = dict(view.sources).get(mode, mode)
    if not view.dead_man:
        label += ' (no dead-man button)'
    count = sum(robot.selected for robot in view.robots)
    who = '{} of {} robots'.format(count, len(view.robots))
    absent = [device.note for device in view.devices if device.source == mode and device.absent]
    if absent:
        return '{}: {}'.format(label, absent[0]), ATTENTION
    if view.advice and waits_for == 'source':
        return '{}  \u2013  {}'.format(who, view.advice), ATTENTION
    words = {'neutral': 'centre the stick to drive',
             'source': 'nothing is heard from it yet',
             'enabling': 'press the enabling pedal to drive',
             'dead_man': 'hold the dead-man button to drive'}.get(waits_for or '')
    if words:
        return '{}  \u2013  {}  \u2013  {}'.format(who, label, words), \
            ATTENTION if waits_for in ('source', 'neutral') else CALM
    waiting = [robot.name for robot in view.robots if robot.selected and robot.waits]
    if waiting:
        return '{}  \u2013  {}  \u2013  {}: centre the stick to drive'.format(
            who, label, ', '.join(waiting)), ATTENTION
    driven = any(robot.driven and robot.selected for robot in view.robots)
    state = asked_and_done(view.robots) or ('driving' if driven else 'ready')
    return '{}  \u2013  {}  \u2013  {}'.format(who, label, state), CALM


def _with_batteries(view: PanelView, line: _Line) -> _Line:
    """Add the robots with low batteries, the emptiest first, to what the line says."""
    low = sorted((robot.battery, robot.name) for robot in view.robots
                 if robot.battery is not None and battery_level(robot.battery) != FINE)
    if not low:
        return line
    flat = battery_level(low[0][0]) == FLAT
    names = ['{} battery {:.0f} %'.format(name, 100.0 * charge) for charge, name in low[:2]]
    if len(low) > 2:
        names[1:] = ['{} more'.format(len(low) - 1)]
    return '; '.join((line[0], ', '.join(names))), STOPPED if flat else ATTENTION
