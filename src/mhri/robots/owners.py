# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The names of the ends of a link, and the texts of a screen about control.

A name is ``host:lab`` (may drive), ``watch:lab`` (may only watch), ``robot:bot1`` or
``watched:bot1`` (nobody drives it), with a number if earlier keys were withdrawn
(``robot:bot1.2``).
"""
import re
from typing import Tuple

DRIVES, WATCHES, ROBOT, WATCHED = 'host', 'watch', 'robot', 'watched'
ROUTER = 'router'
_NAME = re.compile(r'(host|watch|robot|watched|router):([A-Za-z0-9_-]{1,64})(\.[0-9]{1,6})?\Z')
# The button for a robot that another host controls, at each of the two steps.
ASK_FOR, TAKE_IT = 'Ask for control', 'Take control'


def split(owner: str) -> Tuple[str, str]:
    """Return (role, name) of a name in a certificate, ('', '') if it is invalid."""
    found = _NAME.match(owner)
    return (found.group(1), found.group(2)) if found else ('', '')


def called(owner: str) -> str:
    """Return the short name for people: "lab" of ``host:lab.2``."""
    return split(owner)[1] or owner


def is_host(owner: str) -> bool:
    """Return whether a name is that of an operator's computer."""
    return split(owner)[0] in (DRIVES, WATCHES)


def may_drive(owner: str) -> bool:
    """Return whether a computer of this name may command a robot."""
    return split(owner)[0] == DRIVES


def shown(own: str, may: bool, holder: str, asking: str) -> Tuple[str, str]:
    """Return (note about control, label of its button) for a screen, '' for none.

    :param own: the host of that screen
    :param may: whether it is allowed to take control
    """
    if not may:
        return 'this computer may only watch', ''
    if holder in ('', own):
        return ('{} asks for control'.format(called(asking)) if asking else ''), ''
    if asking == own:
        return '{} has been told that you ask'.format(called(holder)), TAKE_IT
    return '{} has control'.format(called(holder)), ASK_FOR
