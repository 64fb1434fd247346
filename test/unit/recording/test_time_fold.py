# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The times of a recording: strays set aside, long gaps folded, all else as it was."""
import time

import numpy as np
import pytest

from mhri.recording.time_fold import GAP_NS, KEPT_NS, spans_of, TimeFold

NS = 10 ** 9
NOW, YEARS = 1700000000 * NS, 7 * 365 * 86400 * NS


def steady(begin_ns, seconds=20, rate_hz=10):
    return begin_ns + np.arange(seconds * rate_hz + 1, dtype=np.int64) * NS // rate_hz


def folded(*parts):
    """Return (fold, the times that are left, folded)."""
    times = np.sort(np.concatenate(parts))
    fold = TimeFold(spans_of(times))
    return fold, fold(times[~fold.is_stray(times)])


STRAYS = {'before_the_clock_was_set': np.array([10 ** 6] * 3), 'late': NOW + YEARS + steady(0, 0),
          'early_and_late': np.array([1, 5, NOW + YEARS])}


@pytest.mark.parametrize('strays', STRAYS.values(), ids=STRAYS)
@pytest.mark.parametrize('begin', [NOW, 100 * NS])
def test_a_few_far_from_all_others_are_set_aside_and_named(strays, begin):
    fold, times = folded(strays, steady(begin))
    assert np.array_equal(times, steady(begin))
    named, = fold.problems
    assert all('{} of '.format(count) in named for _, _, count in spans_of(np.sort(strays)))


@pytest.mark.parametrize('leap', [YEARS, 2 * GAP_NS])
@pytest.mark.parametrize('first, second', [(30, 600), (600, 30)])
def test_a_leap_of_the_clock_is_folded_and_the_longer_part_keeps_its_times(leap, first, second):
    before, after = steady(NOW, first), steady(NOW + leap + first * NS, second)
    fold, times = folded(before, after)
    assert times[-1] - times[0] == (first + second) * NS + KEPT_NS and len(fold.problems) == 1
    kept = after if second > first else before
    assert np.isin(kept, times).all()
    assert (np.diff(times) >= 0).all()


def test_what_lies_in_a_gap_is_at_the_end_before_it():
    fold, times = folded(steady(NOW), steady(NOW + YEARS, 40))
    lines = np.array([0, NOW + 3600 * NS, NOW + YEARS, NOW + 2 * YEARS])
    assert fold(lines).tolist() == [times[0], times[200], times[201], times[-1]]


@pytest.mark.parametrize('times', [
    steady(NOW), steady(NOW, 600, 1), NOW + np.arange(5) * GAP_NS, np.array([NOW])])
def test_what_has_no_gap_stays_as_it_is(times):
    fold, found = folded(times)
    assert np.array_equal(found, times) and not fold.problems


def test_any_number_of_strays_is_named_briefly_and_soon():
    begun = time.thread_time()
    fold, times = folded(NOW + YEARS + np.arange(50000) * 2 * GAP_NS, steady(NOW, 60))
    assert time.thread_time() - begun < 3.0
    assert np.array_equal(times, steady(NOW, 60)) and len(fold.problems[0]) < 300


def test_a_log_of_rare_messages_has_no_strays():
    times = NOW + np.arange(5) * 5 * GAP_NS
    assert len(folded(times)[1]) == 5
