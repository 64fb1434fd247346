# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Questions before removing a robot in use, and before closing the screen."""
from typing import Iterable, List

from mhri.base.views import RobotView


def remove_question(robot: RobotView) -> str:
    """Return the question before a robot is removed from the list; '' if it is not in use.

    :param robot: :class:`mhri.base.views.RobotView`
    """
    uses = ['on a task'] if robot.on_task else ['driven'] if robot.driven else \
        ['selected'] if robot.selected else []
    uses += ['being recorded'] if robot.recording else []
    return '{} is {}: remove it?'.format(robot.name, ' and '.join(uses)) if uses else ''


def close_question(robots: Iterable[RobotView], session: bool = False) -> str:
    """Return the question before the screen is closed; '' if nothing drives or records.

    :param session: whether the whole session is recorded
    """
    robots = tuple(robots)
    parts = _part([robot.name for robot in robots if robot.driven and not robot.on_task], 'driven')
    parts += _part([robot.name for robot in robots if robot.on_task], 'on a task')
    parts += _part([robot.name for robot in robots if robot.recording], 'being recorded')
    parts += ['the session is being recorded'] if session else []
    return '{}: close anyway?'.format(', '.join(parts)) if parts else ''


def _part(names: List[str], use: str) -> List[str]:
    """Return a clause about names in a list, [] without names."""
    if not names:
        return []
    who = names[0] if len(names) == 1 else '{} robots'.format(len(names)) if len(names) > 3 \
        else ' and '.join((', '.join(names[:-1]), names[-1]))
    return ['{} {} {}'.format(who, 'is' if len(names) == 1 else 'are', use)]
