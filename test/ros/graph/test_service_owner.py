# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Whose words count, with a master that is told what to answer, and messages made by hand."""
import threading

import pytest
import rospy
from std_msgs.msg import String

from mhri.graph.ros import service_owner
from mhri.graph.ros.master_api import MasterError
from mhri.graph.ros.service_owner import MAX_WAITING, RejectedSenders, ServiceOwner

from support.ros_system import wait_for

SERVICE, TOPIC = '/mux/set_stop_all', '/mux/mode'


class Master:
    """Says who serves the service; ``asked`` counts lookups, ``graphs`` the whole graph."""

    def __init__(self):
        self.server, self.uri, self.fails = None, None, False
        self.asked = self.graphs = 0

    def serve(self, name, uri='rosrpc://a:1'):
        self.server, self.uri = name, uri

    def call_many(self, calls):
        self.asked += 1
        if self.fails:
            raise MasterError('gone')
        return [self.uri]

    def call(self, method):
        self.graphs += 1
        return [[], [], [[SERVICE, [self.server]]] if self.server else []]


@pytest.fixture
def master(monkeypatch):
    made, done = Master(), threading.Event()
    monkeypatch.setattr(service_owner, 'MasterApi', lambda *_, **__: made)
    monkeypatch.setattr(service_owner, 'ASK_S', 0.01)
    monkeypatch.setattr(rospy, 'is_shutdown', done.is_set)
    yield made
    done.set()


@pytest.fixture
def topic(master, monkeypatch):
    """(the owner, what is heard, a function that says something, the strangers)."""
    callbacks, heard, strangers = [], [], RejectedSenders()
    monkeypatch.setattr(rospy, 'Subscriber',
                        lambda name, kind, callback, **_: callbacks.append(callback))
    owner = ServiceOwner(SERVICE, strangers.refuse)
    owner.subscribe(TOPIC, String, lambda message: heard.append(message.data))

    def say(caller, text, link=None):
        message = String(text)
        message._connection_header = link or {'callerid': caller}
        callbacks[0](message)
    yield owner, heard, say, strangers
    owner.stop()


def test_a_word_that_came_before_it_was_known_who_is_in_force_is_not_lost(master, topic):
    """Latched words come only once."""
    owner, heard, say, _ = topic
    say('/mux', 'old')
    say('/mux', 'pedal')
    say('/stranger', 'voice')
    master.serve('/mux')
    owner.start()
    wait_for(lambda: heard == ['pedal'], 10.0, 'the word')


def test_a_stranger_is_refused_and_counted(master, topic):
    owner, heard, say, strangers = topic
    master.serve('/mux')
    owner.start()
    wait_for(lambda: owner.caller == '/mux', 10.0, 'the mux')
    for _ in range(3):
        say('/stranger', 'voice')
    say('/mux', 'pedal')
    assert heard == ['pedal']
    assert strangers.words() == ['/stranger: /mux/mode, 3 times']


def test_the_words_of_a_newer_one_wait_until_the_master_knows_it(master, topic):
    owner, heard, say, _ = topic
    master.serve('/mux')
    owner.start()
    wait_for(lambda: owner.caller == '/mux', 10.0, 'the mux')
    master.fails = True
    say('/mux_2', 'joy')
    master.serve('/mux_2', 'rosrpc://a:2')
    master.fails = False
    say('/stranger', 'voice')
    wait_for(lambda: heard == ['joy'], 10.0, 'the word of the newer mux')
    say('/mux', 'pedal')
    assert heard == ['joy'] and owner.caller == '/mux_2'


def test_without_a_master_the_one_that_is_known_stays(master, topic):
    owner, heard, say, _ = topic
    master.serve('/mux')
    owner.start()
    wait_for(lambda: owner.caller == '/mux', 10.0, 'the mux')
    master.fails = True
    say('/stranger', 'voice')
    say('/mux', 'pedal')
    assert heard == ['pedal'] and owner.caller == '/mux'


def test_a_stranger_costs_the_master_little_and_leaves_nothing(master, topic):
    """However often it speaks: a lookup now and then, never the whole graph, and no memory."""
    owner, heard, say, _ = topic
    master.serve('/mux')
    owner.start()
    wait_for(lambda: owner.caller == '/mux', 10.0, 'the mux')
    for number in range(200):
        say('/stranger{}'.format(number % 20), 'x' * 1000)
    assert owner.waiting() <= MAX_WAITING
    wait_for(lambda: not owner.waiting(), 10.0, 'it to be forgotten')
    assert master.graphs == 1 and heard == []


def test_another_process_of_the_same_name_is_news(master, topic):
    news = []
    owner = ServiceOwner(SERVICE, on_new=news.append)
    master.serve('/mux')
    owner.start()
    wait_for(lambda: news == ['/mux'], 10.0, 'the mux')
    links = [{'callerid': '/mux'}, {'callerid': '/mux'}]
    for link in links:
        message = String('x')
        message._connection_header = link
        assert owner.accepts(message, TOPIC)
    assert news == ['/mux', '/mux']
    owner.stop()


def test_names_of_strangers_are_bounded():
    strangers = RejectedSenders()
    for number in range(1000):
        strangers.refuse('/{}'.format(number) + 'x' * 1000, TOPIC)
    words = strangers.words()
    assert len(words) == service_owner.MAX_STRANGERS and max(map(len, words)) < 300
    strangers.clear()
    assert strangers.words() == []


def test_a_stranger_that_has_gone_is_forgotten():
    strangers = RejectedSenders()
    for caller, topic in (('/a', 'twist'), ('/a', 'robot_select'), ('/b', 'robot_select')):
        strangers.refuse(caller, topic)
    strangers.forget('/a')
    assert strangers.words() == ['/b: robot_select, 1 times']
