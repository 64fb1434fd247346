# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The line of ages, link and motion capture below a tile's switches."""
import math

import pytest

from mhri.base.gui import theme
from mhri.base.geometry import Pose
from mhri.base.mocap import Drift
from mhri.base.views import LinkFigures, StateView
from mhri.screen.gui.state_line import age_phrase, capture_phrases, StateLine


def test_the_line_keeps_its_width_while_an_age_grows():
    """Digits of one width, and room for the longest: nothing jitters."""
    assert len({len(age_phrase('IMU', age)) for age in (0.001, 0.012, 0.45, 1.2, 59.0)}) == 1


@pytest.mark.parametrize('captured, drift, expected', [
    (None, None, ()),
    (Pose(1.2, -0.4, math.pi / 2), None, ('captured x 1.20 m  y -0.40 m  90 deg',)),
    (Pose(1.2, 0.0, 0.0), Drift(0.123, -0.1),
     ('odometry off 0.12 m, 6 deg', 'captured x 1.20 m  y 0.00 m  0 deg'))])
def test_capture(captured, drift, expected):
    assert capture_phrases(captured, drift) == expected


def test_a_stream_that_is_old_is_pointed_at_at_once(operator):
    line = operator.show(StateLine())
    line.show_state(StateView((('IMU', 0.01), ('RGB', None))))
    assert line.ages_sign.sign is None, 'what has not begun is not old'
    line.show_state(StateView((('IMU', 1.4), ('RGB', None))))
    assert line.ages_sign.sign == (theme.TRIANGLE, theme.ATTENTION)
    assert 'IMU' in line.ages_sign.toolTip() and 'RGB' not in line.ages_sign.toolTip()
    line.show_state(StateView((('IMU', 0.01),)))
    assert line.ages_sign.sign is None


@pytest.mark.parametrize('figures, text', [
    (LinkFigures(0.012, -0.314, 0.07), 'link 12 ms   clock -0.31 s   lost 7 %'),
    (LinkFigures(0.5), 'link 500 ms'), (LinkFigures(), ''),
    (LinkFigures(offset_s=-0.001), 'clock +0.00 s')])
def test_it_tells_round_trip_clock_and_loss(operator, figures, text):
    line = operator.show(StateLine())
    line.show_state(StateView((), figures=figures))
    assert ' '.join('   '.join(line.texts()).split()) == ' '.join(text.split())
