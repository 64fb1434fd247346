# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A press of STOP is left to the screen while that beats, and to nobody else for long."""
import pytest

from mhri.screen.hang import BEAT_S, LATE_S, PressWatch


def stopped_at(beats, presses, until=3.0, step=0.01):
    """Return when others have to stop, given the times of beats and presses [s]."""
    watch, stops = PressWatch(0.0), []
    for tick in range(round(until / step) + 1):
        now = round(tick * step, 3)
        if now in beats:
            watch.beat(now)
        if now in presses:
            watch.press(now)
        if watch.take(now):
            stops.append(now)
    return stops


def beats(*spans):
    """Return the times of beats in some spans (from, to)."""
    return {round(begin + BEAT_S * number, 3) for begin, end in spans
            for number in range(round((end - begin) / BEAT_S) + 1)}


@pytest.mark.parametrize('alive, presses, wanted', [
    ([(0, 3)], [1.0, 1.05, 1.55], []),
    ([(0, 3)], [], []),
    ([(0, 1)], [], []),
    # Hung for long: at once, each time.
    ([(0, 1)], [1.5], [1.5]),
    ([(0, 1)], [1.5, 2.5], [1.5, 2.5]),
    # Hung since just now, and together with the hang: when it counts as hung.
    ([(0, 1)], [1.2], [1.3]),
    ([(0, 1)], [1.0], [1.3]),
    ([(0, 1)], [1.0, 1.1, 1.29], [1.3]),
    # One beat after the press may have left before the screen knew of it.
    ([(0, 1)], [0.95], [1.2]),
    ([(0, 1), (1.35, 1.35)], [1.2], [1.3]),
    # Late, but there.
    ([(0, 1), (1.29, 3)], [1.05], [1.3]),
    ([(0, 1), (1.19, 3)], [1.05], []),
    # Back again.
    ([(0, 1), (2, 3)], [2.3], []),
    ([(0, 1), (2, 3)], [1.6, 2.3], [1.6]),
], ids=str)
def test_who_stops(alive, presses, wanted):
    assert stopped_at(beats(*alive), presses) == wanted


def test_how_long_to_wait():
    watch = PressWatch(0.0)
    assert watch.wait_s(9.0) is None
    watch.beat(10.0)
    watch.press(10.1)
    assert watch.wait_s(10.2) == pytest.approx(LATE_S - 0.2)
    assert watch.wait_s(99.0) == 0.0 and watch.take(99.0)
    assert watch.wait_s(99.0) is None and not watch.take(99.0)
