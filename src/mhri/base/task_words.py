# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Texts on tasks: the progress of a robot, its result, and why none can be started."""
from typing import Sequence, Tuple

from mhri.base.reasons import DRIVE_SILENT, NOT_OURS, Reason, STOPPED
from mhri.base.task_views import TasksView, TaskView
from mhri.base.views import RobotView, ScreenView

NOT_RUNNING = ('the task service is not running: it restarts within seconds; if it does not, start '
               'mhri again')
NOT_ANSWERING = 'the task service does not answer: robots on a task have stopped'
# How a continued task resumes; any other starts again.
_GOES_ON = {'goto': 'goes on to its goal', 'return': 'goes on back',
            'follow': 'goes on behind its leader', 'formation': 'goes back to its place',
            'patrol': 'goes to the first corner of its route', 'hold': 'stays where it is now'}
_ANEW = 'starts again from where it is'
_ENDED = {'done': 'done', 'timeout': 'timed out', 'blocked': 'blocked', 'lost': 'lost',
          'taken_over': 'taken over', 'stopped': 'stopped', 'failed': 'failed'}


def task_line(task: TaskView) -> str:
    """Describe the progress of a robot, e.g. "square: corner 2 of 4, 1.3 m to go".

    For one that waits, it is the reason: "square waits: an obstacle is in its way".
    """
    label, text = task.label.lower(), task.text
    if task.waits:
        return '{} {}'.format(label, text) if text.startswith('waits') else \
            '{} waits: {}'.format(label, text)
    text = text.replace(': ', ', ')
    if task.left_m is not None and ' m' not in text:
        text = ', '.join(filter(None, (text, '{:.1f} m left'.format(task.left_m))))
    return '{}: {}'.format(label, text) if text else label


def task_lines(task: TaskView) -> Tuple[str, ...]:
    """Return shorter and shorter forms of :func:`task_line`: the remainder, or why it waits."""
    line, label = task_line(task), task.label.lower()
    if task.waits:
        waits = line[len(label) + 1:]
        return line, waits, waits.partition(': ')[2] or waits
    last = line.partition(': ')[2].rpartition(', ')[2]
    return (line, '{}, {}'.format(label, last), last) if last else (line,)


def interrupted_line(label: str, key: str = '') -> str:
    """Describe that a robot could continue a task.

    :param key: the key that continues it
    """
    return '{} interrupted{}'.format(
        label.lower(), ': press {} to continue it'.format(key) if key else '')


def ended_line(label: str, state: str, text: str) -> str:
    """Describe the end of a task, e.g. "square blocked: for 5 s: an obstacle is in its way"."""
    return '{} {}: {}'.format(label.lower(), _ENDED.get(state, state), text)


def carry_on_line(key: str) -> str:
    """Describe how a robot continues a task, e.g. "goes on to its goal"."""
    return _GOES_ON.get(key, _ANEW)


def start_problem(view: ScreenView, tasks: TasksView, robots: Sequence[str]) -> str:
    """Return why these robots cannot start a task now, and the remedy; '' if they can."""
    if not view.control.ours:
        return Reason(NOT_OURS, (view.control.who,)).sentence
    if view.stop_all:
        return Reason(STOPPED).sentence
    if not view.answers:
        return Reason(DRIVE_SILENT).what
    if tasks.problem:
        return tasks.problem
    return '' if robots else 'select a robot first'


def for_whom(robots: Sequence[RobotView]) -> Tuple[str, ...]:
    """Describe the robots a task is started for, in shorter and shorter forms.

    :param robots: the selected robots, else the one in view
    """
    if not robots:
        return ('select a robot first',)
    names = ', '.join(robot.name for robot in robots)
    if not robots[0].selected:
        return 'for {}, which you look at'.format(names), 'for ' + names
    return ('starts on {}; they will be deselected'.format(names),
            'on {}; deselected'.format(names),
            'for {} robots'.format(len(robots)) if len(robots) > 1 else 'for ' + names)
