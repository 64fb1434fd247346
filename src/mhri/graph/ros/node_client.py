# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The client side of another node: its topics, and calls to its services."""
import threading

import rospy

from mhri.graph.ros.in_force import InForce
from mhri.graph.ros.worker import Worker


def call(service, kind, *words, wait_s=0.0, log=rospy.logwarn):
    """Call a service once, over its own connection (blocking).

    :param wait_s: how long to wait for a service that is not there yet [s]
    :param log: takes (format, service, error) where there is no answer
    :returns: its answer, None for none
    """
    try:
        if wait_s:
            rospy.wait_for_service(service, wait_s)
        return rospy.ServiceProxy(service, kind)(*words)
    except (rospy.ROSException, rospy.ServiceException, OSError) as error:
        log('%s: %s', service, error)
        return None


class NodeClient:
    """The client of one node; a thread of its own does what may block.

    :param label: the name of that thread
    :param owner: a service of the node: only messages of the node that serves it are accepted; '':
        those of any node
    :param wait_s: how long a call waits for its service [s]
    :param refuse: called with (caller, topic) of a message that is not accepted
    :param on_new: called with the caller id when another process serves ``owner``
    """

    def __init__(self, label, owner='', wait_s=1.0, refuse=lambda caller, topic: None,
                 on_new=lambda caller: None):
        self._wait_s = wait_s
        self._force = InForce(owner, refuse, on_new) if owner else None
        self._lock = threading.Lock()
        self._topics = []
        self._forgotten = False
        self._worker = Worker(label).start()

    @property
    def caller(self):
        """Caller id of the accepted node; '' while it is unknown, or without an owner."""
        return self._force.caller if self._force else ''

    def do(self, job, *words):
        """Run a job on the thread; return at once."""
        self._worker.do(job, *words)

    def subscribe(self, topic, kind, callback, queue_size=1):
        """Return a new subscriber (blocking: it asks the master)."""
        subscribe = self._force.subscribe if self._force else rospy.Subscriber
        return self._keep(subscribe(topic, kind, callback, queue_size=queue_size,
                                    tcp_nodelay=True))

    def advertise(self, topic, kind, queue_size):
        """Return a new publisher (blocking: it asks the master)."""
        return self._keep(rospy.Publisher(topic, kind, queue_size=queue_size))

    def _keep(self, topic):
        """Keep a topic to unregister it later; at once, if the client was closed meanwhile."""
        with self._lock:
            self._topics.append(topic)
            forgotten = self._forgotten
        if forgotten:
            topic.unregister()
        return topic

    def start(self):
        """Find out which node serves ``owner``; call it after subscribing. Return at once."""
        self._force.start()

    def request(self, on_answer, service, kind, *words):
        """Call a service; return at once.

        :param on_answer: called on the thread with the answer, None where there is none
        """
        self._worker.do(lambda: on_answer(call(service, kind, *words, wait_s=self._wait_s)))

    def close(self, forget=False):
        """End; return at once.

        :param forget: unregister every topic as well, in the background: the program lives on
        """
        self._worker.stop()
        if self._force:
            self._force.stop()
        if forget and not rospy.is_shutdown():
            threading.Thread(target=self.unregister, name='forget', daemon=True).start()

    def unregister(self):
        """Unregister every topic (blocking: it asks the master)."""
        with self._lock:
            self._forgotten = True
            topics, self._topics = self._topics, []
        for topic in topics:
            topic.unregister()
