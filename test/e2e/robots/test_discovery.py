# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Looking for robots, on a real master with many registrations."""
import socket
import statistics
import threading
import time
import unittest
import xmlrpc.client
from xmlrpc.server import SimpleXMLRPCRequestHandler, SimpleXMLRPCServer

import rosgraph
import rospy

from mhri.graph.ros.master_api import MasterApi
from mhri.graph.ros.parallel_calls import connectable
from mhri.graph.ros.resources import read_resource
from mhri.robots.discovery import parse_ignore_list
from mhri.robots.ros.graph_scan import look_for_robots
from support.node_tools import measured
from support.own_node import own_node
from support.ros_system import free_port, wait_for

system = own_node('discovery')

ROBOTS, TOPICS = 100, 20


class Node:
    """A node's address that answers, for names registered by hand."""

    def __init__(self):
        self._server = socket.socket()
        self._server.bind(('127.0.0.1', 0))
        self._server.listen(256)
        self.uri = 'http://127.0.0.1:{}/'.format(self._server.getsockname()[1])

    def close(self):
        self._server.close()


class CountingMaster:
    """Stands before the real master and counts the requests that pass."""

    def __init__(self, real):
        self.requests = []
        counting = self.requests
        proxy = xmlrpc.client.ServerProxy(real)

        class Handler(SimpleXMLRPCRequestHandler):
            rpc_paths = ('/', '/RPC2')

        class Server(SimpleXMLRPCServer):
            def _dispatch(self, method, params):
                counting.append((method, params))
                return getattr(proxy, method)(*params)

        self._server = Server(('127.0.0.1', 0), Handler, logRequests=False)
        self.uri = 'http://127.0.0.1:{}/'.format(self._server.server_address[1])
        threading.Thread(target=self._server.serve_forever, kwargs={'poll_interval': 0.01},
                         daemon=True).start()

    def close(self):
        self._server.shutdown()
        self._server.server_close()


class DiscoveryTest(unittest.TestCase):

    def setUp(self):
        self.master = rosgraph.Master('/discovery_test').handle
        self.node = Node()
        self.addCleanup(self.node.close)
        self.registered = []
        self.addCleanup(self.forget)
        self.ignore = parse_ignore_list(read_resource('discovery.yaml'), 'discovery.yaml')

    def register(self, node, topic, uri=None):
        """Register a publisher in the name of a node."""
        uri = uri or self.node.uri
        self.assertEqual(self.master.registerPublisher(node, topic, 'std_msgs/Bool', uri)[0], 1)
        self.registered.append((node, topic, uri))

    def forget(self):
        batch = xmlrpc.client.MultiCall(self.master)
        for node, topic, uri in self.registered:
            batch.unregisterPublisher(node, topic, uri)
        if self.registered:
            batch()
        for name in rospy.get_param_names():
            if name.endswith('/robot_type'):
                rospy.delete_param(name)

    def forget_listeners(self, listeners):
        batch = xmlrpc.client.MultiCall(self.master)
        for node, topic, uri in listeners:
            batch.unregisterSubscriber(node, topic, uri)
        batch()

    def names(self, candidates):
        return [candidate.name for candidate in candidates]

    def test_100_robots_with_20_topics_each_within_half_a_second(self):
        batch, listeners = xmlrpc.client.MultiCall(self.master), []
        self.addCleanup(self.forget_listeners, listeners)
        for robot in range(ROBOTS):
            name = 'r{:03}'.format(robot)
            for topic in range(TOPICS):
                node, full = '/{}/base'.format(name), '/{}/topic{}'.format(name, topic)
                batch.registerPublisher(node, full, 'std_msgs/Bool', self.node.uri)
                self.registered.append((node, full, self.node.uri))
            command = '/{}/drive/velocity'.format(name)
            batch.registerSubscriber(node, command, 'geometry_msgs/Twist', self.node.uri)
            listeners.append((node, command, self.node.uri))
            # Every other robot has to be recognised.
            if robot % 2:
                batch.setParam('/discovery_test', '/{}/robot_type'.format(name), 'turtlebot2')
        batch()
        times = []

        def look():
            """Look once; a busy computer may not reach all within the time for each."""
            begun = time.monotonic()
            found = look_for_robots('/discovery_test', self.ignore)
            times.append(time.monotonic() - begun)
            return found if len(found.live) == ROBOTS else None
        for _ in range(5):
            found = wait_for(look, what='all robots to be found')
            self.assertEqual(found.leftovers, ())
            self.assertEqual([found.facts[item.name].seen.command for item in found.live],
                             ['drive/velocity'] * ROBOTS)
        what = 'discovery of {} robots with {} topics each'.format(ROBOTS, TOPICS)
        measured(what + ': median of {}'.format(len(times)), statistics.median(times), 0.5)
        measured(what + ': longest', max(times))

    def test_the_master_is_asked_once_and_never_once_per_node(self):
        for robot in range(7):
            self.register('/asked{}/base'.format(robot), '/asked{}/odom'.format(robot))
        counting = CountingMaster(rosgraph.get_master_uri())
        self.addCleanup(counting.close)
        api = MasterApi('/discovery_test', 5.0, counting.uri)
        found = look_for_robots('/discovery_test', self.ignore, api=api)
        self.assertEqual(len(found.live), 7)
        methods = [[call['methodName'] for call in params[0]] for _, params in counting.requests]
        self.assertEqual(methods[0], ['getSystemState', 'getTopicTypes', 'getParam'])
        self.assertLessEqual(len(methods), 2)
        self.assertNotIn('getSystemState', methods[1])

    def test_unreachable_leftovers_are_shown_as_such(self):
        self.register('/crashed/base', '/crashed/odom', 'http://127.0.0.1:{}/'.format(free_port()))
        self.register('/nowhere/base', '/nowhere/odom', 'http://no.such.host.invalid:1/')
        rospy.set_param('/parked/robot_type', 'turtlebot2')
        self.register('/alive/base', '/alive/odom')

        def alive():
            """Look once; a busy computer may not reach it within the time for each."""
            found = look_for_robots('/discovery_test', self.ignore)
            return found if self.names(found.live) == ['alive'] else None
        found = wait_for(alive, what='one to be alive')
        self.assertEqual(self.names(found.leftovers), ['crashed', 'nowhere', 'parked'])

    def test_connecting_to_nodes_that_do_not_answer_takes_no_longer_than_promised(self):
        """A full backlog leaves an attempt to connect without an answer, as a lost robot does."""
        with socket.socket() as silent:
            silent.bind(('127.0.0.1', 0))
            silent.listen(0)
            address = silent.getsockname()
            fillers = []
            for _ in range(4):
                filler = socket.socket()
                filler.setblocking(False)
                filler.connect_ex(address)
                fillers.append(filler)
            uri = 'http://127.0.0.1:{}/'.format(address[1])
            wait_for(lambda: not connectable([uri], 0.05), what='the backlog to be full')
            took = []

            def answered():
                begun = time.monotonic()
                found = connectable([uri, self.node.uri], 0.3)
                took.append(time.monotonic() - begun)
                return found
            self.assertEqual(wait_for(answered, what='the one that does'), {self.node.uri})
            for filler in fillers:
                filler.close()
        measured('connecting to one that does not answer', min(took), 0.35)
