# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What drivers send as an orientation: one rule says everywhere whether it is one."""
import math

import numpy as np
import pytest

from mhri.base.geometry import heading_of, is_rotation
from mhri.base.series import roll_pitch_yaw
from mhri.base.tf_tree import TfTree
from support.rotations import NONE, ROTATIONS


def in_tf(turn):
    """Return the heading of a frame in tf, None if it has no pose."""
    tree = TfTree()
    tree.add('odom', 'base', (0.0, 0.0, 0.0, *turn), None)
    found = tree.find('odom', 'base')
    return found and found[0].heading_rad


@pytest.mark.parametrize('turn, heading', ROTATIONS.values(), ids=ROTATIONS)
def test_a_rotation_has_the_same_heading_everywhere(turn, heading):
    assert is_rotation(*turn)
    for found in (heading_of(*turn), in_tf(turn), roll_pitch_yaw(np.array([turn]))[0, 2]):
        assert math.remainder(found - heading, 2.0 * math.pi) == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize('turn', NONE.values(), ids=NONE)
def test_what_is_no_rotation_has_no_heading_anywhere(turn):
    assert not is_rotation(*turn) and math.isnan(heading_of(*turn))
    assert in_tf(turn) is None and np.isnan(roll_pitch_yaw(np.array([turn], float))).all()


def test_rows_are_judged_one_by_one():
    rows = np.array([*NONE.values(), *(turn for turn, _ in ROTATIONS.values())], float)
    with np.errstate(all='ignore'):
        assert list(is_rotation(*rows.T)) == [False] * len(NONE) + [True] * len(ROTATIONS)
