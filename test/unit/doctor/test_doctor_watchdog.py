# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The trial of a watchdog, step by step, against bodies that behave in every way."""
import pytest

from mhri.doctor.facts import FAULT, FINE, WARNING
from mhri.doctor.watchdog import (
    DONE, LOST, MOVED_BEFORE, MUTE, NOT_MOVED, RUNS_ON, STOPS, TURN_RAD_S, verdict, WatchdogTrial)
from mhri.robots.link import Motion

REST, TURNS = Motion(0.0, 0.0), Motion(0.0, TURN_RAD_S)
PERIOD_S = 0.05


class Body:
    """Turns while it is told to, and for a time after."""

    def __init__(self, watchdog_s=0.6, obeys=True, mute_from=None, moving=False):
        self.watchdog_s, self.obeys, self.mute_from, self.moving = (
            watchdog_s, obeys, mute_from, moving)
        self.told = None
        self.heard = (None, 0.0)

    def tell(self, now, turn):
        if turn is not None:
            self.told = now
        moves = self.obeys and self.told is not None and now - self.told < self.watchdog_s
        if self.mute_from is None or now < self.mute_from:
            self.heard = (TURNS if moves or self.moving else REST, now)


def run(body):
    """Return the trial when it is done, and everything that was sent."""
    trial, now, sent = WatchdogTrial(0.0), 0.0, []
    while trial.phase != DONE:
        turn = trial.step(now, *body.heard)
        sent.append(turn)
        body.tell(now, turn)
        now += PERIOD_S
        assert now < 20.0
    return trial, sent


CASES = {
    'stops': (Body(), STOPS, FINE),
    'stops late': (Body(watchdog_s=2.0), STOPS, WARNING),
    'runs on': (Body(watchdog_s=1e9), RUNS_ON, FAULT),
    'does not move': (Body(obeys=False), NOT_MOVED, WARNING),
    'moves already': (Body(moving=True), MOVED_BEFORE, WARNING),
    'mute': (Body(mute_from=-1.0), MUTE, WARNING),
    'falls silent while driven': (Body(mute_from=0.6), LOST, WARNING),
    'falls silent afterwards': (Body(watchdog_s=1e9, mute_from=1.5), LOST, WARNING),
}


@pytest.mark.parametrize('case', sorted(CASES))
def test_trial(case):
    body, outcome, severity = CASES[case]
    trial, sent = run(body)
    assert trial.outcome == outcome
    finding = verdict('bot1', outcome, trial.stopped_s)
    assert finding.severity == severity
    assert severity == FINE or finding.remedy and finding.symptom
    assert set(sent) <= {None, TURN_RAD_S}
    if outcome in (MOVED_BEFORE, MUTE):
        assert set(sent) == {None}


def test_time_is_measured_from_the_last_command():
    trial, _ = run(Body(watchdog_s=0.6))
    assert trial.stopped_s == pytest.approx(0.6, abs=2 * PERIOD_S)


def test_one_reading_of_rest_is_not_believed():
    """A stale or a lucky reading must not pass for a stop: three new ones in a row."""
    trial = WatchdogTrial(0.0)
    for step in range(200):
        now = step * PERIOD_S
        resting = step > 40 and step % 3 == 0
        trial.step(now, REST if step < 2 or resting else TURNS, now)
        if trial.phase == DONE:
            break
    assert trial.outcome == RUNS_ON
