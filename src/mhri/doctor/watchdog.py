# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Tests whether a robot stops by itself when commands cease: the trial, and its verdict."""
from typing import List, Optional

from mhri.doctor.facts import FAULT, Finding, FINE, WARNING
from mhri.robots.link import Motion

WAITING, DRIVING, LISTENING, DONE = 'waiting', 'driving', 'listening', 'done'
# Outcomes of a trial.
STOPS, RUNS_ON, NOT_MOVED, MOVED_BEFORE, MUTE, LOST = (
    'stops', 'runs on', 'not moved', 'moved before', 'mute', 'lost')

TURN_RAD_S = 0.3
TIMEOUT_S = 3.0
START_S = 2.0
TURNING_S = 0.7
REST_READINGS = 3
FRESH_S = 0.5
SLOW_S = 1.0
_GUARD = 'on the robot: utils/remote/mhri_guard in its namespace (turtle_remote.sh starts it), ' \
    'and set the timeout of its base driver'


class WatchdogTrial:
    """Turns a robot in place slowly, stops publishing, and waits for it to stop by itself.

    It turns, so that a robot on the floor stays in place. ``phase`` is one of WAITING (for
    odometry at rest), DRIVING, LISTENING (nothing is published) and DONE; ``outcome`` is set when
    DONE, ``stopped_s`` is the time from the last command to standstill [s].
    """

    def __init__(self, now: float, turn_rad_s: float = TURN_RAD_S) -> None:
        self.phase = WAITING
        self.outcome: Optional[str] = None
        self.stopped_s: Optional[float] = None
        self._turn_rad_s = turn_rad_s
        self._begun = now
        self._moved_at: Optional[float] = None
        self._last_sent = now
        self._rest: List[float] = []

    def step(self, now: float, motion: Optional[Motion], heard_at: float) -> Optional[float]:
        """Process the newest motion; return the turn rate to publish [rad/s], None for nothing.

        :param motion: :class:`mhri.robots.link.Motion`, None before the first
        :param heard_at: time of receipt of the motion [s]
        """
        if not now - heard_at <= FRESH_S:
            motion = None
        if self.phase == WAITING:
            self._wait(now, motion)
        elif self.phase == DRIVING:
            self._drive(now, motion)
        elif self.phase == LISTENING:
            self._listen(now, motion, heard_at)
        if self.phase == DRIVING:
            self._last_sent = now
            return self._turn_rad_s
        return None

    def _end(self, outcome: str) -> None:
        self.phase, self.outcome = DONE, outcome

    def _enter(self, phase: str, now: float) -> None:
        self.phase, self._begun, self._rest = phase, now, []

    def _wait(self, now: float, motion: Optional[Motion]) -> None:
        if motion is not None and not motion.is_standstill():
            self._end(MOVED_BEFORE)
        elif motion is not None:
            self._enter(DRIVING, now)
        elif now - self._begun > START_S:
            self._end(MUTE)

    def _drive(self, now: float, motion: Optional[Motion]) -> None:
        if motion is None:
            self._end(LOST)
        elif self._moved_at is None and not motion.is_standstill():
            self._moved_at = now
        elif self._moved_at is not None and now - self._moved_at >= TURNING_S:
            self._enter(LISTENING, now)
        elif self._moved_at is None and now - self._begun > START_S:
            self._end(NOT_MOVED)

    def _listen(self, now: float, motion: Optional[Motion], heard_at: float) -> None:
        if motion is None:
            self._end(LOST)
        elif not motion.is_standstill():
            self._rest = []
        elif not self._rest or heard_at > self._rest[-1]:
            self._rest.append(heard_at)
        if self.phase == LISTENING and len(self._rest) >= REST_READINGS:
            self.stopped_s = max(0.0, self._rest[0] - self._last_sent)
            self._end(STOPS)
        elif self.phase == LISTENING and now - self._begun > TIMEOUT_S:
            self._end(RUNS_ON)


def verdict(robot: str, outcome: str, stopped_s: Optional[float] = None) -> Finding:
    """Return the :class:`Finding` of a trial."""
    if outcome == STOPS and stopped_s is not None:
        words = 'stood still {:.2f} s after the last command'.format(stopped_s)
        confidence = 'measured once, by its own odometry'
        if stopped_s <= SLOW_S:
            return Finding(FINE, 'watchdog', robot, words, confidence=confidence)
        return Finding(WARNING, 'watchdog_slow', robot, words, 'when the network is lost, it '
                       'drives on for that long', _GUARD, confidence)
    if outcome == RUNS_ON:
        return Finding(
            FAULT, 'watchdog_none', robot, 'it kept turning for {:.0f} s without any command, '
            'until it was sent zero'.format(TIMEOUT_S),
            'when the network is lost or the panel\'s computer dies, it drives on for ever', _GUARD,
            'measured once, by its own odometry')
    words = {
        NOT_MOVED: 'it did not move, so nothing could be measured',
        MOVED_BEFORE: 'it was already moving before the trial, so nothing was tried',
        MUTE: 'it sends no odometry, so nothing was tried',
        LOST: 'its odometry stopped during the trial, so nothing could be measured'}[outcome]
    return unknown(robot, words, 'rosrun mhri mhri_doctor {}   # fix what it reports first'.format(
        robot))


def unknown(robot: str, words: str, remedy: str) -> Finding:
    """Return the :class:`Finding` for a watchdog that could not be measured."""
    return Finding(WARNING, 'watchdog_unknown', robot, words,
                   'it may not stop when the network is lost', remedy)
