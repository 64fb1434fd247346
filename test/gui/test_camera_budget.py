# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The camera budget on the screen: the driven robot keeps its picture, others say why not."""
import os
import sys

import pytest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..'))

from support.panel_session import PanelSession  # noqa: E402

BUDGET = '/mhri/panel/camera_budget_mbit_s'
PATIENCE_S = 60.0


@pytest.fixture(scope='module')
def session():
    running = PanelSession((('sim.launch', 'n:=2'),), ('bot1', 'bot2'))
    running.until(lambda: {'bot1', 'bot2'} <= set(running.host.windows), what='the tiles')
    yield running
    running.close()


def words(session, name):
    """Return what a robot's tile says over its picture."""
    return session.host.windows[name].hud.sentence


def grants(session, name):
    """Return the words of a robot's camera, None while it has none."""
    feeds = session.operator.feeds(name)
    feed = feeds.get('rgb') if feeds else None
    return None if feed is None or feed.age_s() is None else feed.status().thinned


def test_the_driven_robot_keeps_its_picture_and_the_other_says_why_not(session):
    import rospy
    session.until(lambda: grants(session, 'bot1') == '' == grants(session, 'bot2'), PATIENCE_S,
                  'both pictures')
    session.operator.select(['bot1'])
    # Next to nothing: less than the driven robot alone.
    rospy.set_param(BUDGET, 0.01)
    session.until(lambda: words(session, 'bot2') == 'paused: camera budget', PATIENCE_S,
                  'what the tile says')
    assert grants(session, 'bot1') == '' and 'budget' not in words(session, 'bot1')
    session.until(lambda: session.operator.feeds('bot2').get('rgb').status().bits_per_s == 0.0,
                  PATIENCE_S, 'nothing on the network')
    # Said once, and by name.
    session.until(lambda: any('driven robots alone take' in event.text
                              for event in session.host.events.log.events), PATIENCE_S, 'the note')
    # It is the other's turn.
    session.operator.select(['bot2'])
    session.until(lambda: words(session, 'bot1') == 'paused: camera budget', PATIENCE_S)
    session.until(lambda: 'budget' not in words(session, 'bot2'), PATIENCE_S)
    rospy.set_param(BUDGET, 0)
    session.until(lambda: 'budget' not in words(session, 'bot1'), PATIENCE_S)
    session.until(lambda: session.operator.feeds('bot1').get('rgb').status().age_s < 1.0,
                  PATIENCE_S, 'a new picture')


def cloud(session):
    """Return the feed of bot1's point cloud, None while it has none."""
    feeds = session.operator.feeds('bot1')
    return feeds.get('cloud') if feeds else None


def test_a_point_cloud_keeps_to_the_budget_and_the_tile_says_so(session):
    import rospy
    session.operator.select(['bot1'])
    window = session.open('bot1')
    session.switch(window, 'camera_off')
    session.switch(window, 'view_cloud')
    session.until(lambda: cloud(session) and cloud(session).age_s() is not None, PATIENCE_S,
                  'a cloud')
    rospy.set_param(BUDGET, 0.01)
    session.until(lambda: 'camera budget' in words(session, 'bot1'), PATIENCE_S, 'what is said')
    assert words(session, 'bot1').startswith('point cloud ')
    rospy.set_param(BUDGET, 0)
    session.until(lambda: 'budget' not in words(session, 'bot1'), PATIENCE_S)
    session.until(lambda: cloud(session).age_s() < 1.0, PATIENCE_S, 'a new cloud')


def test_small_tiles_are_decoded_no_wider_than_the_lab_wants(session):
    import rospy
    session.host.screen.look_at('bot1')

    def width():
        camera = session.host.windows['bot2'].view('rgb')
        return camera.picture.frame.rgb.shape[1] if camera.picture.frame else 0
    session.until(lambda: width() > 64, PATIENCE_S, 'a picture')
    rospy.set_param('/mhri/panel/thumbnail_width_px', 64)
    session.until(lambda: 0 < width() <= 64, PATIENCE_S, 'a smaller one')
    rospy.set_param('/mhri/panel/thumbnail_width_px', 640)
    session.until(lambda: width() > 64, PATIENCE_S, 'a larger one')
