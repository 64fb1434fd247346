# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""How late a message is, whatever the clock of its sender says."""
import pytest

from mhri.robots.link_quality import link_warning, LinkQuality
from mhri.robots.stamp_age import delay_of, SET_SINCE_S, SETTLE_S, StampAge

NOW = 1.8e9  # the robot's clock, when ours (which counts from anywhere) says 0


def told(delays, offset_s=0.0, rate=1.0, step_s=0.02):
    """Return the lateness of messages with these delays, from a clock that is off, or too fast."""
    age = StampAge()
    return [age.late_s(NOW + offset_s + rate * number * step_s, number * step_s + delay)
            for number, delay in enumerate(delays)]


@pytest.mark.parametrize('offset_s', [0.0, 0.3, -0.3, 3600.0, -86400.0])
def test_the_offset_of_the_clock_does_not_matter(offset_s):
    """Only what a message took longer than the quickest."""
    late = told([0.01] * 100 + [0.61] * 5, offset_s)
    assert late[-6:] == pytest.approx([0.0] + [0.6] * 5, abs=0.01)


def test_a_delay_that_creeps_is_no_clock():
    """6.6 ms more each second, for ten minutes."""
    late = told([0.01 + 0.0066 * 0.1 * number for number in range(6000)], step_s=0.1)
    assert late[-1] > 0.9 * 0.0066 * 600


@pytest.mark.parametrize('rate', [1.0001, 0.9999])
def test_two_quartzes_apart_are_no_delay(rate):
    """100 ppm for an hour."""
    assert told([0.01] * 36000, rate=rate, step_s=0.1)[-1] == pytest.approx(0.0, abs=0.001)


def test_a_clock_set_back_makes_everything_unknown_for_a_while():
    """And one set forward changes nothing."""
    age = StampAge()
    for number in range(100):
        age.late_s(NOW + 0.02 * number, 0.02 * number)
    assert age.late_s(NOW + 60.0, 2.0) == 0.0
    assert age.late_s(NOW + 2.0, 2.02) is None
    assert age.late_s(NOW + 2.0 + SETTLE_S, 2.03 + SETTLE_S) == pytest.approx(0.01, abs=0.001)


@pytest.mark.parametrize('stamp_s', [None, 0.0, 12.5, SET_SINCE_S - 1.0])
def test_no_stamp_and_simulated_time_say_nothing(stamp_s):
    """No lateness is made up."""
    age = StampAge()
    assert [age.late_s(stamp_s, now) for now in (1.0, 5.0)] == [0.0, 0.0]


@pytest.mark.parametrize('stamp_s, words', [
    (0.0, ''), (12.0, ''), (NOW - 0.005, ''), (NOW - 2.0, 'its clock is 2.0 s behind'),
    (NOW + 2.0, 'its clock is 2.0 s ahead')])
def test_simulated_time_is_not_called_a_clock_that_is_behind(stamp_s, words):
    """1759999988 s behind was said of a simulator."""
    quality = LinkQuality()
    quality.on_round_trip(0.01)
    quality.on_message(1, delay_of(NOW, stamp_s), 5.0)
    assert link_warning(quality.read(5.0)).startswith(words)
    assert bool(link_warning(quality.read(5.0))) == bool(words)
