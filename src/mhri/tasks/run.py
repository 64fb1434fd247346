# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The run of one robot on its task: its phases, and the reasons to hold or end it.

States and transitions::

    readying  nothing; zeros while the robot      all data received, and it obeys a task or had
              still obeys its previous task       no velocity for LEFT_OUT_S -> joining
    joining   zeros                               the mux reports that it obeys its task
                                                  -> under way
    under way the velocity of the task, limited   the task is done -> ended
              by brake, map and fence
    ended     zeros                               none: no task resumes by itself

The first three phases also end for a reason of :meth:`RobotRun._reason`.
"""
from dataclasses import dataclass, replace
import math
from typing import List, Optional, Tuple

import numpy as np

from mhri.base import reasons
from mhri.base.battery import FLAT_AT
from mhri.base.limits import Velocity, ZERO
from mhri.base.reasons import Reason
from mhri.driving.robot_rule import OPERATOR, TASK
from mhri.sensors.brake import (
    braked, CRAWL_MPS, Looks, MARGIN_M, REACTION_S, SCAN_OLD_S, seen_velocity)
from mhri.tasks.base import (
    Act, BLOCKED, Body, discs, ENDS, FAILED, LOST, RUNNING, Senses, Step, STOPPED, TAKEN_OVER, Task,
    TIMEOUT, turn_to, WAITING, way)
from mhri.tasks.fence import kept_inside

READYING, JOINING, UNDER_WAY, ENDED = 'readying', 'joining', 'under_way', 'ended'
# Maximum age of odometry and place [s]; time for the first data to arrive.
OLD_S, READY_S, JOIN_S = 0.5, 5.0, 3.0
# After a stop or a change of control the mux accepts a task for a robot only after nothing was
# published for that robot for this time [s].
LEFT_OUT_S = 0.4
BLOCKED_AFTER_S = 5.0
# Longer while it gives way to another robot.
PASSED_AFTER_S = 20.0
# A robot gives way while the other is within this distance [m] and this bearing [rad].
PASS_M, PASS_RAD = 0.8, 0.8
_STANDS_MPS = 0.02
_HELD_ANEW_S = 1.0
# Margin around other robots: they move, and lasers may miss them when near [m].
_MOVES_M = 0.06


@dataclass(frozen=True)
class Facts:
    """The state of a robot at one instant, in addition to its :class:`Senses`.

    ``answers`` is whether the mux answers, ``known`` whether it has the robot, ``obeys`` and
    ``stands`` what it reports about it. Ages [s] are None before the first data, ``odometry_note``
    is what is wrong with the odometry, '' if nothing; ``place_age_s`` is that of its place, 0 if
    the task needs none or it does not age, None if it is not placed;
    ``place_text`` describes it; ``settling`` is a sentence if its place was just corrected by a
    large distance, else ''. ``has_laser`` is false for types without laser and depth camera, which
    have no brake; ``looks`` is the field of view of that sensor, ``unplaced`` whether the position
    of one of several is unknown. ``battery`` is in [0, 1], None if unknown.
    """

    now_s: float
    stop_all: bool = False
    answers: bool = True
    known: bool = True
    obeys: str = ''
    stands: str = ''
    odometry_age_s: Optional[float] = None
    odometry_note: str = ''
    place_age_s: Optional[float] = 0.0
    place_text: str = ''
    settling: str = ''
    scan_age_s: Optional[float] = None
    has_laser: bool = True
    looks: Looks = None
    unplaced: bool = False
    battery: Optional[float] = None
    senses: Optional[Senses] = None

    @property
    def crawl_mps(self) -> float:
        """Maximum speed towards places outside every field of view [m/s]."""
        return 0.0 if self.unplaced else CRAWL_MPS


class RobotRun:
    """The run of one task by one robot.

    :param timeout_s: time limit [s], 0: without
    :param now_s: time of the request
    :param placed: whether the robot has to be placed for it
    """

    def __init__(self, robot: str, task: Optional[Task], body: Body, timeout_s: float,
                 now_s: float, placed: bool = False) -> None:
        self.robot = robot
        self.placed = placed
        self._task = task
        self._body = body
        self._timeout_s = timeout_s
        self._begun_s = self._phase_s = now_s
        # Time of the last velocity for the robot, at first that of the request: the previous task
        # may just have ended.
        self._named, self._left_out_s = False, now_s
        self.phase = READYING
        self.state = WAITING
        self.text = 'waits for its sensors'
        self.left_m: Optional[float] = None
        self.said: List[str] = []
        #: accessories to use now; who uses them clears them
        self.acts: List[Act] = []
        self.ended_s = math.inf
        self._held_since: Optional[float] = None
        self._held_last = 0.0

    @property
    def drives(self) -> bool:
        """Whether the velocities of :meth:`tick` apply to the robot."""
        return self.phase != READYING or self._named

    def end(self, state: str, text: str, now_s: float) -> None:
        """End it, unless it has ended."""
        if self.phase != ENDED:
            self.phase, self.state, self.text, self.ended_s = ENDED, state, text, now_s

    def tick(self, facts: Facts) -> Velocity:
        """Return the velocity of the robot for this step."""
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
        """Return (state, sentence) if something ends the task now, else None."""
        if facts.stop_all or facts.stands == reasons.STOPPED_ALONE:
            return STOPPED, Reason(reasons.STOPPED if facts.stop_all else facts.stands).sentence
        if not facts.answers:
            return LOST, Reason(reasons.DRIVE_SILENT).what
        if facts.obeys == OPERATOR:
            return TAKEN_OVER, 'it is selected: the operator drives it'
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
        """Return (state, sentence) if data of the robot or its link to the mux are lost."""
        if not facts.known or facts.stands == reasons.NOT_HEARD:
            return LOST, 'the drive service no longer hears it'
        if facts.odometry_age_s is None or facts.odometry_age_s > OLD_S:
            return LOST, facts.odometry_note or 'nothing from its odometry for {:.1f} s'.format(
                facts.odometry_age_s or 0.0)
        if _unplaced(facts):
            return LOST, 'its place is no longer known: ' + facts.place_text
        if self.phase == JOINING and facts.now_s - self._phase_s > JOIN_S:
            return FAILED, 'its task does not reach it: is the enabling pedal pressed?'
        if self.phase == UNDER_WAY and facts.obeys != TASK:
            return LOST, 'its task did not reach it any more (a busy computer, or a released ' \
                'pedal): continue it'
        return None

    def _get_ready(self, facts: Facts) -> None:
        # While the robot obeys its previous task, zeros are published for that one.
        self._named = facts.obeys == TASK
        if self._named:
            self._left_out_s = facts.now_s
        missing = missing_senses(facts)
        if missing:
            self.text = 'waits for ' + missing
        if missing or not self._named and facts.now_s - self._left_out_s < LEFT_OUT_S:
            return
        self.phase, self._phase_s = JOINING, facts.now_s
        self.text = 'waits for the drive service to let it drive'

    def _join(self, facts: Facts) -> None:
        if facts.obeys == TASK:
            self.phase, self._phase_s = UNDER_WAY, facts.now_s

    def _drive(self, facts: Facts) -> Velocity:
        """Return the velocity of the task, limited by the free way."""
        assert self._task is not None and facts.senses is not None
        robots = discs(facts.senses.pose, facts.senses.others.values(), _MOVES_M)
        met = np.vstack((facts.senses.points, robots))
        senses = replace(facts.senses, points=np.vstack((met, facts.senses.floor)))
        step = self._task.step(senses)
        self.left_m = step.left_m
        self.said += step.said
        self.acts += step.acts
        if step.state in ENDS:
            self.end(step.state, step.text, facts.now_s)
            return ZERO
        if not step.velocity.is_finite():
            self.end(FAILED, 'its task requested a velocity that is not a number', facts.now_s)
            return ZERO
        radius_m = self._body.radius_m
        free = braked(step.velocity, met, radius_m, facts.scan_age_s, facts.looks,
                      facts.crawl_mps) \
            if facts.has_laser else braked(step.velocity, robots, radius_m, 0.0)
        on_floor = braked(free, senses.floor, radius_m, 0.0)
        velocity = kept_inside(on_floor, senses.pose, senses.fence, self._body)
        passes = '' if facts.settling else self._lets_pass(step, facts.senses)
        held = facts.settling or passes or self._held(step, free, facts) \
            or _stands_at('the end of the free floor on the map', free, on_floor) \
            or _stands_at('the fence', on_floor, velocity)
        self._mark(held, facts.now_s)
        self.state, self.text = (WAITING, held) if held else (
            RUNNING, step.text + self._unseen(step.velocity, free, facts))
        patience_s = PASSED_AFTER_S if passes else BLOCKED_AFTER_S
        if held and self._held_since is not None \
                and facts.now_s - self._held_since > patience_s:
            self.end(BLOCKED, 'for {:g} s: {}'.format(patience_s, held), facts.now_s)
        if self.phase == ENDED or facts.settling or passes:
            return ZERO
        return velocity

    def _lets_pass(self, step: Step, senses: Senses) -> str:
        """Describe the robot to which it gives way, '' without one."""
        assert self._task is not None
        first = _to_let_pass(senses, self._task.pass_by) \
            if step.state != WAITING and step.velocity.linear_mps > _STANDS_MPS else ''
        return first and 'it gives way to ' + first

    def _held(self, step: Step, velocity: Velocity, facts: Facts) -> str:
        """Describe the cause of a stop, '' without one."""
        assert self._task is not None and facts.senses is not None
        if step.state == WAITING:
            return step.text
        if step.velocity.speed_mps <= _STANDS_MPS or velocity.speed_mps > _STANDS_MPS:
            return ''
        blind = facts.has_laser and (facts.scan_age_s is None or facts.scan_age_s > SCAN_OLD_S)
        if facts.unplaced and (blind or self._unseen(step.velocity, velocity, facts)):
            return 'the place of one of its lasers is unknown'
        if blind:
            return 'no data from its laser or depth camera for {:.1f} s'.format(
                facts.scan_age_s or 0.0)
        return 'no sensor covers the way' \
            if self._unseen(step.velocity, velocity, facts) else 'an obstacle is in its way'

    def _unseen(self, wanted: Velocity, free: Velocity, facts: Facts) -> str:
        """Return a note if the robot is slow since no sensor covers its way, else ''."""
        if not facts.has_laser or facts.scan_age_s is None or wanted.speed_mps == 0.0:
            return ''
        seen_mps = seen_velocity(
            wanted, self._body.radius_m + MARGIN_M, REACTION_S + facts.scan_age_s, facts.looks,
            facts.crawl_mps).speed_mps
        slow = seen_mps < wanted.speed_mps and free.speed_mps >= seen_mps - 1e-3
        return ', slowly: no sensor looks that way' if slow else ''

    def _mark(self, held: str, now_s: float) -> None:
        """Record the start of a stop; a motion for longer than _HELD_ANEW_S resets it."""
        if held:
            self._held_since = now_s if self._held_since is None else self._held_since
            self._held_last = now_s
        elif now_s - self._held_last > _HELD_ANEW_S:
            self._held_since = None


def _stands_at(what: str, free: Velocity, velocity: Velocity) -> str:
    """Describe the limit that stops a free velocity, '' if it does not."""
    held = velocity.speed_mps <= _STANDS_MPS < free.speed_mps
    return 'it is at ' + what if held else ''


def _unplaced(facts: Facts) -> bool:
    return facts.place_age_s is None or facts.place_age_s > OLD_S


def missing_senses(facts: Facts) -> str:
    """Describe the first of the missing data, '' if complete."""
    for missing, words in (
            (not facts.known, 'the drive service to know it'),
            (facts.odometry_age_s is None or facts.odometry_age_s > OLD_S,
             'its odometry' + (facts.odometry_note and ': ' + facts.odometry_note)),
            (_unplaced(facts), 'its place: ' + facts.place_text),
            (facts.has_laser and (facts.scan_age_s is None or facts.scan_age_s > SCAN_OLD_S),
             'its laser or depth camera'),
            (facts.senses is None, 'its sensors')):
        if missing:
            return words
    return ''


def _to_let_pass(senses: Senses, pass_by: Tuple[str, ...]) -> str:
    """Return the robot ahead with right of way, '' without one."""
    for name, other in senses.others.items():
        place = other.pose.x_m, other.pose.y_m
        if other.goes_first and name not in pass_by and way(senses.pose, *place) < PASS_M \
                and abs(turn_to(senses.pose, *place)) < PASS_RAD:
            return name
    return ''
