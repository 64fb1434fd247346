# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Random drives and random goals in the simulator's small world, in virtual time, by seed.

With the obstacle brake nothing is touched, and no robot stands without a word or beyond its
timeout; the same drives without the brake are there for comparison. ``MHRI_LONG=1`` is the long
form: 200 drives and 100 goals; ``MHRI_SEED`` begins at another seed.
"""
from collections import Counter
import statistics

from support.hostile import is_long, seed_of
from support.rough_world import DT_S, random_drive, random_goals, ROUGH

DRIVES, COMPARED, GOALS = (200, 200, 100) if is_long() else (28, 14, 12)
DRIVE_S = 25.0 if is_long() else 15.0
# A robot that turns no more and drives no more says why, before so long [s].
SILENT_S = 3.0


def drives(first, count, brake):
    """Return [(seed, contacts, closest approach [m])] of each robot of each drive."""
    return [(seed, robot.contacts, robot.closest_m) for seed in range(first, first + count)
            for robot in random_drive(seed, DRIVE_S, brake)]


def tell(words, rows):
    """Print who touched anything, and how near robots came; return the seeds with contacts."""
    touched = sorted({seed for seed, contacts, _ in rows if contacts})
    closest = [gap_m for _, _, gap_m in rows]
    print('{}: {} robots, contacts in {} of {} seeds {}; closest approach p50 {:.3f}, min {:.3f} m'
          .format(words, len(rows), len(touched), len({row[0] for row in rows}), touched[:20],
                  statistics.median(closest), min(closest)), flush=True)
    return touched


def test_random_drives_with_the_brake_touch_nothing():
    first = seed_of(0)
    braked = drives(first, DRIVES, True)
    for number, rough in enumerate(ROUGH):
        tell(rough.name, [row for row in braked if row[0] % len(ROUGH) == number])
    touched = tell('brake on', braked)
    compared = tell('brake off', drives(first, COMPARED, False))
    assert touched == []
    assert len(compared) > COMPARED // 2, 'these drives show nothing: they meet nothing anyway'


def test_random_goals_end_with_a_word_and_touch_nothing():
    first = seed_of(0)
    for brake in (True, False):
        found = [(seed, one) for seed in range(first, first + GOALS)
                 for one in random_goals(seed, brake)]
        touched = tell('goals, brake {}'.format('on' if brake else 'off'), [
            (seed, one.contacts, one.closest_m) for seed, one in found])
        print('ended: {}; stood for {:.1f} s at most, without a word for {:.1f} s'.format(
            dict(Counter(one.state for _, one in found)), max(one.stood_s for _, one in found),
            max(one.silent_s for _, one in found)), flush=True)
        assert [row for row in found if row[1].took_s > row[1].timeout_s + 2 * DT_S
                or not row[1].text] == []
        assert [row for row in found if row[1].state == 'done' and row[1].left_m > 0.2] == []
        if brake:
            assert touched == []
            assert [row for row in found if row[1].silent_s > SILENT_S] == []
