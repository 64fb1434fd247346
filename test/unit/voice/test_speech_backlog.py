# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""How old sound is: read in time, after a hang, from a clock that is not exact."""
import pytest

from mhri.voice.backlog import Backlog
from mhri.voice.sound import BLOCK_S


def read_in_time(backlog, now, seconds, drift=1.0):
    """Read as it is spoken; return the time after it, and the greatest age."""
    oldest = 0.0
    for _ in range(round(seconds / BLOCK_S)):
        now += BLOCK_S * drift
        oldest = max(oldest, now - backlog.take(now, False))
    return now, oldest


def test_what_is_read_in_time_is_new():
    assert read_in_time(Backlog(50.0), 50.0, 10.0)[1] == 0.0


def test_what_waited_while_nobody_read_is_as_old_as_that():
    backlog = Backlog(50.0)
    now, _ = read_in_time(backlog, 50.0, 5.0)
    now += 8.0
    ages = [now - backlog.take(now, True) for _ in range(100)]
    assert ages[0] == pytest.approx(8.0 - BLOCK_S) and ages == sorted(ages, reverse=True)
    assert ages[-1] == pytest.approx(8.0 - 100 * BLOCK_S)
    # The last of it: what came meanwhile beyond the room in the pipe is lost.
    assert now - backlog.take(now, False) == 0.0
    assert read_in_time(backlog, now, 5.0)[1] == 0.0


def test_what_waited_since_the_source_was_opened_is_old():
    assert 53.0 - Backlog(50.0).take(53.0, True) == pytest.approx(3.0 - BLOCK_S)


@pytest.mark.parametrize('drift', [0.999, 1.001])
def test_a_sound_card_with_a_clock_of_its_own_does_not_age(drift):
    assert read_in_time(Backlog(50.0), 50.0, 300.0, drift)[1] < 0.01
