# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A running drill on the screen: one line, and events."""
from dataclasses import dataclass
from typing import List, Optional, Tuple

WAITING, RUNNING, ENDED = range(3)
# Timeout of the referee, which publishes once a second, with a margin for busy computers [s].
SILENT_S = 10.0
# Time for which the end of a drill is shown [s]; the event list keeps it.
STAYS_S = 60.0
# At lower ages, a replay has jumped back to before this state [s].
_EARLY_S = -1.0


def minutes_text(seconds: float) -> str:
    """Return a duration as minutes and seconds, e.g. "1:44"."""
    return '{}:{:02d}'.format(*divmod(max(0, int(seconds)), 60))


@dataclass(frozen=True)
class DrillView:
    """The referee's newest state, of the time of day ``at`` [s]; see ``DrillState.msg``."""

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
        """The number of targets found, e.g. "3 of 8 found"."""
        return '{} of {} found'.format(len(self.found), len(self.found) + len(self.left))

    @property
    def end(self) -> str:
        """The outcome, e.g. "all 8 found after 1:44" or "time is up after 8:00, 3 of 8 found"."""
        after = ' after ' + minutes_text(self.elapsed_s)
        if not self.left:
            return 'all {} found{}'.format(len(self.found), after) if self.found[1:] \
                else 'found' + after
        return '{}{}, {}'.format(self.ended, after, self.count)

    def silent(self, now: float) -> bool:
        """Return whether the referee is silent; ``now`` is the time of day [s]."""
        return self.phase != ENDED and now - self.at > SILENT_S


def drill_texts(drill: DrillView, now: float) -> Tuple[str, ...]:
    """Return the screen's texts on a drill, longest first; () long after its end.

    :param now: the time of day [s]
    """
    age_s, name = now - drill.at, 'Drill {}: '.format(drill.title)
    if not _EARLY_S < age_s < STAYS_S:
        return ()
    if drill.phase == ENDED:
        end = name + drill.end
        return (end + '; page: ' + drill.page, end + '; page: see Events', end) if drill.page \
            else (end,)
    if drill.silent(now):
        return (name + 'its referee has stopped', name + 'stopped')
    if drill.phase == WAITING:
        return (name + drill.about + ' The clock starts when you drive.', name + drill.about,
                name + drill.about.partition('. ')[0], name + 'the clock starts when you drive',
                name + 'drive to start')
    time = minutes_text(drill.limit_s - drill.elapsed_s) + ' left'
    texts = ['{}{}, {}'.format(name, drill.count, time), '{}, {}'.format(drill.count, time)]
    if drill.in_order and drill.left:
        texts.insert(0, '{}, next: {}'.format(texts[0], drill.left[0]))
    return tuple(texts)


def drill_changes(old: Optional[DrillView], new: DrillView) -> List[Tuple[str, str]]:
    """Return the changes between two states of the referee, as (kind of event, sentence)."""
    name = 'drill {}: '.format(new.title)
    if old is None or new.title != old.title or new.phase < old.phase:
        # A new run, or this screen missed the beginning of the current one.
        return [('drill.waits', name + new.about)] if new.phase == WAITING else []
    changes: List[Tuple[str, str]] = []
    if old.phase == WAITING != new.phase:
        changes.append(('drill.begun', name + 'begun'))
    changes += [('drill.found', '{}{} found'.format(name, target))
                for target in new.found[len(old.found):]]
    if old.phase != ENDED == new.phase:
        changes.append(('drill.ended', name + new.end + ('; page: ' + new.page) * bool(new.page)))
    return changes
