# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What to say about a stop in force: never more than is proved."""
from typing import Iterable, NamedTuple, Sequence, Tuple

from mhri.base.views import PROOF_NOT_CONFIRMED, PROOF_STOPPED, RobotView

IN_FORCE = 'STOP ALL in force'
# More names than this are a number.
_MOST_NAMES = 3


class StopWords(NamedTuple):
    """What the screen says about a stop.

    ``headlines`` say the same in fewer and fewer words, for less room; ``note`` says what follows,
    ``sentence`` is for the bottom line.
    """

    headlines: Tuple[str, ...]
    note: str
    sentence: str


# The robots may not know about the stop yet: nobody has confirmed it.
NOT_TAKEN = StopWords(('STOPPING - not confirmed yet', 'STOPPING'),
                      'waiting for the drive service to say that the stop is in force',
                      'stop all is asked for, and not confirmed yet')
UNANSWERED_STOP = StopWords(
    ('STOP ALL NOT CONFIRMED - the drive service does not answer', 'STOP ALL NOT CONFIRMED',
     'NOT CONFIRMED'), 'they may still move: go and look, or use the switch on the robot',
    'stop all is NOT CONFIRMED: the drive service does not answer')
NOBODY_HEARD = StopWords((IN_FORCE,), 'no command goes out until you release it',
                         'stop all is in force; release it to drive again')


def stop_words(robots: Iterable[RobotView], taken: bool = True, answers: bool = True) -> StopWords:
    """Return how far the stop of the robots is proved.

    A robot that was never heard, and has no proof under way, does not count.

    :param robots: :class:`mhri.base.views.RobotView` of all
    :param taken: whether the gates have said that the stop is in force
    :param answers: whether the gates are heard
    :returns: :class:`StopWords`
    """
    if not taken:
        return NOT_TAKEN if answers else UNANSWERED_STOP
    robots = [robot for robot in robots if robot.proof is not None or robot.age_s is not None]
    if not robots:
        return NOBODY_HEARD
    states = [robot.proof.state if robot.proof else None for robot in robots]
    doubtful = [robot.name for robot, state in zip(robots, states) if state == PROOF_NOT_CONFIRMED]
    if doubtful:
        return _not_confirmed(doubtful)
    pending = [robot.name for robot, state in zip(robots, states) if state != PROOF_STOPPED]
    if pending:
        return _stopping(pending, len(robots))
    return StopWords(('STOPPED - all robots', 'STOPPED'), 'nothing moves until you release it',
                     'everything is stopped; release stop all to drive again')


def _not_confirmed(names: Sequence[str]) -> StopWords:
    """Name the robots not proved to stand still."""
    who = _listed(names)
    shortest = min(who, _counted(names), key=len)
    return StopWords(
        tuple(form.format(name) for form, name in (
            (IN_FORCE + ' \u2013 {} NOT CONFIRMED', who), ('STOP ALL \u2013 {} NOT CONFIRMED', who),
            ('{} NOT CONFIRMED', who), ('{} NOT CONFIRMED', shortest), ('NOT CONFIRMED', ''))),
        '{} may still move: go and look'.format('it' if len(names) == 1 else 'they'),
        'stop all is in force; {} NOT CONFIRMED: go and look'.format(who))


def _stopping(names: Sequence[str], count: int) -> StopWords:
    """Name the robots whose proof is still to come."""
    who = _listed(names)
    return StopWords(
        ('{} \u2013 stopping {}'.format(IN_FORCE, who),
         'STOPPING {} of {} robots'.format(len(names), count), 'STOPPING'),
        'waiting until {} seen to stand still'.format('it is' if len(names) == 1 else 'they are'),
        'stop all is in force; still stopping {}'.format(who))


def _listed(names: Sequence[str]) -> str:
    """Return the names, or how many there are."""
    return ', '.join(names) if len(names) <= _MOST_NAMES else _counted(names)


def _counted(names: Sequence[str]) -> str:
    """Return how many robots there are."""
    return '{} robot{}'.format(len(names), '' if len(names) == 1 else 's')
