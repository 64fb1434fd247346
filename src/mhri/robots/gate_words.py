# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What the gates say of a robot, in codes and names, as words for the screen: one table."""
from typing import Dict, Sequence

# Why a robot stands, by the codes of mhri/RobotGate; '' where other words say it. A narrow row has
# room for what is before the colon.
STANDS_WORDS: Dict[str, str] = {
    'stopped': '',
    'joining': 'centre the stick to drive',
    'not_heard': 'not heard: the drive service keeps it standing',
    'guard_version': 'guard version: its guard has another one, so it is kept standing; send it '
                     'this one with turtlebot_deploy.sh',
    'unreachable': 'own mux: that writes its velocity, so it is kept standing; set its parameter '
                   'mhri/command to an input of that',
    'two_robots': 'two robots: two computers are this one, so it is kept standing; end one of '
                  'them',
}
NO_WITNESS = 'its odometry does not follow commands'
ODOMETRY_STUCK = 'odometry stuck: it does not follow commands'
LIMIT_RAISED = 'limit raised: deselect and select it to use its new speed limit'
_ALSO = 'also commanded by {}'
NOT_ALONE = 'not alone: {}'
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
    return _ALSO.format(', '.join(nodes[:_MAX_NAMES]) + (
        ' and {} more'.format(more) if more > 0 else ''))
