# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A goal that a robot's own navigation drives to: what is sent, and what cancels it."""
import math

import numpy as np
import pytest

from mhri.base.geometry import Pose
from mhri.base.robot_types import Limits
from mhri.tasks.base import (
    BLOCKED, Body, DONE, FAILED, LOST, RUNNING, Senses, STOPPED, TAKEN_OVER, Target, TIMEOUT,
    WAITING)
from mhri.tasks.delegated import DelegatedRun, Errand
from mhri.tasks.run import ENDED, Facts, READY_S, UNDER_WAY

BODY = Body(0.2, Limits(0.5, 1.0))
SQUARE = np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)])


class FakeErrand(Errand):

    def __init__(self):
        self.ready, self.says = True, (RUNNING, 'its own navigation drives it')
        self.sent, self.cancels = [], 0

    def is_ready(self):
        return self.ready

    def begin(self, by_odometry, in_frame):
        self.sent.append((by_odometry, in_frame))

    def look(self):
        return self.says

    def cancel(self):
        self.cancels += 1


def facts(now_s=1.0, pose=Pose(0.0, 0.0, 0.0), odometry=Pose(0.0, 0.0, 0.0), fence=(), **known):
    return Facts(now_s, odometry_age_s=0.0, scan_age_s=None, senses=Senses(
        now_s, pose, odometry, fence=np.array(fence).reshape(-1, 2)), **known)


def begun(target=Target(2.0, 1.0), timeout_s=0.0):
    """Return (run, its errand), under way."""
    errand = FakeErrand()
    run = DelegatedRun('bot1', target, errand, BODY, timeout_s, 0.0)
    assert run.tick(facts()).is_zero()
    assert (run.phase, len(errand.sent)) == (UNDER_WAY, 1)
    return run, errand


def test_nothing_is_to_be_published_while_its_navigation_drives():
    run, _ = begun()
    assert not run.drives
    run.end(STOPPED, 'x', 2.0)
    assert run.drives


@pytest.mark.parametrize('target, sent', [
    # The robot stands at (1, 0) on the map and looks left; its odometry is all 0.
    (Target(1.0, 2.0, 0.5 * math.pi), (2.0, 0.0, 0.0)),
    (Target(0.0, 0.0, 0.0), (0.0, 1.0, -0.5 * math.pi)),
    (Target(1.0, 2.0), (2.0, 0.0, 0.0)),
    (Target(3.0, 4.0, 1.0, by_odometry=True), (3.0, 4.0, 1.0))])
def test_the_goal_is_sent_in_the_frame_of_its_odometry(target, sent):
    errand = FakeErrand()
    run = DelegatedRun('bot1', target, errand, BODY, 0.0, 0.0)
    run.tick(facts(pose=Pose(1.0, 0.0, 0.5 * math.pi)))
    pose = errand.sent[0][0]
    assert (pose.x_m, pose.y_m) == pytest.approx(sent[:2], abs=1e-9)
    assert math.remainder(pose.heading_rad - sent[2], 2 * math.pi) == pytest.approx(0.0, abs=1e-9)
    assert (errand.sent[0][1] is None) == target.by_odometry


@pytest.mark.parametrize('known, state', [
    (dict(stop_all=True), STOPPED), (dict(stands='stopped_alone'), STOPPED),
    (dict(answers=False), LOST), (dict(known=False), LOST),
    (dict(stands='not_heard'), LOST), (dict(obeys='operator'), TAKEN_OVER),
    (dict(place_age_s=None), LOST), (dict(battery=0.1), FAILED), (dict(now_s=99.0), TIMEOUT)])
def test_whatever_ends_it_cancels_the_goal(known, state):
    run, errand = begun(timeout_s=50.0)
    run.tick(facts(**known))
    assert (run.phase, run.state, errand.cancels) == (ENDED, state, 1)
    assert run.tick(facts(3.0)).is_zero()
    assert (len(errand.sent), errand.cancels) == (1, 1)


@pytest.mark.parametrize('says, state, phase', [
    ((RUNNING, 'drives'), RUNNING, UNDER_WAY), ((WAITING, 'waits'), WAITING, UNDER_WAY),
    ((DONE, 'there'), DONE, ENDED), ((BLOCKED, 'no way'), BLOCKED, ENDED)])
def test_what_its_navigation_says_is_passed_on(says, state, phase):
    run, errand = begun()
    errand.says = says
    run.tick(facts(2.0))
    assert (run.state, run.phase) == (state, phase)
    assert says[1] in run.text
    assert run.left_m == pytest.approx(math.hypot(2.0, 1.0))


def test_a_navigation_that_is_not_heard_is_waited_for_and_given_up():
    errand = FakeErrand()
    errand.ready = False
    run = DelegatedRun('bot1', Target(2.0, 1.0), errand, BODY, 0.0, 0.0)
    run.tick(facts())
    assert run.state == WAITING
    run.tick(facts(READY_S + 0.1))
    assert (run.state, errand.sent) == (LOST, [])


def test_it_obeys_the_fence():
    errand = FakeErrand()
    run = DelegatedRun('bot1', Target(2.0, 0.0), errand, BODY, 0.0, 0.0)
    run.tick(facts(fence=SQUARE))
    assert (run.state, errand.sent) == (FAILED, [])
    run, errand = begun(Target(0.5, 0.0))
    for number, (x, ends) in enumerate([(0.7, False), (0.79, False), (0.85, True)]):
        run.tick(facts(2.0 + number, pose=Pose(x, 0.0, 0.0), fence=SQUARE))
        assert (run.state == BLOCKED) == ends
    assert 'fence' in run.text
    # Outside it may come back in.
    run, errand = begun(Target(0.5, 0.0))
    for number, x in enumerate([1.5, 1.4, 1.2, 1.0, 0.8, 0.6]):
        run.tick(facts(2.0 + number, pose=Pose(x, 0.0, 0.0), fence=SQUARE))
    assert run.phase == UNDER_WAY
