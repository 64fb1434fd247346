# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Connects the page for other devices to the screen: what it shows, its links and its viewers.

Everything here runs on the GUI thread and never blocks.
"""
import time

from mhri.base.part import Part, SETUP
from mhri.base.views import ROS_CONNECTED
from mhri.camera.ros.picture_relay import PICTURE_RELAY
from mhri.web.gui.code_card import CodeCard
from mhri.web.gui.links_page import LinksPage, TITLE
from mhri.web.presenters.panel_state import panel_state
from mhri.web.ros.web_client import code_of, WebClient
from mhri.web.view import CHOICES

PERIOD_S = 0.2


class WebPresenter(Part):
    """The page of one screen.

    :param screen: :class:`mhri.screen.gui.screen.ScreenWidget`
    :param picture_of: function from a robot's name to (topic, age [s]) of the picture in its tile
    :param place_of: function from a robot's name to (pose on the map, age [s])
    :param client: :class:`mhri.web.ros.web_client.WebClient`
    :param clocks: functions that return monotonic time and time of day [s]
    """

    @classmethod
    def of(cls, context):
        """Create it from a :class:`mhri.base.part.ScreenContext`; a replay has none."""
        if not context.backend.speaks:
            return Part()
        the_map = context.parts.get('map')
        return cls(context.screen, context.tiles.picture_of,
                   the_map.place_of if the_map else lambda name: (None, None), WebClient())

    def __init__(self, screen, picture_of, place_of, client, clocks=(time.monotonic, time.time)):
        self._picture_of, self._place_of = picture_of, place_of
        self._client = client
        self._clock, self._wall = clocks
        self._started = False
        self._due_s = 0.0
        # {id: URL} of the links that were made on this screen: the server keeps no tokens.
        self._urls = {}
        self._wanted = ''
        self.page = LinksPage()
        self.card = CodeCard(screen.side)
        screen.arrangement.add_section(SETUP, TITLE, self.page, 20, 'tablet-smartphone')
        self._connect()

    def _connect(self):
        """Connect the requests."""
        self.page.new_requested.connect(self._give)
        self.page.take_requested.connect(self._take)
        self.page.code_requested.connect(self._show_code)

    def _give(self, choice, label, head, hours):
        words, role, may_stop = CHOICES[choice]
        self._client.give(label or words, role, may_stop, head, float(hours))

    def _take(self, of):
        self._urls.pop(of, None)
        self._client.take(of)

    def show_view(self, view):
        """Handle a :class:`mhri.base.views.ScreenView`; call it on each redraw."""
        if view.ros != ROS_CONNECTED:
            return
        if not self._started:
            self._started = True
            self._client.start()
        web, now_s = self._client.view(), self._wall()
        while not self._client.answers.empty():
            self._show_answer(*self._client.answers.get())
        if self.page.isVisible():
            self.page.show_web(web, now_s, self._urls)
        link = next((link for link in web.links if link.id == self._wanted), None)
        if link is not None:
            self._wanted = ''
            url = self._urls[link.id]
            self.card.show_link(link.label, link.words(now_s), url, code_of(url))
        # Of several screens, the one in control says what it shows.
        if view.control.ours and self._client.wanted and self._clock() >= self._due_s:
            self._due_s = self._clock() + PERIOD_S
            self._client.publish(panel_state(view, self._picture, self._place_of))

    def _picture(self, name):
        topic, age_s = self._picture_of(name)
        return PICTURE_RELAY.name_of(topic), age_s

    def _show_answer(self, asked, done, text, link, url):
        """Show the outcome of a request; a new link at once."""
        self.page.show_answer('' if done else text, done)
        if url:
            self._urls[link] = url
            self._show_code(link)

    def _show_code(self, link):
        """Show the code of a link, once the server reports it."""
        self._wanted = link if link in self._urls else ''

    def close(self, forget=False):
        """Unregister everything; returns at once."""
        self._client.close(forget)
