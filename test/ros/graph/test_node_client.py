# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A node that cannot be asked: who asks is told, and does not wait."""
import queue
import threading

import pytest
from std_srvs.srv import Trigger

from mhri.graph.ros import node_client
from mhri.graph.ros.node_client import call, NodeClient


@pytest.mark.parametrize('wait_s', [0.0, 0.3])
def test_without_an_answer_there_is_none_and_it_is_said(wait_s):
    said = []
    assert call('/nobody/asks', Trigger, wait_s=wait_s,
                log=lambda *words: said.append(words[1])) is None
    assert said == ['/nobody/asks']


def test_a_request_does_not_wait_for_its_answer(monkeypatch):
    node, answers, answered = NodeClient('asking'), queue.Queue(), threading.Event()
    monkeypatch.setattr(node_client, 'call', lambda *_, **__: answered.wait(60.0))
    node.request(answers.put, '/nobody/asks', Trigger)
    assert answers.empty()
    answered.set()
    assert answers.get(timeout=60.0) is True
    node.close()


def test_jobs_are_done_in_their_order_one_at_a_time():
    node, done = NodeClient('working'), queue.Queue()
    for number in range(100):
        node.do(done.put, number)
    assert [done.get(timeout=60.0) for _ in range(100)] == list(range(100))
    node.close()


class Topic:
    """A topic that counts how often it is unregistered."""

    def __init__(self, *_, **__):
        self.ended = 0

    def unregister(self):
        self.ended += 1


def test_a_topic_opened_while_the_client_is_closed_is_unregistered(monkeypatch):
    monkeypatch.setattr('rospy.Publisher', Topic)
    node = NodeClient('closing')
    before = node.advertise('/a', None, 1)
    node.close()
    assert before.ended == 0, 'a program that ends unregisters nothing'
    node.unregister()
    assert before.ended == 1 and node.advertise('/b', None, 1).ended == 1
    node.unregister()
    assert before.ended == 1
