# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A node as another program sees it: what it says, what it is told, calls to its services."""
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
    """One node, from elsewhere.

    :param label: the name of the thread on which everything is done that waits
    :param owner: a service of the node: only who serves it is heard; '': anybody is
    :param wait_s: how long a call waits for its service [s]
    :param refuse: called with (caller, topic) of a message that is not the node's own
    :param on_new: called with its caller id when another process is the node
    """

    def __init__(self, label, owner='', wait_s=1.0, refuse=lambda caller, topic: None,
                 on_new=lambda caller: None):
        self._wait_s = wait_s
        self._force = InForce(owner, refuse, on_new) if owner else None
        self._topics = []
        self._worker = Worker(label).start()

    @property
    def caller(self):
        """Caller id of the node that is heard, '' while unknown, or where anybody is."""
        return self._force.caller if self._force else ''

    def do(self, job, *words):
        """Have something done on the thread; return at once."""
        self._worker.do(job, *words)

    def hear(self, topic, kind, hear, queue_size=1):
        """Return a new subscriber (blocking: it asks the master)."""
        subscribe = self._force.subscribe if self._force else rospy.Subscriber
        self._topics.append(subscribe(topic, kind, hear, queue_size=queue_size, tcp_nodelay=True))
        return self._topics[-1]

    def say(self, topic, kind, queue_size):
        """Return a new publisher (blocking: it asks the master)."""
        self._topics.append(rospy.Publisher(topic, kind, queue_size=queue_size))
        return self._topics[-1]

    def watch(self):
        """Find out who the node is, now that every topic is heard; return at once."""
        self._force.start()

    def ask(self, on_answer, service, kind, *words):
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
        for topic in self._topics:
            topic.unregister()
