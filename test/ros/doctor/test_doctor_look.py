# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""How the doctor looks: what nodes say of their connections, and names that change meanwhile."""
from contextlib import contextmanager
from socketserver import ThreadingMixIn
import threading
import time
from xmlrpc.server import SimpleXMLRPCServer

from mhri.doctor.facts import ANSWERS, Connection
from mhri.doctor.ros import examination as doctor, files
from mhri.doctor.ros.probe import Probe

TO = 'TCPROS connection on port 41374 to [{} on socket 6]'


class Server(ThreadingMixIn, SimpleXMLRPCServer):
    """Answers several at once."""

    daemon_threads = True


@contextmanager
def served(instance):
    """Yield the URI at which an object is called."""
    server = Server(('127.0.0.1', 0), logRequests=False)
    server.register_multicall_functions()
    server.register_instance(instance)
    threading.Thread(target=server.serve_forever, kwargs={'poll_interval': 0.01},
                     daemon=True).start()
    try:
        yield 'http://127.0.0.1:{}'.format(server.server_address[1])
    finally:
        server.shutdown()
        server.server_close()


class Slow:
    """Answers each question at once but one, for which it takes longer than anybody waits."""

    def __init__(self):
        self.ended = threading.Event()

    def getPid(self, _):
        return 1, '', 1

    def requestTopic(self, *_):
        self.ended.wait(30.0)
        return 0, '', 0


class Master:
    """The answers of a master that nodes leave between two questions to it."""

    def __init__(self, gone=()):
        self._gone = gone

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


def test_a_node_that_goes_between_two_questions_to_the_master():
    """It is not there any more, and whatever else is wrong is told."""
    gone = ('/viewer',)
    found = examined(Master(gone))
    dead = [item.problem for item in found if item.check == 'node_dead']
    for name in ('/viewer', '/bot1/base', '/panel'):
        assert any(name in words for words in dead) == (name not in gone), found


def examined(master, **options):
    with served(master) as uri:
        return doctor.examine(environ={'ROS_MASTER_URI': uri, 'ROS_IP': '127.0.0.1'}, **options)


def test_a_slow_disk_is_not_waited_for(monkeypatch):
    """The time that robots have to answer is for reading files, too, and no more than that."""
    ended = threading.Event()
    monkeypatch.setattr(files, 'read_profiles', lambda: (ended.wait(120.0), ((), []))[1])
    begun = time.monotonic()
    try:
        found = examined(Master(), begun=begun)
    finally:
        ended.set()
    assert time.monotonic() - begun < 60.0
    assert 'node_dead' in [item.check for item in found]


def test_what_there_was_no_time_to_listen_to_is_told():
    """Nothing that is wrong with it is: that must not look as if all were well."""
    node = Slow()
    with served(node) as uri:
        probe = Probe('/doctor', time.monotonic() + 3.0)
        probe.ask('/base', uri, [('/odom', 'nav_msgs/Odometry', True),
                                 ('/other', 'std_msgs/Bool', False)])
        assert probe.result()[0]['/base'].state == ANSWERS
        assert probe.unheard == ('/odom',)
        node.ended.set()


class Publisher:
    """A node that reports its connections in a few ways."""

    SAID = [(TO.format('192.0.2.7:40623'),), (TO.format('bot1:40623'),),
            (TO.format('999.0.2.7:40623'),), ('UDPROS to nowhere',), (7,), ()]

    def getPid(self, _):
        return 1, '', 1

    def getPublications(self, _):
        return 1, '', [['/odom', 'nav_msgs/Odometry']]

    def getSubscriptions(self, _):
        return 0, 'none', 0

    def getBusInfo(self, _):
        return 1, '', [[1, '/viewer', 'o', 'TCPROS', '/odom', True, *said] for said in self.SAID]


def test_connections_are_read_from_what_a_node_reports():
    with served(Publisher()) as uri:
        probe = Probe('/doctor', time.monotonic() + 10.0)
        probe.ask('/base', uri)
        node = probe.result()[0]['/base']
    assert node.publications == {'/odom': 'nav_msgs/Odometry'} and node.subscriptions is None
    assert node.connections == tuple(
        Connection(True, '/odom', '/viewer', address)
        for address in ('192.0.2.7', '', '', '', '', ''))
