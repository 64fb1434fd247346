# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Chooses the velocity topic of a robot for commands: the first one that the robot subscribes.

Other subscribers, such as ``rostopic echo`` or ``rosbag record -a``, are ignored. Also tells other
commanders of the robot from its nodes that pass commands on.
"""
import re
from typing import Collection, FrozenSet, List, Mapping, Optional, Sequence, Set, Tuple

# Tools that may subscribe any topic, by the names that rospy and roscpp generate.
_TOOLS = re.compile(r'/(rostopic|record|play|rosbag|rqt|rviz|rosout|mhri)(_|$)')


def guard_node(robot: str) -> str:
    """Return the name of the guard of a robot, which subscribes velocity topics without obeying."""
    return '/{}/mhri_guard'.format(robot)


def obeying(robot: str, listeners: Sequence[Collection[str]],
            behind: Sequence[bool] = ()) -> List[FrozenSet[str]]:
    """Return the listeners of each topic that count as the robot.

    These are the nodes below the robot's namespace. If none of them subscribes any of the topics
    (the robot's driver runs elsewhere), they are all nodes that are not known tools.

    :param robot: its name
    :param listeners: for each topic the caller ids of its subscribers, a set
    :param behind: for each topic, whether it lies behind a multiplexer, which may run elsewhere
        though the base does not: those topics count by themselves. Default: none does
    """
    own, behind = '/{}/'.format(robot), behind or (False,) * len(listeners)
    inside = [frozenset(name for name in names if name.startswith(own)) for names in listeners]
    has_own = {is_behind for names, is_behind in zip(inside, behind) if names}
    return [own_names if is_behind in has_own else frozenset(
        name for name in names if not _TOOLS.match(name))
        for own_names, names, is_behind in zip(inside, listeners, behind)]


def first_obeying(robot: str, listeners: Sequence[Collection[str]]) -> Optional[int]:
    """Return the index of the first topic that the robot subscribes, or None.

    :param robot: its name
    :param listeners: for each topic, in order of preference, the caller ids of its subscribers
    """
    return next((index for index, names in enumerate(obeying(robot, listeners)) if names), None)


def other_commanders(found: Collection[Tuple[str, str]], listeners: Mapping[str, Collection[str]],
                     apart: Collection[str]) -> Set[Tuple[str, str]]:
    """Return the publishers of a robot's velocity that do not just pass on our commands.

    A node passes them on if it subscribes one of our topics and publishes another one of them, as a
    velocity smoother does.

    :param found: (caller id, topic) of each publisher
    :param listeners: {topic of our commands: the caller ids of its subscribers}
    :param apart: caller ids that are no other commanders: we and the robot's guard
    """
    def passes_on(name: str, topic: str) -> bool:
        return topic in listeners and any(
            name in names for other, names in listeners.items() if other != topic)
    return {(name, topic) for name, topic in found
            if name not in apart and not passes_on(name, topic)}
