# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What is measured of a link, where it is read: in the robot's window and in its row."""
from dataclasses import replace

import pytest

from mhri.base import views
from mhri.base.views import LinkFigures, RobotView, StateView
from mhri.screen.gui.state_line import StateLine
from mhri.screen.gui.windows import window_class

FIGURES = LinkFigures(0.012, -0.314, 0.07)
VIEW = RobotView('bot1', 'TurtleBot2', link=views.LIVE, age_s=0.012, figures=FIGURES)


@pytest.mark.parametrize('figures, text', [
    (FIGURES, 'link 12 ms   clock -0.31 s   lost 7 %'), (LinkFigures(0.5), 'link 500 ms'),
    (LinkFigures(), ''), (LinkFigures(offset_s=-0.001), 'clock +0.00 s')])
def test_the_window_tells_round_trip_clock_and_loss(operator, figures, text):
    line = operator.show(StateLine())
    line.show_state(StateView((), figures=figures))
    assert ' '.join('   '.join(line.texts()).split()) == ' '.join(text.split())


@pytest.mark.parametrize('kind', ['turtlebot', 'generic'])
def test_the_window_says_whether_its_robot_is_guarded(operator, ui_dir, kind):
    window = operator.show(window_class(kind)(ui_dir, 'bot1', 'TurtleBot2'))
    for guarded, text in ((True, 'guarded TurtleBot2'), (False, 'TurtleBot2')):
        window.show_view(replace(VIEW, guarded=guarded))
        assert window.type_label.text() == text
