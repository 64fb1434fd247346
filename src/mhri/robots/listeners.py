# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Which of a robot's velocity topics to send commands to: the first that the robot listens to.

A mere listener, such as ``rostopic echo`` or ``rosbag record -a``, must change nothing.
"""
import re
from typing import Collection, FrozenSet, List, Optional, Sequence

# Tools that listen to anything; the patterns match the names that rospy and roscpp generate.
_TOOLS = re.compile(r'/(rostopic|record|play|rosbag|rqt|rviz|rosout|mhri)(_|$)')


def guard_node(robot: str) -> str:
    """Return the name of the guard of a robot: it reads velocity topics, and obeys none of them."""
    return '/{}/mhri_guard'.format(robot)


def obeying(robot: str, listeners: Sequence[Collection[str]]) -> List[FrozenSet[str]]:
    """Return the listeners of each topic that count as the robot.

    These are the nodes below the robot's namespace. If none of them listens to anything (the
    robot's driver runs elsewhere), they are all nodes that are not known tools.

    :param robot: its name
    :param listeners: for each topic the caller ids of its subscribers, a set
    """
    own = '/{}/'.format(robot)
    inside = [frozenset(name for name in names if name.startswith(own)) for names in listeners]
    if any(inside):
        return inside
    return [frozenset(name for name in names if not _TOOLS.match(name)) for names in listeners]


def first_obeying(robot: str, listeners: Sequence[Collection[str]]) -> Optional[int]:
    """Return the index of the first topic that the robot listens to, or None.

    :param robot: its name
    :param listeners: for each topic, in order of preference, the caller ids of its subscribers
    """
    return next((index for index, names in enumerate(obeying(robot, listeners)) if names), None)
