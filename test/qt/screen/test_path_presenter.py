# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The committed path on the picture: while the link is slow, the camera known, the picture live."""
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from mhri.base import views
from mhri.base.accessories import Accessory, HEAD
from mhri.base.gui import theme
from mhri.base.limits import Velocity
from mhri.base.view_rows import FLOOR_CAMERA
from mhri.base.views import AccessoryView, LinkFigures, RobotView
from mhri.screen.gui.windows import TurtleBotWindow
from mhri.screen.presenters.path_presenter import LOOK_S, PathPresenter
from mhri.sensors.floor import level_camera
from mhri.sensors.point_cloud import Lens
from support.clock import Clock
from support.scenes import frame_of, pixels_of

CAMERA = level_camera(0.0, 0.3, Lens(554.0, 554.0, 319.5, 239.5, 640, 480))
SLOW = RobotView('bot1', link=views.LIVE, sent=Velocity(0.5), figures=LinkFigures(0.8))


class Feeds:
    """The feeds of a robot whose camera is known as soon as somebody wants to know."""

    def __init__(self, camera=CAMERA):
        self.robot_type, self.frames = SimpleNamespace(radius_m=0.18), None
        self._feed = SimpleNamespace(take=lambda frames: camera)
        self.wanted = frozenset()

    def get(self, key):
        """Return the feed that is open."""
        return self._feed if key in self.wanted else None


class Drawn:
    """A tile with a picture, its presenter of the path, and time."""

    def __init__(self, window, feeds):
        self.clock, self.feeds, self.window = Clock(), feeds, window
        self.presenter = PathPresenter(window, self.clock)

    def draw(self, view, times=1, every_s=0.1):
        """Draw a view again and again; return the path in the picture, None for none."""
        for _ in range(times):
            self.clock.now += every_s
            self.feeds.wanted = self.presenter.update(view)
            self.presenter.draw(self.feeds)
        return self.window.view('rgb').picture.path


@pytest.fixture
def window(operator, ui_dir):
    made = TurtleBotWindow(ui_dir, 'bot1', 'TurtleBot2')
    made.offer({'rgb', 'cloud'})
    made.resize(900, 640)
    operator.show(made)
    made.view('rgb').show_frame(frame_of((120, 120, 120)))
    operator.settle()
    return made


def blue_rows(window, operator):
    """Return the rows of the picture, as shares, with the colour of the path."""
    operator.settle()
    picture = window.view('rgb').picture
    pixels, ink = pixels_of(picture).astype(int), theme.colour(theme.DRIVE, picture.palette())
    same = np.abs(pixels - (ink.red(), ink.green(), ink.blue())).sum(axis=2) < 20
    rows = np.flatnonzero(same.sum(axis=1) > 1)
    return (rows - picture.target().top()) / picture.target().height()


def test_it_lies_on_the_floor_while_the_link_is_slow(window, operator):
    drawn = Drawn(window, Feeds())
    assert drawn.draw(SLOW, 10).visible
    rows = blue_rows(window, operator)
    assert 0.52 < rows.min() < 0.65 and rows.max() > 0.95, 'below the horizon, up to 3 m ahead'
    assert drawn.draw(replace(SLOW, figures=LinkFigures(0.1))) is None
    assert len(blue_rows(window, operator)) == 0
    assert drawn.draw(SLOW).visible
    picture = window.view('rgb').picture
    picture.show_warning('OLD PICTURE, 2.0 s')
    old = picture.grab().toImage()
    picture.show_path(None)
    assert picture.grab().toImage() == old, 'on an old picture it would be wrong'


@pytest.mark.parametrize('changes', [
    {'sent': None}, {'sent': Velocity()}, {'link': views.SILENT}, {'odometry_follows': False},
    {'also_commanded_by': ('/other',)}, {'figures': LinkFigures()}])
def test_without_certainty_there_is_none(window, changes):
    drawn = Drawn(window, Feeds())
    assert drawn.draw(SLOW, 10) is not None
    assert drawn.draw(replace(SLOW, **changes), 10) is None


def test_after_a_stop_it_shrinks_as_the_robot_receives_it(window):
    drawn = Drawn(window, Feeds())
    drawn.draw(SLOW, 20)
    stopped, lengths = replace(SLOW, sent=Velocity()), []
    for _ in range(10):
        path = drawn.draw(stopped)
        lengths.append(0.0 if path is None else path.onward[0][-1][1])
    assert lengths[0] > 0.0 and lengths[-1] == 0.0


def test_the_camera_is_looked_for_while_it_is_needed_and_not_for_ever(window):
    drawn = Drawn(window, Feeds(camera=None))
    drawn.draw(replace(SLOW, figures=LinkFigures(0.1)))
    assert drawn.feeds.wanted == frozenset()
    assert drawn.draw(SLOW, 5) is None and drawn.feeds.wanted == {FLOOR_CAMERA}
    drawn.draw(SLOW, 10, LOOK_S / 8.0)
    assert drawn.feeds.wanted == frozenset()


@pytest.mark.parametrize('known, place', [
    (True, (0.3, 0.0)), (True, (0.0, -0.1)), (False, ())])
def test_while_the_camera_is_turned_there_is_none(window, known, place):
    """A line on the floor would lie elsewhere; without a report it may be turned."""
    head = AccessoryView(Accessory('head', key=HEAD, ranges=((-1.5, 1.5), (-0.3, 0.3)),
                                   neutral=(0.0, 0.0)), True, value=(0.0, 0.0))
    drawn = Drawn(window, Feeds())
    ahead = replace(SLOW, accessories=(head,))
    assert drawn.draw(ahead, 10) is not None
    turned = replace(SLOW, accessories=(replace(head, known=known, value=place),))
    assert drawn.draw(turned) is None and drawn.feeds.wanted == frozenset()
    # Where it looks then is not remembered for later.
    drawn.feeds = Feeds(None)
    assert drawn.draw(ahead, 10) is None and drawn.feeds.wanted == {FLOOR_CAMERA}
    drawn.feeds = Feeds()
    assert drawn.draw(ahead) is not None
