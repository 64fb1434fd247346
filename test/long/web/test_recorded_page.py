# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A recorded session in a browser: pictures, robots and events of the time that is chosen."""
import cv2
import numpy as np
import pytest

from mhri.web.io.hub import Outputs
from mhri.web.io.recorded import Recorded
from mhri.web.io.server import WebServer
from mhri.web.links import LinkBook, WATCH
from mhri.web.ros.web_node import files_of_page, new_token
from support import made_session as made
from support.browser import Browser

NAME = '2023-11-14-22-13-20'
SEEK = ('const place = document.querySelector(".player input"); place.value = arguments[0];'
        'place.dispatchEvent(new Event("input"));')
TILE = '[data-name=bot2]'


def jpeg(time_s):
    """Return a picture in a grey that says its time."""
    return cv2.imencode('.jpg', np.full((120, 160), 4 * time_s, np.uint8))[1].tobytes()


@pytest.fixture(scope='module')
def page(tmp_path_factory):
    """Yield a browser, and the address of the page of a session, without ROS."""
    home = tmp_path_factory.mktemp('home')
    folder = made.write_session(home / 'mhri' / 'sessions' / NAME)
    made.write_pictures(folder, jpeg)
    recorded = Recorded({'ROS_HOME': str(home)})
    server = WebServer(LinkBook(new_token), files_of_page(), Outputs(),
                       [('127.0.0.1', 0, None)], recorded.routes, (recorded.close,)).start()
    _, token = server.hub.do(server.hub.give, 'test', WATCH, False, False, 1.0)
    browser = Browser(str(home / 'browser'))
    try:
        yield browser, 'http://127.0.0.1:{}/t/{}?session='.format(server.ports[0], token)
    finally:
        browser.driver.quit()
        server.stop()


@pytest.fixture
def paused(page):
    """Return the browser with the session open, paused at its start."""
    browser, address = page
    browser.open(address + NAME)
    browser.wait('return document.querySelector(".player .play")?.innerText === "Pause"')
    browser.run('document.querySelector(".player .play").click()')
    browser.wait('return document.querySelector(".player .play").innerText === "Play"')
    return browser


def seek(browser, at_s):
    browser.run(SEEK, at_s)


def wait_grey(browser, time_s):
    """Wait until the picture of bot2 is the one of a time."""
    browser.wait(
        'const canvas = document.querySelector(arguments[0] + " canvas");'
        'if (!canvas || canvas.hidden || !canvas.width) return false;'
        'const [r] = canvas.getContext("2d").getImageData(80, 60, 1, 1).data;'
        'return Math.abs(r - arguments[1]) < 4', TILE, 4 * time_s)


@pytest.mark.parametrize('at_s, picture_s', [(10.5, 10), (44.0, 44), (21.0, 20)])
def test_the_picture_is_of_the_time_that_is_chosen(paused, at_s, picture_s):
    seek(paused, at_s)
    wait_grey(paused, picture_s)


def test_robots_and_events_are_those_of_the_time(paused):
    seek(paused, 10.0)
    paused.wait_text('#driving', 'bot1')
    seek(paused, 46.0)
    paused.wait('return document.querySelector(arguments[0]).dataset.level === "alarm"', TILE)
    paused.wait_text('#events', 'lost while driven')
    seek(paused, 10.0)
    paused.wait('return document.querySelector(arguments[0]).dataset.level === "calm"', TILE)
    paused.wait('return !document.querySelector("#events").innerText.includes("lost")')
    seek(paused, 33.0)
    paused.wait('return document.querySelector("#drives").classList.contains("stopped")')


def test_it_plays_on_and_ends(paused):
    seek(paused, made.LENGTH_S - 3.0)
    paused.run('document.querySelector(".player .play").click()')
    paused.wait('return document.querySelector(".player .play").innerText === "Play"')
    # Whatever has it look at the time again: the end is where it stays.
    paused.run('document.querySelector(".player .rate").click()')
    assert float(paused.run('return document.querySelector(".player input").value')) \
        > made.LENGTH_S - 1.0


def test_without_a_name_the_sessions_are_listed(page):
    browser, address = page
    browser.open(address)
    browser.wait('return document.querySelector(".sessions a[href]")')
    browser.run('document.querySelector(".sessions a[href]").click()')
    browser.wait('return document.querySelector(".player")')


def test_a_session_that_is_not_there_is_said(page):
    browser, address = page
    browser.open(address + '2001-01-01-00-00-00')
    browser.wait_text('#driving', '2001-01-01-00-00-00')
    browser.wait('return document.querySelector("#driving").innerText.includes("cannot")')
