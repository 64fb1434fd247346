# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A robot that misses what the master tells it, as one that is out of reach does."""
import threading
from xmlrpc.server import SimpleXMLRPCServer

import rosgraph


class DeafRobot:
    """A subscriber that the master tells of publishers, and that never connects to them.

    ``told``: for each time, the names of the nodes that publish the topic.
    """

    def __init__(self, topic):
        self.told = []
        self._topic = topic
        self._server = SimpleXMLRPCServer(('127.0.0.1', 0), logRequests=False)
        self._server.register_function(self._hear, 'publisherUpdate')
        threading.Thread(target=self._server.serve_forever, kwargs={'poll_interval': 0.01},
                         daemon=True).start()
        self._uri = 'http://127.0.0.1:{}/'.format(self._server.server_address[1])
        self._name = '/deaf' + topic.replace('/', '_')
        rosgraph.Master(self._name).registerSubscriber(topic, 'geometry_msgs/Twist', self._uri)

    def _hear(self, caller, topic, publishers):
        # A proxy of its own: it must not be shared between threads.
        state = dict(rosgraph.Master(self._name).getSystemState()[0])
        self.told.append(' '.join(state.get(topic, ())))
        return 1, '', 0

    def close(self):
        rosgraph.Master(self._name).unregisterSubscriber(self._topic, self._uri)
        self._server.shutdown()
        self._server.server_close()
