# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Four robots on one radio of 1 Mbit/s that loses a fifth, 200 ms away: in simulated time."""
import os
import sys

import pytest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..'))

from support.radio_world import RadioWorld  # noqa: E402

BAD_S, FOUND_S, END_S = 3.0, 13.0, 40.0
ROWS = [{'at_s': 0}, {'at_s': BAD_S, 'delay_ms': 200, 'loss_percent': 20, 'rate_mbit': 1}]


def p95(values):
    """Return that below which 95 of 100 are."""
    return values[int(0.95 * len(values))]


@pytest.mark.parametrize('seed', [1, 2])
def test_poses_stay_young_and_pictures_come_of_each(seed):
    world = RadioWorld(ROWS, 4, seed)
    world.run(END_S)
    at_first, _, _ = world.figures(BAD_S + 0.5, FOUND_S)
    poses, pictures, gap_s = world.figures(FOUND_S, END_S)
    carried = world.up.counts[1].bytes_passed / 0.8 / (END_S - BAD_S)
    print('MEASURED pose p95 {:.3f}, at first {:.3f} s; picture p95 {:.3f} s, longest gap {:.1f} s; '
          '{:.0f} bytes/s'.format(p95(poses), p95(at_first), p95(pictures), gap_s, carried))
    assert p95(poses) <= 0.45 and p95(at_first) <= 0.7
    assert gap_s <= 2.0 and p95(pictures) <= 0.8
    assert carried > 0.75 * 125e3
