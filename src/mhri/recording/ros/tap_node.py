# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A subscriber on the graph without rospy, which reports the publishers of its topics."""
import logging
import os
import threading

from rosgraph.network import create_local_xmlrpc_uri, get_bind_address
from rosgraph.xmlrpc import ThreadingXMLRPCServer

from mhri.graph.ros.master_api import MasterApi, MasterError
from mhri.graph.ros.worker import Worker

_LOG = logging.getLogger(__name__)
RENEWAL_S = 2.0


class _SlaveApi:
    """The API of a node for other nodes and tools (http://wiki.ros.org/ROS/Slave_API)."""

    def __init__(self, node):
        self._node = node

    def publisherUpdate(self, caller_id, topic, publishers):  # noqa: N802
        self._node.worker.do(self._node.update, topic, publishers)
        return 1, '', 0

    def getPid(self, caller_id):  # noqa: N802
        return 1, '', os.getpid()

    def getSubscriptions(self, caller_id):  # noqa: N802
        return 1, '', [[topic, '*'] for topic in self._node.topics]

    def getPublications(self, caller_id):  # noqa: N802
        return 1, '', []

    def getBusInfo(self, caller_id):  # noqa: N802
        return 1, '', []

    def getBusStats(self, caller_id):  # noqa: N802
        return 1, '', [[], [], []]

    def getMasterUri(self, caller_id):  # noqa: N802
        return 1, '', self._node.master_uri

    def paramUpdate(self, caller_id, key, value):  # noqa: N802
        return 1, '', 0

    def requestTopic(self, caller_id, topic, protocols):  # noqa: N802
        return 0, 'this node publishes nothing', 0

    def shutdown(self, caller_id, message=''):
        return 0, 'this is part of the panel: stop the recording there', 0


class TapNode:
    """Subscribes topics of any type under its own node name.

    rospy has one connection for all subscribers of a topic in a program, with the message class and
    the queue of one message that the displays use; a recording needs its own. The node renews its
    subscriptions periodically, which also restores them after a restart of the master.

    :param name: the node's name, e.g. ``/mhri_recorder_bot1``
    :param topics: absolute names
    :param renewal_s: period of renewing the subscriptions [s]
    :param on_publishers: called with (topic, XML-RPC addresses) at every report, on a thread of
        this node; reports may repeat
    """

    def __init__(self, name, topics, on_publishers, renewal_s=RENEWAL_S):
        self.name = name
        self.topics = tuple(topics)
        self.worker = Worker('tap_' + name.strip('/'), self._renew, renewal_s)
        self._on_publishers = on_publishers
        self._server = None
        self._api = None
        self._uri = ''
        self._open = False

    @property
    def master_uri(self):
        """The address of the master, '' before the start."""
        return self._api.uri if self._api else ''

    def start(self):
        """Open the address and start subscribing; return at once.

        :raises OSError: no address is available
        """
        self._server = ThreadingXMLRPCServer((get_bind_address(), 0), 0)
        self._server.register_instance(_SlaveApi(self))
        self._uri = create_local_xmlrpc_uri(self._server.server_address[1])
        self._api = MasterApi(self.name)
        self._open = True
        threading.Thread(target=self._server.serve_forever, name='tap_address',
                         daemon=True).start()
        self.worker.start()
        self.worker.do(self._renew)

    def set_topics(self, topics):
        """Subscribe exactly these topics from now on; return at once."""
        self.worker.do(self._change, tuple(topics))

    def _change(self, topics):
        gone, self.topics = set(self.topics) - set(topics), topics
        if self._open and gone:
            try:
                self._api.call_many([('unregisterSubscriber', topic, self._uri) for topic in gone])
            except MasterError as error:
                _LOG.debug('%s', error)
        self._renew()

    def update(self, topic, publishers):
        """Report the present publishers of a topic (on the worker's thread)."""
        if self._open and topic in self.topics:
            self._on_publishers(topic, publishers)

    def _renew(self):
        if not self._open or not self.topics:
            return
        try:
            found = self._api.call_many([('registerSubscriber', topic, '*', self._uri)
                                         for topic in self.topics])
        except MasterError as error:
            _LOG.debug('%s', error)
            return
        for topic, publishers in zip(self.topics, found):
            self.update(topic, publishers or [])

    def stop(self):
        """Leave the graph; return at once."""
        self.worker.do(self._leave)

    def _leave(self):
        self._open = False
        try:
            self._api.call_many([('unregisterSubscriber', topic, self._uri)
                                 for topic in self.topics])
        except MasterError as error:
            _LOG.debug('%s', error)
        self._server.shutdown()
        self._server.server_close()
        # This also drops its open connection to the master.
        self._api = None
        self.worker.stop()
