# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Robot names: one segment of a ROS name, so that a robot is one namespace."""
import re
from typing import List, Optional, Sequence

_LEGAL = re.compile(r'[A-Za-z][A-Za-z0-9_]*\Z')
_GLOBAL = re.compile(r'(/[A-Za-z][A-Za-z0-9_]*)+\Z')
MAX_LENGTH = 64
# Maximum number of names read from a list, since any program may write one.
MAX_NAMES = 1000
#: parameters: the robots in the list of a screen, {robot: its number}, and the robots that were
#: driven and are still in the list
ROBOTS, NUMBERS, DRIVEN = '/mhri/robots', '/mhri/robot_numbers', '/mux/robots'
# Namespaces of mhri itself.
RESERVED = frozenset(('mhri', 'mhri_session', 'mhri_tasks', 'mux', 'mux_in', 'panel', 'panel_in',
                      'robot_controller'))


def listed(names: Sequence[str], most: int = 2) -> str:
    """Return names for a narrow place: "bot1, bot2 (+3)", '' for none.

    :param most: number of names that are written, the others are counted
    """
    more = len(names) - most
    return ', '.join(names[:most]) + (' (+{})'.format(more) if more > 0 else '')


def name_problem(name: str) -> Optional[str]:
    """Return why a text cannot be a robot's name, or None if it can.

    A robot is a namespace of one segment: a letter, then letters, digits and ``_``
    (http://wiki.ros.org/Names). A leading slash is
    refused here: strip it with :func:`tidy_name` first.
    """
    if not name:
        return 'type the name of a robot first'
    if len(name) > MAX_LENGTH:
        return 'a name has at most {} characters'.format(MAX_LENGTH)
    if '/' in name:
        return 'a robot is one namespace: leave out the "/"'
    if not (name[0].isascii() and name[0].isalpha()):
        return 'a name begins with a letter from a to z'
    if not _LEGAL.match(name):
        odd = next(char for char in name if not re.match(r'[A-Za-z0-9_]', char))
        shown = 'a space' if odd == ' ' else '"{}"'.format(odd) if odd.isprintable() else \
            'an invisible character'
        return 'use letters, digits and _ only: {} is not allowed'.format(shown)
    if name in RESERVED:
        return '"{}" is a name of mhri itself: choose another one'.format(name)
    return None


def names_in(value: object) -> List[str]:
    """Return the valid names of robots in the value of a parameter or message, of any type."""
    return [name for name in value[:MAX_NAMES] if isinstance(name, str)
            and name_problem(name) is None] if isinstance(value, (list, tuple)) else []


def is_global_name(name: str) -> bool:
    """Return whether a text is an absolute ROS name, e.g. ``/mux_in/joy``."""
    return bool(_GLOBAL.match(name))


def is_base_name(name: str) -> bool:
    """Return whether a text is one legal segment of a ROS name."""
    return bool(_LEGAL.match(name))


def tidy_name(text: str) -> str:
    """Return a typed name without surrounding spaces and slashes."""
    return text.strip().strip('/')


def topic_of(robot: str, topic: str) -> str:
    """Return the absolute name of a topic of a robot's template.

    As in ROS (http://wiki.ros.org/Names), a topic is relative to the robot's namespace unless it
    begins with a slash. Robots without their own namespace use absolute topics.
    """
    return topic if topic.startswith('/') else '/{}/{}'.format(robot, topic)
