# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""How the doctor looks: what nodes say of their connections, and names that change meanwhile."""
import threading
import time
from xmlrpc.server import SimpleXMLRPCServer

import pytest

from mhri.core.doctor.facts import Connection, Facts, Node
from mhri.ros.doctor import examination as doctor
from mhri.ros.doctor.probe import _connections
from mhri.ros.graph.master_api import MasterError

TO = 'TCPROS connection on port 41374 to [{} on socket 6]'


@pytest.mark.parametrize('words, address', [
    ([TO.format('192.0.2.7:40623')], '192.0.2.7'), ([TO.format('bot1:40623')], ''),
    ([TO.format('999.0.2.7:40623')], ''), (['UDPROS to nowhere'], ''), ([None], ''), ([], '')])
def test_address_of_the_other_end(words, address):
    entry = [1, '/viewer', 'o', 'TCPROS', '/odom', True] + words
    assert _connections([entry]) == (Connection(True, '/odom', '/viewer', address),)


def watch(monkeypatch, *answers, limit_s=5.0):
    """Return where a node is registered in the end, and how often the master was asked."""
    answers = list(answers)
    asked = []

    def uris(*_):
        asked.append(1)
        answer = answers.pop(0) if len(answers) > 1 else answers[0]
        if answer is None:
            raise MasterError('gone')
        return {'/base': answer} if answer else {}
    monkeypatch.setattr(doctor, '_uris', uris)
    monkeypatch.setattr(doctor, 'WATCH_EACH_S', 0.001)
    facts = Facts(nodes={'/base': Node('/base', 'http://a:1/', uri_later='http://a:1/')})
    seen = doctor._watch_names(facts, None, time.monotonic() + limit_s)
    return seen.nodes['/base'].uri_later, len(asked)


def test_name_that_changes_is_seen_at_once(monkeypatch):
    assert watch(monkeypatch, 'http://a:1/', '', 'http://b:2/', 'http://a:1/') == (
        'http://b:2/', 3)


def test_name_is_watched_until_the_end(monkeypatch):
    begun = time.monotonic()
    uri, asked = watch(monkeypatch, 'http://a:1/', limit_s=1.0)
    assert uri == 'http://a:1/' and asked > 3 and 1.0 <= time.monotonic() - begun < 30.0
    assert watch(monkeypatch, 'http://a:1/', limit_s=-1.0) == ('http://a:1/', 0)


def test_master_that_ends_meanwhile(monkeypatch):
    assert watch(monkeypatch, 'http://a:1/', None) == ('http://a:1/', 2)


class Master:
    """The answers of a master that a node leaves between two questions to it."""

    def __init__(self, gone):
        self._gone = gone
        self.server = SimpleXMLRPCServer(('127.0.0.1', 0), logRequests=False)
        self.server.register_multicall_functions()
        self.server.register_instance(self)
        threading.Thread(target=self.server.serve_forever, kwargs={'poll_interval': 0.01},
                         daemon=True).start()
        self.uri = 'http://127.0.0.1:{}'.format(self.server.server_address[1])

    def getSystemState(self, _):
        return 1, '', [[['/bot1/odom', ['/bot1/base']], ['/bot1/cmd_vel', ['/panel']]],
                       [['/bot1/cmd_vel', ['/bot1/base', '/viewer']],
                        ['/bot1/odom', ['/panel']]], []]

    def getTopicTypes(self, _):
        return 1, '', [['/bot1/cmd_vel', 'geometry_msgs/Twist'],
                       ['/bot1/odom', 'nav_msgs/Odometry']]

    def getParam(self, _, __):
        return 1, '', {'bot1': {'robot_type': 'generic'}}

    def getPid(self, _):
        return 1, '', 1

    def lookupNode(self, _, name):
        if name in self._gone:
            return -1, 'unknown node', ''
        return 1, '', 'http://127.0.0.1:9/'


@pytest.mark.parametrize('gone', [
    ('/viewer',), ('/bot1/base',), ('/panel',), ('/viewer', '/bot1/base', '/panel')])
def test_a_node_that_goes_between_two_questions_to_the_master(gone):
    """It is not there any more, and whatever else is wrong is told."""
    master = Master(gone)
    try:
        found = doctor.examine(environ={'ROS_MASTER_URI': master.uri, 'ROS_IP': '127.0.0.1'})
    finally:
        master.server.shutdown()
        master.server.server_close()
    dead = [item.problem for item in found if item.check == 'node_dead']
    for name in ('/viewer', '/bot1/base', '/panel'):
        assert any(name in words for words in dead) == (name not in gone), found
