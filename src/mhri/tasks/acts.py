# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The accessories that a robot uses on its way: the parameter ``act`` of tasks."""
from typing import Dict, Sequence, Tuple

from mhri.base.accessories import Accessory
from mhri.tasks.base import Act, Field, TEXT

ACT = Field('act', '', 'e.g. lamp on, or 2 lamp on, 3 lamp off: accessories to use at each place, '
            'or at the second and third', '', kind=TEXT)
MAX_ACTS = 50


def read_acts(text: str, places: int, accessories: Sequence[Accessory]
              ) -> Dict[int, Tuple[Act, ...]]:
    """Return {index of a place: what to use there}.

    :param text: of :data:`ACT`: parts "[number from 1] key [choice]" after commas
    :param places: number of places, from 1
    :param accessories: those of the robot
    :raises ValueError: with a sentence about the part that is wrong
    """
    found: Dict[int, Tuple[Act, ...]] = {}
    parts = [part.split() for part in text.split(',')] if text.strip() else []
    if len(parts) > MAX_ACTS:
        raise ValueError('act: at most {} parts'.format(MAX_ACTS))
    known = {accessory.key: accessory for accessory in accessories}
    for words in parts:
        at, words = (words[0], words[1:]) if words and words[0].isdigit() else ('', words)
        if not 1 <= len(words) <= 2 or at and not 1 <= int(at) <= places:
            raise ValueError('act: expected "lamp on", or "2 lamp on" with a number from 1 to {}, '
                             'got {!r}'.format(places, ' '.join([at] + words).strip()[:60]))
        act = Act(words[0], words[1] if len(words) > 1 else '')
        if act.key not in known:
            raise ValueError('act: it has no accessory {!r}{}'.format(
                act.key[:40], ', but ' + ', '.join(known) if known else ''))
        problem = known[act.key].problem(act.choice, ())
        if problem:
            raise ValueError('act: ' + problem)
        for place in [int(at) - 1] if at else range(places):
            found[place] = found.get(place, ()) + (act,)
    return found
