# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Four robots on one radio of 1 Mbit/s that loses a fifth, 200 ms away: in simulated time."""
import pytest

from support.radio_world import RadioWorld

BAD_S, FOUND_S, END_S = 3.0, 13.0, 40.0
ROWS = [{'at_s': 0}, {'at_s': BAD_S, 'delay_ms': 200, 'loss_percent': 20, 'rate_mbit': 1}]


def p95(values):
    """Return that below which 95 of 100 are."""
    return values[int(0.95 * len(values))]


def test_poses_stay_young_and_pictures_come_of_each():
    world = RadioWorld(ROWS, 4, 1)
    world.run(END_S)
    at_first, _, first_gap_s = world.figures(BAD_S + 0.5, FOUND_S)
    poses, pictures, gap_s = world.figures(FOUND_S, END_S)
    carried = world.up.counts[1].bytes_passed / 0.8 / (END_S - BAD_S)
    print('MEASURED pose p95 {:.3f}, at first {:.3f} s; picture p95 {:.3f}, longest gap {:.1f} s, '
          'at first {:.1f} s; {:.0f} bytes/s'.format(
              p95(poses), p95(at_first), p95(pictures), gap_s, first_gap_s, carried))
    assert p95(poses) <= 0.45 and p95(at_first) <= 0.6
    assert gap_s <= 2.0 and first_gap_s <= 2.4 and p95(pictures) <= 0.8
    assert carried > 0.75 * 125e3


@pytest.mark.parametrize('row, pose_s', [
    ({'delay_ms': 50, 'loss_percent': 1, 'rate_mbit': 10}, 0.15),
    ({'delay_ms': 20, 'rate_mbit': 1}, 0.25)])
def test_other_radios_are_used_too_and_a_good_one_gets_everything_again(row, pose_s):
    world = RadioWorld([{'at_s': 0}, dict(row, at_s=BAD_S)] + [
        {'at_s': END_S, 'delay_ms': 0, 'loss_percent': 0, 'rate_mbit': 0}], 2, 1)
    world.run(END_S)
    poses, _, gap_s = world.figures(FOUND_S, END_S)
    assert p95(poses) <= pose_s and gap_s <= 1.0
    world.run(2.0 * END_S)
    assert not any(sender.estimator.bound for sender in world.senders)


def test_a_radio_that_bore_most_and_becomes_bad_is_found_out_soon():
    begun_s = 15.0
    world = RadioWorld([{'at_s': 0, 'rate_mbit': 8, 'delay_ms': 20}, dict(ROWS[1], at_s=begun_s)],
                       4, 1)
    world.run(begun_s)
    assert all(sender.estimator.bound for sender in world.senders)
    world.run(begun_s + 8.0)
    poses, _, gap_s = world.figures(begun_s + 4.0, begun_s + 8.0)
    print('MEASURED four seconds later: pose p95 {:.3f} s, longest gap {:.1f} s'.format(
        p95(poses), gap_s))
    assert p95(poses) <= 0.8 and gap_s <= 3.0


def test_a_deep_queue_that_is_full_gets_empty_again():
    deep = {'at_s': BAD_S, 'delay_ms': 20, 'queue_ms': 2000, 'rate_mbit': 1}
    world = RadioWorld([{'at_s': 0}, deep], 4, 1)
    world.run(25.0)
    poses, _, _ = world.figures(15.0, 25.0)
    assert p95(poses) <= 0.4
