# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The client side of another node: its topics, and calls to its services."""
import threading

import rospy

from mhri.graph.ros.service_owner import ServiceOwner
from mhri.graph.ros.worker import Worker


def call(service, kind, *words, wait_s=0.0, log=rospy.logwarn):
    """Call a service once, over its own connection (blocking).

    :param wait_s: how long to wait for the service to appear [s]
    :param log: called with (format, service, error) if the call fails
    :returns: the response, None if the call failed
    """
    try:
        if wait_s:
            rospy.wait_for_service(service, wait_s)
        return rospy.ServiceProxy(service, kind)(*words)
    except (rospy.ROSException, rospy.ServiceException, OSError) as error:
        log('%s: %s', service, error)
        return None


class NodeClient:
    """The client of one node; blocking calls run on its own thread.

    :param label: the name of that thread
    :param owner: a service of the node: only messages of the node that serves it are accepted; ''
        accepts those of any node
    :param wait_s: how long a call waits for its service [s]
    :param refuse: called with (caller, topic) of a rejected message
    :param on_new: called with the caller id when another process serves ``owner``
    """

    def __init__(self, label, owner='', wait_s=1.0, refuse=lambda caller, topic: None,
                 on_new=lambda caller: None):
        self._wait_s = wait_s
        self._owner = ServiceOwner(owner, refuse, on_new) if owner else None
        self._lock = threading.Lock()
        self._topics = []
        self._forgotten = False
        self._worker = Worker(label).start()

    @property
    def caller(self):
        """Caller id of the accepted node; '' if unknown, or without an owner."""
        return self._owner.caller if self._owner else ''

    def do(self, job, *words):
        """Run a job on the thread; return at once."""
        self._worker.do(job, *words)

    def subscribe(self, topic, kind, callback, queue_size=1):
        """Return a new subscriber (blocking: calls the master)."""
        subscribe = self._owner.subscribe if self._owner else rospy.Subscriber
        return self._keep(subscribe(topic, kind, callback, queue_size=queue_size,
                                    tcp_nodelay=True))

    def advertise(self, topic, kind, queue_size):
        """Return a new publisher (blocking: calls the master)."""
        return self._keep(rospy.Publisher(topic, kind, queue_size=queue_size))

    def _keep(self, topic):
        """Store a topic to unregister later; unregister it now if the client is closed."""
        with self._lock:
            self._topics.append(topic)
            forgotten = self._forgotten
        if forgotten:
            topic.unregister()
        return topic

    def start(self):
        """Start looking up the server of ``owner``; call it after subscribing. Return at once."""
        self._owner.start()

    def request(self, on_answer, service, kind, *words):
        """Call a service; return at once.

        :param on_answer: called on the thread with the response, None if the call failed
        """
        self._worker.do(lambda: on_answer(call(service, kind, *words, wait_s=self._wait_s)))

    def close(self, forget=False):
        """Close the client; return at once.

        :param forget: also unregister every topic, in the background: the program lives on
        """
        self._worker.stop()
        if self._owner:
            self._owner.stop()
        if forget and not rospy.is_shutdown():
            threading.Thread(target=self.unregister, name='forget', daemon=True).start()

    def unregister(self):
        """Unregister every topic (blocking: calls the master)."""
        with self._lock:
            self._forgotten = True
            topics, self._topics = self._topics, []
        for topic in topics:
            topic.unregister()
