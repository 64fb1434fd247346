# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What the screen says of itself, and a link given and taken back by clicks on the real screen."""
import http.cookiejar
import ssl
import urllib.error
import urllib.request

import pytest

from support.panel_session import PanelSession

TIMEOUT_S = 120.0


@pytest.fixture(scope='module')
def session():
    running = PanelSession([('sim.launch', 'n:=2')], ['bot1', 'bot2'])
    running.system.node('mhri_web', '_port:=0', '_local_port:=0')
    yield running
    running.close()


@pytest.fixture
def said(session):
    """Return a list that holds the newest ``mhri/PanelState``."""
    import rospy
    from mhri.msg import PanelState
    newest = []

    def keep(message):
        newest[:] = [message]
    subscriber = rospy.Subscriber('/panel/state', PanelState, keep)
    session.until(lambda: newest and len(newest[0].robots) == 2, TIMEOUT_S, 'the state')
    yield newest
    subscriber.unregister()


def test_the_screen_says_what_it_shows(session, said):
    tiles = session.presenter.windows
    session.until(lambda: {'bot1', 'bot2'} <= set(tiles), TIMEOUT_S, 'the tiles')
    session.hands.click('check_bot1')
    session.until(lambda: [robot.selected for robot in said[0].robots] == [True, False]
                  and 'bot1' in said[0].driving and said[0].mode, TIMEOUT_S, 'the selection')
    assert [(robot.name, robot.number) for robot in said[0].robots] == [('bot1', 1), ('bot2', 2)]
    session.operator.stop_all()
    session.until(lambda: said[0].stop_all and all(
        robot.state == tiles[robot.name].drive_state != '' for robot in said[0].robots),
        TIMEOUT_S, 'the stop, in the words of the tiles')
    session.operator.release()
    session.until(lambda: not said[0].stop_all, TIMEOUT_S, 'the release')


def unverified():
    """Return a context for a certificate that the server made itself."""
    context = ssl.create_default_context()
    context.check_hostname, context.verify_mode = False, ssl.CERT_NONE
    return context


def status_of(url):
    """Return the status of a page, with the cookie that it gives."""
    opener = urllib.request.build_opener(
        urllib.request.HTTPCookieProcessor(http.cookiejar.CookieJar()),
        urllib.request.HTTPSHandler(context=unverified()))
    try:
        with opener.open(url, timeout=TIMEOUT_S) as answer:
            return answer.status
    except urllib.error.HTTPError as error:
        return error.code


def test_a_link_is_given_and_taken_back_by_clicks(session):
    part = session.presenter.parts['web']
    session.presenter.screen.arrangement.show_page(part.page)
    session.until(lambda: part.page.new_button.isVisible(), TIMEOUT_S, 'the server')
    session.hands.click('web_new_button', part.page)
    session.until(lambda: part.card.isVisible(), TIMEOUT_S, 'the code')
    url = part.card.code.toolTip()
    assert status_of(url) == 200
    session.hands.click('web_close_button', part.card)
    session.hands.click('web_take_button', part.page)
    session.until(lambda: status_of(url) == 403, TIMEOUT_S, 'the link to be taken back')
