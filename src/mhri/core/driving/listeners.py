# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Which of a robot's velocity topics its commands go to: the first that the robot listens to.

Somebody who merely listens, a ``rostopic echo`` or a ``rosbag record -a``, must change nothing.
"""
import re
from typing import Collection, FrozenSet, List, Optional, Sequence

# Tools that listen to whatever they are told to; their names are made up as rospy and roscpp do it.
_TOOLS = re.compile(r'/(rostopic|record|play|rosbag|rqt|rviz|rosout|mhri)(_|$)')


def obeying(robot: str, listeners: Sequence[Collection[str]]) -> List[FrozenSet[str]]:
    """Return for each topic the listeners that count as the robot.

    The nodes below the robot's namespace; where none of them listens to anything (a robot whose
    driver runs elsewhere), everybody who is not known as a tool.

    :param robot: its name
    :param listeners: for each topic the set of caller ids that listen to it
    """
    own = '/{}/'.format(robot)
    inside = [frozenset(name for name in names if name.startswith(own)) for names in listeners]
    if any(inside):
        return inside
    return [frozenset(name for name in names if not _TOOLS.match(name)) for names in listeners]


def first_obeying(robot: str, listeners: Sequence[Collection[str]]) -> Optional[int]:
    """Return the index of the first topic that the robot listens to, or None.

    :param robot: its name
    :param listeners: for each topic, in order of preference, the caller ids that listen to it
    """
    return next((index for index, names in enumerate(obeying(robot, listeners)) if names), None)
