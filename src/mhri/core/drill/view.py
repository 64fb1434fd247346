# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A running drill as the operator reads it: one line on the screen, and events."""
from dataclasses import dataclass
from typing import List, Optional, Tuple

WAITING, RUNNING, ENDED = range(3)
# The referee says once a second how it goes; a computer that is busy may be late [s].
SILENT_S = 10.0
# What has ended stays on the screen for so long [s]; the event list keeps it.
STAYS_S = 60.0
# A recording has gone back to before this was said [s].
_EARLY_S = -1.0


@dataclass(frozen=True)
class DrillView:
    """What the referee said last, ``at`` a time of day [s]; see ``DrillState.msg``."""

    at: float
    title: str
    about: str
    phase: int
    elapsed_s: float
    limit_s: float
    found: Tuple[str, ...]
    left: Tuple[str, ...]
    in_order: bool = False
    ended: str = ''
    page: str = ''

    @property
    def count(self) -> str:
        """How many are found, e.g. "3 of 8 found"."""
        return '{} of {} found'.format(len(self.found), len(self.found) + len(self.left))


def minutes_text(seconds: float) -> str:
    """Return a duration as minutes and seconds, e.g. "1:44"."""
    return '{}:{:02d}'.format(*divmod(max(0, int(seconds)), 60))


def drill_texts(drill: Optional[DrillView], now: float) -> Tuple[str, ...]:
    """Return what the screen says of a drill, the longest first; nothing where there is none.

    :param now: the time of day [s]
    """
    if drill is None:
        return ()
    age_s, name = now - drill.at, 'Drill {}: '.format(drill.title)
    if not _EARLY_S < age_s < STAYS_S:
        return ()
    if drill.phase == ENDED:
        end = '{}{} after {}, {}'.format(name, drill.ended, minutes_text(drill.elapsed_s),
                                         drill.count)
        return (end + '; result in ' + drill.page, end) if drill.page else (end,)
    if age_s > SILENT_S:
        return (name + 'its referee has stopped', name + 'stopped')
    if drill.phase == WAITING:
        begins = 'the clock starts when you drive'
        return ('{}{} {}{}.'.format(name, drill.about, begins[0].upper(), begins[1:]),
                name + begins, name + 'drive to start')
    time = minutes_text(drill.limit_s - drill.elapsed_s) + ' left'
    texts = ['{}{}, {}'.format(name, drill.count, time), '{}, {}'.format(drill.count, time)]
    if drill.in_order and drill.left:
        texts.insert(0, '{}, next: {}'.format(texts[0], drill.left[0]))
    return tuple(texts)


def drill_changes(old: Optional[DrillView], new: DrillView) -> List[Tuple[str, str]]:
    """Return what has happened between two words of the referee, as (kind of event, sentence)."""
    if old is None or new.title != old.title or new.phase < old.phase:
        # Another run, whose beginning is to come; or nobody looked when this one began.
        return []
    name, told = 'drill {}: '.format(new.title), []
    if old.phase == WAITING != new.phase:
        told.append(('drill.begun', name + 'begun'))
    told += [('drill.found', '{}{} found'.format(name, target))
             for target in new.found[len(old.found):]]
    if old.phase != ENDED == new.phase:
        told.append(('drill.ended', '{}{} after {}, {}{}'.format(
            name, new.ended, minutes_text(new.elapsed_s), new.count,
            '; result in ' + new.page if new.page else '')))
    return told
