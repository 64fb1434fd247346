# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""One robot on its task: when it may drive, what holds it, and everything that ends it.

States and what leads out of them::

    readying  the robot is not heard yet, zeros   all is heard -> joining
    joining   zeros, until the gates say that     it obeys -> under way
              the robot obeys its task
    under way what the task wants, behind the     the task is done, or anything of _END -> ended
              brake
    ended     zeros                               (nothing): nothing resumes by itself
"""
from dataclasses import dataclass, replace
import math
from typing import List, Optional, Tuple

import numpy as np

from mhri.base.battery import FLAT_AT
from mhri.base.limits import Velocity, ZERO
from mhri.driving.gate import HELD, OPERATOR, TASK
from mhri.sensors.brake import (
    braked, CRAWL_MPS, everywhere, Looks, MARGIN_M, REACTION_S, SCAN_OLD_S, seen_speed)
from mhri.tasks.base import (
    BLOCKED, Body, discs, ENDS, FAILED, LOST, RUNNING, Senses, Step, STOPPED, TAKEN_OVER, Task,
    TIMEOUT, turn_to, WAITING, way)
from mhri.tasks.fence import kept_inside

READYING, JOINING, UNDER_WAY, ENDED = 'readying', 'joining', 'under_way', 'ended'
# Odometry or place that is older is lost [s]; what is new has so long to be heard.
OLD_S, READY_S, JOIN_S = 0.5, 5.0, 3.0
BLOCKED_AFTER_S = 5.0
# Longer where it lets another robot pass.
PASSED_AFTER_S = 20.0
# Who goes second stands while the other is within this [m] and this far off its heading [rad].
PASS_M, PASS_RAD = 0.8, 0.8
_STANDS_MPS = 0.02
_HELD_ANEW_S = 1.0
# What lasers do not see when it is near: other robots, which may move by so much in a moment [m].
_MOVES_M = 0.06


@dataclass(frozen=True)
class Facts:
    """What is known of a robot at one instant, beside what it senses.

    ``answers`` is whether the gates are heard, ``known`` whether they know the robot, ``obeys`` and
    ``stands`` what they say of it. Ages [s] are None before anything was heard; ``place_age_s`` is
    that of its place, 0 where the task needs none or it does not grow old, None where it is not
    placed; ``place_text`` says the same in words; ``settling`` that its place was just corrected by
    far, '' where it was not. ``has_laser`` is false for a type with neither laser nor depth camera,
    which has no brake; ``looks`` tells where the one it has looks, ``unplaced`` that nobody says
    where one of several sits.
    ``battery`` is in [0, 1], None where it is not known.
    """

    now_s: float
    stop_all: bool = False
    answers: bool = True
    known: bool = True
    obeys: str = ''
    stands: str = ''
    odometry_age_s: Optional[float] = None
    place_age_s: Optional[float] = 0.0
    place_text: str = ''
    settling: str = ''
    scan_age_s: Optional[float] = None
    has_laser: bool = True
    looks: Looks = everywhere
    unplaced: bool = False
    battery: Optional[float] = None
    senses: Optional[Senses] = None

    @property
    def crawl_mps(self) -> float:
        """How fast it may back away without an eye for it [m/s]."""
        return 0.0 if self.unplaced else CRAWL_MPS


class RobotRun:
    """The run of one task by one robot.

    :param timeout_s: 0 for none
    :param now_s: when it was asked for
    :param placed: the robot has to be placed for it
    """

    def __init__(self, robot: str, task: Optional[Task], body: Body, timeout_s: float,
                 now_s: float, placed: bool = False) -> None:
        self.robot = robot
        self.placed = placed
        self._task = task
        self._body = body
        self._timeout_s = timeout_s
        self._begun_s = self._phase_s = now_s
        self.phase = READYING
        self.state = WAITING
        self.text = 'waits for its sensors'
        self.left_m: Optional[float] = None
        self.said: List[str] = []
        self.ended_s = math.inf
        self._held_since: Optional[float] = None
        self._held_last = 0.0

    @property
    def drives(self) -> bool:
        """Whether the robot shall have the velocities of :meth:`tick`."""
        return True

    def end(self, state: str, text: str, now_s: float) -> None:
        """End it, unless it has ended."""
        if self.phase != ENDED:
            self.phase, self.state, self.text, self.ended_s = ENDED, state, text, now_s

    def tick(self, facts: Facts) -> Velocity:
        """Let time pass; return what the robot shall do now."""
        if self.phase != ENDED:
            end = self._reason(facts)
            if end is not None:
                self.end(*end, now_s=facts.now_s)
        if self.phase == READYING:
            self._get_ready(facts)
        elif self.phase == JOINING:
            self._join(facts)
        elif self.phase == UNDER_WAY:
            return self._drive(facts)
        return ZERO

    def _reason(self, facts: Facts) -> Optional[Tuple[str, str]]:
        """Return (state, sentence) of what ends the task now, None for nothing."""
        if facts.stop_all:
            return STOPPED, 'stop-all is in force: release it, then start the task again'
        if not facts.answers:
            return LOST, 'the drive service does not answer'
        if facts.obeys == OPERATOR:
            return TAKEN_OVER, 'it is checked: the operator drives it'
        if facts.battery is not None and facts.battery <= FLAT_AT:
            return FAILED, 'its battery is at {:.0f} %'.format(100.0 * facts.battery)
        if self._timeout_s and facts.now_s - self._begun_s > self._timeout_s:
            return TIMEOUT, 'not done within {:g} s; it was: {}'.format(self._timeout_s, self.text)
        if self.phase == READYING:
            return self._not_ready(facts)
        return self._lost(facts)

    def _not_ready(self, facts: Facts) -> Optional[Tuple[str, str]]:
        if facts.now_s - self._phase_s <= READY_S:
            return None
        if not facts.known:
            return LOST, 'the drive service does not know it: add it to the list of robots'
        return LOST, self.text

    def _lost(self, facts: Facts) -> Optional[Tuple[str, str]]:
        """Return what is lost of a robot that was there."""
        if not facts.known or facts.stands == HELD or facts.stands == 'not_heard':
            return LOST, 'the drive service does not hear it any more'
        if facts.odometry_age_s is None or facts.odometry_age_s > OLD_S:
            return LOST, 'nothing from its odometry for {:.1f} s'.format(
                facts.odometry_age_s or 0.0)
        if _unplaced(facts):
            return LOST, 'its place is not known any more: ' + facts.place_text
        if self.phase == JOINING and facts.now_s - self._phase_s > JOIN_S:
            return FAILED, 'its task does not reach it: is the enabling pedal pressed?'
        if self.phase == UNDER_WAY and facts.obeys != TASK:
            return LOST, 'its task did not reach it any more (a busy computer, or a released ' \
                'pedal): continue it'
        return None

    def _get_ready(self, facts: Facts) -> None:
        missing = missing_senses(facts)
        if missing:
            self.text = 'waits for ' + missing
            return
        self.phase, self._phase_s = JOINING, facts.now_s
        self.text = 'waits for the drive service to let it drive'

    def _join(self, facts: Facts) -> None:
        if facts.obeys == TASK:
            self.phase, self._phase_s = UNDER_WAY, facts.now_s

    def _drive(self, facts: Facts) -> Velocity:
        """Return what the task wants, as far as the way is free."""
        assert self._task is not None and facts.senses is not None
        robots = discs(facts.senses.pose, facts.senses.others.values(), _MOVES_M)
        met = np.vstack((facts.senses.points, robots))
        senses = replace(facts.senses, points=np.vstack((met, facts.senses.floor)))
        step = self._task.step(senses)
        self.left_m = step.left_m
        self.said += step.said
        if step.state in ENDS:
            self.end(step.state, step.text, facts.now_s)
            return ZERO
        if not all(map(math.isfinite, (step.velocity.linear_mps, step.velocity.angular_rad_s))):
            self.end(FAILED, 'its task asked for a velocity that is no number', facts.now_s)
            return ZERO
        radius_m = self._body.radius_m
        free = braked(step.velocity, met, radius_m, facts.scan_age_s, facts.looks,
                      facts.crawl_mps) \
            if facts.has_laser else braked(step.velocity, robots, radius_m, 0.0)
        on_floor = braked(free, senses.floor, radius_m, 0.0)
        velocity = kept_inside(on_floor, senses.pose, senses.fence, self._body)
        held = facts.settling or self._held(step, free, facts) \
            or _stands_at('the end of the free floor on the map', free, on_floor) \
            or _stands_at('the fence', on_floor, velocity)
        self._mark(held, facts.now_s)
        self.state, self.text = (WAITING, held) if held else (
            RUNNING, step.text + self._unseen(step.velocity, free, facts))
        patience_s = PASSED_AFTER_S if held.startswith(_LETS_PASS) else BLOCKED_AFTER_S
        if held and self._held_since is not None \
                and facts.now_s - self._held_since > patience_s:
            self.end(BLOCKED, 'for {:g} s: {}'.format(patience_s, held), facts.now_s)
        if self.phase == ENDED or facts.settling or held.startswith(_LETS_PASS):
            return ZERO
        return velocity

    def _held(self, step: Step, velocity: Velocity, facts: Facts) -> str:
        """Return what holds the robot, in words; '' for nothing."""
        assert self._task is not None and facts.senses is not None
        if step.state == WAITING:
            return step.text
        wants = abs(step.velocity.linear_mps) > _STANDS_MPS
        if not wants:
            return ''
        first = _to_let_pass(facts.senses, self._task.pass_by) \
            if step.velocity.linear_mps > 0.0 else ''
        if first:
            return _LETS_PASS + first
        if abs(velocity.linear_mps) > _STANDS_MPS:
            return ''
        blind = facts.has_laser and (facts.scan_age_s is None or facts.scan_age_s > SCAN_OLD_S)
        if facts.unplaced and (blind or self._unseen(step.velocity, velocity, facts)):
            return 'the place of one of its lasers is unknown'
        if blind:
            return 'its laser or depth camera has said nothing for {:.1f} s'.format(
                facts.scan_age_s or 0.0)
        return 'it does not see where it would go' \
            if self._unseen(step.velocity, velocity, facts) else 'something is in its way'

    def _unseen(self, wanted: Velocity, free: Velocity, facts: Facts) -> str:
        """Return that the robot is slow for want of an eye on its way; '' where it is not."""
        if not facts.has_laser or facts.scan_age_s is None or wanted.linear_mps == 0.0:
            return ''
        seen = seen_speed(wanted, self._body.radius_m + MARGIN_M, REACTION_S + facts.scan_age_s,
                          facts.looks, facts.crawl_mps)
        slow = abs(seen) < abs(wanted.linear_mps) and abs(free.linear_mps) >= abs(seen) - 1e-3
        return ', slowly: it does not see that way' if slow else ''

    def _mark(self, held: str, now_s: float) -> None:
        """Note since when it is held; moved for a moment it is not."""
        if held:
            self._held_since = now_s if self._held_since is None else self._held_since
            self._held_last = now_s
        elif now_s - self._held_last > _HELD_ANEW_S:
            self._held_since = None


_LETS_PASS = 'it lets pass '


def _stands_at(what: str, free: Velocity, velocity: Velocity) -> str:
    """Return what holds it of a velocity that was free, in words; '' where nothing does."""
    held = abs(velocity.linear_mps) <= _STANDS_MPS < abs(free.linear_mps)
    return 'it is at ' + what if held else ''


def _unplaced(facts: Facts) -> bool:
    return facts.place_age_s is None or facts.place_age_s > OLD_S


def missing_senses(facts: Facts) -> str:
    """Return what has not been heard yet, in words; '' where all is there."""
    for missing, words in (
            (not facts.known, 'the drive service to know it'),
            (facts.odometry_age_s is None or facts.odometry_age_s > OLD_S, 'its odometry'),
            (_unplaced(facts), 'its place: ' + facts.place_text),
            (facts.has_laser and (facts.scan_age_s is None or facts.scan_age_s > SCAN_OLD_S),
             'its laser or depth camera'),
            (facts.senses is None, 'its sensors')):
        if missing:
            return words
    return ''


def _to_let_pass(senses: Senses, pass_by: Tuple[str, ...]) -> str:
    """Return the robot that is in front and goes first, '' where there is none."""
    for name, other in senses.others.items():
        place = other.pose.x_m, other.pose.y_m
        if other.goes_first and name not in pass_by and way(senses.pose, *place) < PASS_M \
                and abs(turn_to(senses.pose, *place)) < PASS_RAD:
            return name
    return ''
