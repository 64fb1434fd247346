# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What the gates say of a robot, in codes and names, as words for the screen: one table."""
from typing import Dict, Sequence

# Why a robot stands, by the codes of mhri/RobotGate; '' where other words say it.
STANDS_WORDS: Dict[str, str] = {
    'stopped': '',
    'joining': 'centre the stick to drive',
    'not_heard': 'kept standing: the drive service does not hear it',
    'guard_version': 'kept standing: its guard is of another version; send it this one with '
                     'turtlebot_deploy.sh',
    'unreachable': 'kept standing: its own multiplexer writes its velocity; set its parameter '
                   'mhri/command to an input of that',
    'two_robots': 'kept standing: two computers are this robot; end one of them',
}
NO_WITNESS = 'its odometry does not follow commands'
LIMIT_RAISED = 'its speed limit was raised: uncheck and check it to use that'
_MAX_NAMES = 3


def stands_words(code: str) -> str:
    """Return why a robot stands, in words; an unknown code as it is."""
    return STANDS_WORDS.get(code, code)


def also_words(nodes: Sequence[str]) -> str:
    """Return who else commands a robot, in words; '' for nobody.

    :param nodes: their caller ids
    """
    if not nodes:
        return ''
    more = len(nodes) - _MAX_NAMES
    return 'also commanded by {}{}'.format(
        ', '.join(nodes[:_MAX_NAMES]), ' and {} more'.format(more) if more > 0 else '')
