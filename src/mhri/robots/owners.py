# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Who is who on a link to a robot, by name, and what a screen says of who is in control.

A name is ``host:lab`` (may drive), ``watch:lab`` (may only watch), ``robot:bot1`` or
``watched:bot1`` (nobody drives it), with a number where others were withdrawn (``robot:bot1.2``),
or a mark of the computer where nothing else tells two of one name apart
(``host:lab.x0c5e21a9``).
"""
import re
from typing import Tuple

DRIVES, WATCHES, ROBOT, WATCHED = 'host', 'watch', 'robot', 'watched'
ROUTER = 'router'
_NAME = re.compile(r'(host|watch|robot|watched|router):([A-Za-z0-9_-]{1,64})'
                   r'(\.[0-9]{1,6}|\.x[0-9a-f]{8})?\Z')
# What the button of a robot in another host's control says at each of the two steps.
ASK_FOR, TAKE_IT = 'Ask for control', 'Take control'


def split(owner: str) -> Tuple[str, str]:
    """Return (role, name) of a name in a certificate, ('', '') if it is none."""
    found = _NAME.match(owner)
    return (found.group(1), found.group(2)) if found else ('', '')


def called(owner: str, *beside: str) -> str:
    """Return what people call it: "lab" of ``host:lab.2``.

    :param beside: who else is talked about: where another one is called the same, the mark is told,
        too, such as "lab (0c5e)"
    """
    name = split(owner)[1]
    if not name:
        return owner
    alike = any(other != owner and split(other)[1] == name for other in beside)
    mark = owner.partition('.x')[2][:4]
    return '{} ({})'.format(name, mark) if alike and mark else name


def is_host(owner: str) -> bool:
    """Tell whether a name is that of an operator's computer."""
    return split(owner)[0] in (DRIVES, WATCHES)


def may_drive(owner: str) -> bool:
    """Tell whether a computer of this name may command a robot."""
    return split(owner)[0] == DRIVES


def shown(own: str, may: bool, holder: str, asking: str) -> Tuple[str, str]:
    """Return (what a screen says of control, what its button asks for), '' for nothing.

    :param own: the host of that screen
    :param may: it could have control
    """
    if not may:
        return 'this computer may only watch', ''
    if holder in ('', own):
        return ('{} asks for control'.format(called(asking, own)) if asking else ''), ''
    if asking == own:
        return '{} is told that you ask'.format(called(holder, own)), TAKE_IT
    return '{} has control'.format(called(holder, own)), ASK_FOR
