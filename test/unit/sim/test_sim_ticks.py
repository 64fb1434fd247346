# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The steps of a simulated robot: they do not drift, and what was missed is not made up for."""
import pytest

from mhri.sim.ticks import Due, Ticks


class Time:
    """A clock that stands still but for sleep and :meth:`work`."""

    def __init__(self):
        self.now = 50.0

    def clock(self):
        return self.now

    def sleep(self, seconds):
        assert seconds > 0.0
        self.now += seconds + 0.0002     # as late as a real sleep

    def work(self, seconds):
        self.now += seconds


@pytest.fixture
def time():
    return Time()


@pytest.fixture
def ticks(time):
    return Ticks(0.01, time.clock, time.sleep)


def test_no_drift(ticks, time):
    for number in range(1, 1001):
        assert ticks.wait()[0] == number
        time.work(0.004)
    assert time.now == pytest.approx(50.0 + 10.0 + 0.004, abs=0.001)


@pytest.mark.parametrize('work, number', [
    (0.005, 2), (0.012, 3), (0.055, 7), (10.0035, 1002)])
def test_missed_steps_are_skipped(ticks, time, work, number):
    ticks.wait()
    time.work(work)
    found, now, took = ticks.wait()
    assert found == number
    assert now == pytest.approx(50.0 + number * 0.01, abs=0.001)
    assert took == pytest.approx((number - 1) * 0.01, abs=0.001)
    assert ticks.wait()[0] == number + 1


@pytest.mark.parametrize('every, numbers, due', [
    (1, [1, 2, 3], [1, 2, 3]),
    (2, [1, 2, 3, 4, 5, 6], [1, 2, 4, 6]),
    (10, range(1, 41), [1, 10, 20, 30, 40]),
    (10, [1, 9, 13, 14, 19, 21, 30], [1, 13, 21, 30]),      # 10 and 20 were skipped
    (2, [1, 103, 104, 105], [1, 103, 104]),
])
def test_due(every, numbers, due):
    turn = Due(every)
    assert [number for number in numbers if turn.at(number)] == due
