# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Links are given and taken back by real clicks; the code of a new one covers the drawer alone."""
import queue
import time

import numpy as np
import pytest
from python_qt_binding.QtCore import Qt
from python_qt_binding.QtGui import QGuiApplication
from python_qt_binding.QtTest import QTest
from python_qt_binding.QtWidgets import QAbstractButton, QWidget
from support.paths import RESOURCE
from support.scenes import pixels_of, place_in, Scene, TINY

from mhri.base.geometry import Pose
from mhri.web.presenters.web_presenter import WebPresenter
from mhri.web.ros.web_client import code_of
from mhri.web.view import LinkView, ViewerView, WebView

URL = 'https://192.168.20.117:8443/t/0123456789abcdefghijkl'
NOW = time.time()
LINK = LinkView('a', 'Maria', 'watch', True, False, NOW + 3600.0)
DRIVES = LinkView('b', 'Tablet in the hall', 'drive', True, True, NOW + 7200.0)
VIEWERS = (ViewerView('v1', 'Maria', '192.168.20.31', NOW - 600.0, False, True),
           ViewerView('v2', 'Tablet in the hall', '192.168.20.32', NOW - 60.0, True, False))
RUNNING = WebView(True, 'https://192.168.20.117:8443', '', (LINK, DRIVES), VIEWERS)


class Client:
    """Stands in for the client of mhri_web."""

    def __init__(self):
        self.web, self.wanted, self.answers = WebView(), False, queue.Queue()
        self.asked, self.published = [], []

    def start(self):
        pass

    def view(self):
        return self.web

    def give(self, *words):
        self.asked.append(words)

    def take(self, of):
        self.asked.append(of)

    def publish(self, state):
        self.published.append(state)


class Desk:
    """A screen with the part `web`, its section unfolded."""

    def __init__(self, operator, size=(1280, 720)):
        self.scene = Scene(operator.application, str(RESOURCE), size, 3)
        self.screen, self.client, self.operator = self.scene.screen, Client(), operator
        self.screen.setAttribute(Qt.WA_DontShowOnScreen, False)
        self.part = WebPresenter(
            self.screen, lambda name: ('/{}/image'.format(name), 0.1),
            lambda name: (Pose(1.0, 2.0, 0.5), None) if name == 'bot1' else (None, None),
            self.client)
        self.scene.show()
        self.screen.arrangement.show_page(self.part.page)
        operator.settle()
        self.show(WebView())

    def show(self, web):
        self.client.web = web
        self.part.show_view(self.scene.view)
        self.operator.settle()

    def named(self, name):
        return [part for part in self.screen.findChildren(QWidget, name) if part.isVisible()]

    def click(self, name, place=0):
        button = self.named(name)[place]
        scroll = button.parentWidget()
        while scroll is not None and not hasattr(scroll, 'ensureWidgetVisible'):
            scroll = scroll.parentWidget()
        if scroll is not None:
            scroll.ensureWidgetVisible(button)
        self.operator.settle()
        self.operator.click(button)
        self.operator.settle()


@pytest.fixture
def desk(operator):
    made = Desk(operator)
    yield made
    made.screen.close()


def test_without_the_server_there_is_one_quiet_line(desk):
    assert not desk.named('web_new_button') and desk.part.page.address.isVisible()
    assert not desk.part.page.problem.isVisible()
    desk.show(RUNNING)
    assert desk.named('web_new_button')
    desk.show(WebView())
    assert not desk.named('web_new_button') and not desk.named('web_take_button')


@pytest.mark.parametrize('place, head, name, asked', [
    (0, False, 'Maria', ('Maria', 'watch', False, False, 12.0)),
    (1, True, '', (None, 'watch', True, False, 12.0)),
    (2, True, 'Tablet', ('Tablet', 'drive', True, True, 12.0))])
