# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The line of ages and motion capture below a tile's switches."""
import math

import pytest

from mhri.base.gui import theme
from mhri.base.mocap import Drift, Pose
from mhri.base.views import LinkFigures, StateView
from mhri.screen.gui.state_line import age_phrase, capture_phrases, StateLine
from mhri.screen.gui.windows import TurtleBotWindow


FIGURES = LinkFigures(0.0124, -0.4, 0.07)
CAPTURED, DRIFT = Pose(-12.34, -10.56, math.radians(-170.0)), Drift(10.23, math.radians(-170.0))
AGES = tuple((name, 0.994) for name in ('IMU', 'scan', 'RGB', 'capture'))


@pytest.mark.parametrize('name, age, expected', [
    ('IMU', 0.004, 'IMU 4 ms'), ('RGB', None, 'RGB \u2013'), ('scan', 2.34, 'scan 2.3 s')])
def test_ages(name, age, expected):
    assert ' '.join(age_phrase(name, age).replace('\u2007', ' ').split()) == expected


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


def check_whole(line):
    """Every phrase can be read, none lies on another, and all are within the line."""
    labels = line.labels()
    assert len(labels) == 3 + 2 + 4
    for label in labels:
        assert label.shown_text() == label.text() != '', label.text()
        assert line.rect().contains(label.geometry())
    for index, label in enumerate(labels):
        assert not any(label.geometry().intersects(other.geometry()) for other in labels[:index])


@pytest.mark.parametrize('factor', [1.0, 2.0])
@pytest.mark.parametrize('width', [0, 620, 760, 930, 1300, 1900])
def test_nothing_is_cut_off_in_a_window_of_any_width(operator, ui_dir, application, width, factor):
    """Link figures, drift and pose together; 0: as narrow as the longest phrase."""
    usual = application.font()
    application.setFont(theme.larger(usual, factor))
    try:
        window = TurtleBotWindow(ui_dir, 'bot1', 'TurtleBot2')
        window.offer({'imu', 'rgb', 'depth', 'scan', 'record'})
        operator.show(window)
        operator.click(window.views_button)
        window.state_line.show_state(StateView(AGES, FIGURES, CAPTURED, DRIFT))
        operator.settle()
        beside = window.width() - window.state_line.width()
        window.resize(max(width, window.state_line.minimumSizeHint().width() + beside), 700)
        operator.settle()
        check_whole(window.state_line)
    finally:
        application.setFont(usual)


def test_one_line_where_there_is_room_and_no_leap_when_a_number_grows(operator):
    line = StateLine()
    line.resize(1900, 20)
    operator.show(line)
    line.show_state(StateView(AGES, FIGURES, CAPTURED, DRIFT))
    operator.settle()
    assert len({label.y() for label in line.labels()}) == 1
    places = [label.pos() for label in line.labels()]
    line._numbers._next = None
    line.show_state(StateView(AGES, FIGURES, Pose(1.0, 1.0, 0.0), Drift(0.1, 0.0)))
    assert [label.pos() for label in line.labels()] == places
    assert 'odometry off 0.10 m, 0 deg' in line.texts()


def test_a_stream_that_is_old_is_pointed_at_at_once(operator):
    line = operator.show(StateLine())
    line.show_state(StateView((('IMU', 0.01), ('RGB', None))))
    assert line.ages_sign.sign is None, 'what has not begun is not old'
    line.show_state(StateView((('IMU', 1.4), ('RGB', None))))
    assert line.ages_sign.sign == (theme.TRIANGLE, theme.ATTENTION)
    assert 'IMU' in line.ages_sign.toolTip() and 'RGB' not in line.ages_sign.toolTip()
    line.show_state(StateView((('IMU', 0.01),)))
    assert line.ages_sign.sign is None
