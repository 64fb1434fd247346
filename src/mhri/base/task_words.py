# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Tasks in words: how a robot is getting on, how it ended, and why none can be started now."""
import re
from typing import Optional, Sequence, Tuple

from mhri.base.task_views import TasksView, TaskView
from mhri.base.views import PanelView, RobotView, UNANSWERED

NOT_RUNNING = ('the task service is not running: it restarts within seconds; if it does not, start '
               'mhri again')
NOT_ANSWERING = 'the task service does not answer: robots on a task stand'
# How a task that is continued goes on; any other begins anew.
_GOES_ON = {'goto': 'goes on to its goal', 'return': 'goes on back',
            'follow': 'goes on behind its leader', 'formation': 'goes back to its place',
            'patrol': 'goes to the first corner of its route', 'hold': 'stands where it is now'}
_ANEW = 'begins anew from where it stands'
_ENDED = {'done': 'done', 'timeout': 'timed out', 'blocked': 'blocked', 'lost': 'lost',
          'taken_over': 'taken over', 'stopped': 'stopped', 'failed': 'failed'}
# What is said of a task that begins ends so.
STARTED = ' started'
_ENDED_LINE = re.compile('([^:]+?) ({}): (.*)'.format('|'.join(_ENDED.values())))


def task_line(task: TaskView) -> str:
    """Return how a robot is getting on, e.g. "square: corner 2 of 4, 1.3 m to go".

    One that waits says why: "square waits: something is in its way".
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
    """Return :func:`task_line` in fewer and fewer words: what is left, or why it waits."""
    line, label = task_line(task), task.label.lower()
    if task.waits:
        waits = line[len(label) + 1:]
        return line, waits, waits.partition(': ')[2] or waits
    last = line.partition(': ')[2].rpartition(', ')[2]
    return (line, '{}, {}'.format(label, last), last) if last else (line,)


def interrupted_line(label: str, key: str = '') -> str:
    """Return what is said of a robot that could continue a task.

    :param key: the key that continues it
    """
    return '{} interrupted{}'.format(
        label.lower(), ': press {} to continue it'.format(key) if key else '')


def ended_line(label: str, state: str, text: str) -> str:
    """Return how a task ended, e.g. "square blocked: for 5 s: something is in its way"."""
    return '{} {}: {}'.format(label.lower(), _ENDED.get(state, state), text)


def ended_as(line: str) -> Optional[Tuple[str, str, str]]:
    """Return (label, state, text) of a line of :func:`ended_line`, None of any other."""
    found = _ENDED_LINE.fullmatch(line)
    if found is None:
        return None
    label, word, text = found.groups()
    return label, next(state for state, said in _ENDED.items() if said == word), text


def carry_on_line(key: str) -> str:
    """Return what a robot does that is told to continue a task, e.g. "goes on to its goal"."""
    return _GOES_ON.get(key, _ANEW)


def start_problem(view: PanelView, tasks: TasksView, robots: Sequence[str]) -> str:
    """Return why these robots cannot be put on a task now, and the remedy; '' where they can."""
    if not view.control.ours:
        return '{} drives: take control first'.format(
            view.control.who.partition(' since ')[0] or 'somebody else')
    if view.stop_all:
        return 'STOP ALL is in force: release it first'
    if not view.answers:
        return UNANSWERED
    if tasks.problem:
        return tasks.problem
    return '' if robots else 'check a robot, or look at one'


def for_whom(robots: Sequence[RobotView]) -> Tuple[str, ...]:
    """Return whom a task is started for, in fewer and fewer words.

    :param robots: those that are checked, else the one that is looked at
    """
    if not robots:
        return ('for nobody yet: check a robot, or look at one',)
    names = ', '.join(robot.name for robot in robots)
    if not robots[0].selected:
        return 'for {}, which you look at'.format(names), 'for ' + names
    return ('for {}: unchecked first, since who is checked obeys you'.format(names),
            'for {}: unchecked first'.format(names),
            'for {} robots'.format(len(robots)) if len(robots) > 1 else 'for ' + names)