def test_a_new_link_is_what_was_chosen(desk, place, head, name, asked):
    desk.show(RUNNING)
    page = desk.part.page
    page.choice.setCurrentIndex(place)
    if head:
        desk.click('web_head')
    QTest.keyClicks(page.name, name)
    desk.click('web_new_button')
    (label, *rest), = desk.client.asked
    assert tuple(rest) == asked[1:] and label == (asked[0] or page.choice.currentText())


def test_a_link_is_taken_back_and_a_viewer_sent_away(desk):
    desk.show(RUNNING)
    desk.click('web_take_button', 1)
    desk.click('web_away_button', 0)
    assert desk.client.asked == ['b', 'v1']
    desk.show(WebView(True, RUNNING.address, '', (LINK,), VIEWERS[1:]))
    assert len(desk.named('web_take_button')) == len(desk.named('web_away_button')) == 1
    # No code of a link of which this screen does not know the address.
    assert not desk.named('web_code_button')


def read_code(pixels, widget, window, count):
    """Return the modules of a QR code on a screen, True for dark, and the width of one [px]."""
    place = place_in(window, widget)
    part = pixels[place.top():place.bottom() + 1, place.left():place.right() + 1].min(axis=2)
    rows, columns = (np.flatnonzero((part == 255).any(axis=axis)) for axis in (1, 0))
    px = (rows[-1] - rows[0] + 1) / count
    inside = part[rows[0]:rows[-1] + 1, columns[0]:columns[-1] + 1]
    middle = ((np.arange(count) + 0.5) * px).astype(int)
    return (inside[np.ix_(middle, middle)] == 0).tolist(), px


@pytest.mark.parametrize('size, percent', [((1280, 720), 100), (TINY, 100), (TINY, 200)])
def test_the_code_of_a_new_link_can_be_read_and_leaves_pictures_and_stop_all_free(
        operator, size, percent):
    desk = Desk(operator, size)
    if percent != 100:
        desk.screen.arrangement.choose_text_size(percent)
        operator.settle()
    desk.show(RUNNING)
    desk.client.answers.put(('give', True, '', 'a', URL))
    desk.show(RUNNING)
    card, screen = desk.part.card, desk.screen
    modules, px = read_code(pixels_of(screen), card.code, screen, len(code_of(URL)))
    assert card.isVisible() and modules == code_of(URL) and px >= 3
    for part in (screen.stop_bar, screen.stage, screen.foot):
        assert not place_in(screen, card).intersects(place_in(screen, part))
    desk.click('web_copy_button')
    assert QGuiApplication.clipboard().text() == URL
    desk.click('web_close_button')
    assert not card.isVisible()
    desk.click('web_code_button')
    desk.show(RUNNING)
    assert card.isVisible()
    screen.close()


def test_a_refusal_is_shown_in_its_place(desk):
    desk.show(RUNNING)
    desk.client.answers.put(('give', False, 'too many links', '', ''))
    desk.show(RUNNING)
    assert desk.part.page.answer.text() == 'too many links' and not desk.part.card.isVisible()


def test_what_the_screen_shows_is_published_only_while_it_is_wanted(desk):
    desk.show(RUNNING)
    assert desk.client.published == []
    desk.client.wanted = True
    desk.show(RUNNING)
    desk.show(RUNNING)
    state, = desk.client.published
    driven, lost = state.robots[0], state.robots[2]
    assert (driven.name, driven.number, driven.selected, driven.level) == ('bot1', 1, True, 'calm')
    assert (lost.level, lost.picture) == ('alarm', '/bot3/image') and lost.reason in state.worst
    assert driven.placed and (driven.x, driven.y) == (1.0, 2.0) and not lost.placed


def test_every_button_is_named_for_a_screen_reader(desk):
    desk.show(RUNNING)
    names = [button.accessibleName() for button in desk.part.page.findChildren(QAbstractButton)
             if button.objectName() in ('web_take_button', 'web_away_button')]
    assert len(set(names)) == len(names) == 4


def test_a_code_is_a_square_with_a_quiet_margin():
    rows = code_of(URL)
    assert {len(row) for row in rows} == {len(rows)} and not any(map(any, rows[:4]))
