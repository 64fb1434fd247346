# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The simulated robot's cloud in its tile, from the wire to the screen."""
import os
import sys

import numpy as np
import pytest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..'))

from mhri.sensors.cloud_picture import COLOUR, TABLE  # noqa: E402
from support.panel_session import PanelSession  # noqa: E402

# The robot looks at the red column.
POSE = (9.1, 1.4, -0.12)


@pytest.fixture(scope='module')
def session():
    running = PanelSession((
        ('turtlebot.launch', 'name:=bot1', 'type:=turtlebot2', 'x:={}'.format(POSE[0]),
         'y:={}'.format(POSE[1]), 'yaw:={}'.format(POSE[2])),), ('bot1',))
    yield running
    running.close()


def test_the_cloud_is_seen_and_costs_nothing_when_it_is_not(session):
    window = session.open('bot1')
    session.switch(window, 'view_cloud', True)
    view = window.view('cloud')
    session.until(lambda: view.canvas.picture is not None, what='a cloud')
    assert view.frame_id == 'bot1/camera_rgb_optical_frame'
    shown = np.isin(view.canvas.picture.pixels, TABLE).mean()
    assert shown > 0.02, shown
    session.until(lambda: ' points  ' in view.status_label.text(), what='the figures')
    view.restore_settings({'colouring': COLOUR})
    session.until(lambda: is_red(view), what='the red column in its colour')
    feeds = session.operator.feeds('bot1')
    session.until(lambda: feeds.bits_per_s() > 1e6, what='the network that it takes')
    session.switch(window, 'view_cloud', False)
    session.until(lambda: feeds.get('cloud') is None, what='the end of the feed')


def is_red(view):
    """Tell whether there is more red than a speck."""
    picture = view.canvas.picture.pixels
    red, green, blue = (picture >> shift & 255 for shift in (16, 8, 0))
    return ((red > 2 * green) & (red > 2 * blue) & (red > 90)).sum() > 20
