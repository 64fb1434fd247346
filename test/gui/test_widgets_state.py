# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The line of ages and motion capture below a bot window's header."""
import math

import pytest

from mhri.core.robots.mocap import Drift, Pose
from mhri.core.screen.views import StateView
from mhri.gui.screen import theme
from mhri.gui.screen.state_line import ages_text, capture_text, StateLine


@pytest.mark.parametrize('ages, expected', [
    ((), ''), ((('IMU', 0.004),), 'IMU 4 ms'), ((('RGB', None),), 'RGB \u2013'),
    ((('IMU', 0.004), ('scan', 2.34)), 'IMU 4 ms scan 2.3 s')])
def test_ages(ages, expected):
    assert ' '.join(ages_text(ages).replace('\u2007', ' ').split()) == expected


def test_the_line_keeps_its_width_while_an_age_grows():
    """Digits of one width, and room for the longest: nothing jitters."""
    lengths = {len(ages_text((('IMU', age), ('scan', age)))) for age in
               (0.001, 0.012, 0.45, 1.2, 59.0)}
    assert len(lengths) == 1


@pytest.mark.parametrize('captured, drift, expected', [
    (None, None, ''),
    (Pose(1.2, -0.4, math.pi / 2), None, 'captured x 1.20 m  y -0.40 m  90 deg'),
    (Pose(1.2, 0.0, 0.0), Drift(0.123, -0.1),
     'odometry off 0.12 m, 6 deg   captured x 1.20 m  y 0.00 m  0 deg')])
def test_capture(captured, drift, expected):
    assert capture_text(captured, drift) == expected


def test_a_stream_that_is_old_is_pointed_at_at_once(operator):
    line = operator.show(StateLine())
    line.show_state(StateView((('IMU', 0.01), ('RGB', None))))
    assert line.ages_sign.sign is None, 'what has not begun is not old'
    line.show_state(StateView((('IMU', 1.4), ('RGB', None))))
    assert line.ages_sign.sign == (theme.TRIANGLE, theme.ATTENTION)
    assert 'IMU' in line.ages_sign.toolTip() and 'RGB' not in line.ages_sign.toolTip()
    line.show_state(StateView((('IMU', 0.01),)))
    assert line.ages_sign.sign is None
