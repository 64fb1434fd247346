# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Screen texts on a stop in force: they claim only what is proved."""
from typing import Iterable, NamedTuple, Sequence, Tuple

from mhri.base.reasons import DRIVE_SILENT, Reason
from mhri.base.views import (
    PROOF_NOT_CONFIRMED, PROOF_STOPPED, PROOF_WAITING, ProofView, RobotView)

IN_FORCE = 'STOP ALL in force'
# Above this many names, only their number is shown.
_MAX_NAMES = 3


class StopWords(NamedTuple):
    """The texts of the screen on a stop.

    ``headlines`` are versions of the same text, shorter and shorter; ``note`` is the consequence,
    ``sentence`` is for the bottom line, ``shorter`` are versions of the note for less space.
    """

    headlines: Tuple[str, ...]
    note: str
    sentence: str
    shorter: Tuple[str, ...] = ()


# The robots may not have received the stop yet: it is not confirmed.
NOT_TAKEN = StopWords(('STOPPING - not confirmed yet', 'STOPPING'),
                      'waiting for the drive service to say that the stop is in force',
                      'stop all is asked for, and not confirmed yet',
                      ('waiting for the drive service', 'no answer yet'))
UNANSWERED_STOP = StopWords(
    ('STOP ALL NOT CONFIRMED - the drive service does not answer', 'STOP ALL NOT CONFIRMED',
     'NOT CONFIRMED'), 'they may still move: go and look, or use the switch on the robot',
    'stop all is NOT CONFIRMED: the drive service does not answer',
    ('they may still move: go and look', 'go and look'))
NOBODY_HEARD = StopWords((IN_FORCE,), 'no command goes out until you release it',
                         'stop all is in force; release it to drive again',
                         ('no command until you release it', 'no command goes out'))


def requested_proof(answers: bool) -> ProofView:
    """Return the proof of a single robot's stop that the drive has not confirmed yet.

    :param answers: whether messages of the drive arrive
    """
    return ProofView(PROOF_WAITING, 'stopping') if answers else ProofView(
        PROOF_NOT_CONFIRMED, 'NOT CONFIRMED: ' + Reason(DRIVE_SILENT).what)


def stop_words(robots: Iterable[RobotView], taken: bool = True, answers: bool = True) -> StopWords:
    """Describe how far the stop of the robots is proved.

    A robot that was never heard, and has no proof in progress, does not count.

    :param robots: :class:`mhri.base.views.RobotView` of all
    :param taken: whether the drive has confirmed the stop
    :param answers: whether messages of the drive arrive
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
                     'everything is stopped; release stop all to drive again',
                     ('nothing moves until released', 'nothing moves'))


def _not_confirmed(names: Sequence[str]) -> StopWords:
    """Return the texts for robots not proved to stand still."""
    who = _listed(names)
    shortest = min(who, _counted(names), key=len)
    return StopWords(
        tuple(form.format(name) for form, name in (
            (IN_FORCE + ' \u2013 {} NOT CONFIRMED', who), ('STOP ALL \u2013 {} NOT CONFIRMED', who),
            ('{} NOT CONFIRMED', who), ('{} NOT CONFIRMED', shortest), ('NOT CONFIRMED', ''))),
        '{} may still move: go and look'.format('it' if len(names) == 1 else 'they'),
        'stop all is in force; {} NOT CONFIRMED: go and look'.format(who),
        ('may still move: go and look', 'go and look'))


def _stopping(names: Sequence[str], count: int) -> StopWords:
    """Return the texts for robots whose proof is pending."""
    who = _listed(names)
    return StopWords(
        ('{} \u2013 stopping {}'.format(IN_FORCE, who),
         'STOPPING {} of {} robots'.format(len(names), count), 'STOPPING'),
        'waiting until {} seen to stand still'.format('it is' if len(names) == 1 else 'they are'),
        'stop all is in force; still stopping {}'.format(who), ('not seen to stand yet',))


def _listed(names: Sequence[str]) -> str:
    """Return the names, or their number if there are many."""
    return ', '.join(names) if len(names) <= _MAX_NAMES else _counted(names)


def _counted(names: Sequence[str]) -> str:
    """Return the number of robots as text."""
    return '{} robot{}'.format(len(names), '' if len(names) == 1 else 's')
