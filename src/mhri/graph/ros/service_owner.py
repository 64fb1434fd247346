# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The trusted node, identified as the server of a service, by caller id.

Any node can publish its topics. But a service has only one server, registered at the master.
"""
import threading
import time

import rospy

from mhri.graph.ros.master_api import MasterApi, MasterError
from mhri.graph.ros.rospy_inside import caller_of, link_of

STOP_SERVICE, TAKE_SERVICE = '/mux/set_stop_all', '/mux/take_control'
# Minimum interval between calls to the master because of messages from other nodes [s].
ASK_S = 0.2
# Maximum numbers of distinguished strangers, and of strangers with a waiting message on a topic.
MAX_STRANGERS, MAX_WAITING = 32, 8


class ServiceOwner:
    """Accepts only messages of the node that serves a service.

    A thread calls the master at the start and after messages from other nodes: a newer server has
    taken the service over, a stranger has not.

    :param service: its absolute name
    :param on_refused: called with the caller id and the topic of a rejected message
    :param on_new: called, on the thread that detects it, when another node serves it, or another
        process or connection of the same name
    """

    def __init__(self, service, on_refused=lambda caller, topic: None,
                 on_new=lambda caller: None):
        self._service = service
        self._on_refused = on_refused
        self._on_new = on_new
        self._caller = ''
        self._uri = None
        self._links = {}
        self._trusted = []
        self._ask = threading.Event()
        self._done = threading.Event()

    @property
    def caller(self):
        """Caller id of the accepted node, '' while unknown."""
        return self._caller

    def start(self):
        """Start the thread; return at once."""
        self._ask.set()
        threading.Thread(target=self._run, name='owner of ' + self._service, daemon=True).start()
        return self

    def stop(self):
        """Stop the thread; return at once."""
        self._done.set()
        self._ask.set()

    def accepts(self, message, topic):
        """Return whether a message comes from the accepted node.

        :param topic: its topic, for the count of rejected messages
        """
        caller = caller_of(message)
        if caller != self._caller:
            self._ask.set()
            if self._caller:
                self._on_refused(caller, topic)
            return False
        link = link_of(message)
        if self._links.get(topic) is not link:
            known, self._links[topic] = topic in self._links, link
            if known:
                self._links = {topic: link}
                self._on_new(caller)
        return True

    def subscribe(self, topic, kind, callback, **options):
        """Return a ``rospy.Subscriber`` that passes on only messages of the accepted node.

        Messages wait while the accepted node is unknown: a latched message comes only once.
        """
        trusted = _TrustedTopic(self, topic, callback)
        self._trusted.append(trusted)
        return rospy.Subscriber(topic, kind, trusted.on_message, **options)

    def waiting(self):
        """Return the number of messages kept of nodes that are not accepted."""
        return sum(trusted.waiting() for trusted in self._trusted)

    def _run(self):
        api = MasterApi(rospy.get_name(), timeout_s=1.0)
        while not (rospy.is_shutdown() or self._done.is_set()):
            self._ask.wait()
            self._ask.clear()
            try:
                self._look(api)
            except MasterError as error:
                # Without a master the known node stays accepted.
                rospy.logdebug('cannot ask now who serves %s: %s', self._service, error)
            except Exception as error:  # without this thread a newer server would not be trusted
                rospy.logerr_throttle(10.0, 'could not ask who serves {}: {}'.format(
                    self._service, repr(error)[:300]))
            self._done.wait(ASK_S)

    def _look(self, api):
        """Look up the server of the service, and the whole graph only if it has changed.

        :raises MasterError: the master does not answer
        """
        begun = time.monotonic()
        uri = api.call_many([('lookupService', self._service)])[0]
        if uri and uri == self._uri:
            for trusted in self._trusted:
                trusted.forget(begun)
        if uri in (None, self._uri):
            return
        servers = dict(api.call('getSystemState')[2]).get(self._service, [])
        if not servers:
            return
        self._uri = uri
        if servers[-1] != self._caller:
            self._caller, self._links = servers[-1], {}
            self._on_new(self._caller)
            for trusted in self._trusted:
                trusted.replay_pending(self._caller)


class _TrustedTopic:
    """One topic: passes on trusted messages at once, and keeps the newest of other nodes."""

    def __init__(self, owner, topic, callback):
        self._owner = owner
        self._topic = topic
        self._callback = callback
        self._lock = threading.Lock()
        self._waiting = {}

    def on_message(self, message):
        """Pass a message on, or keep it in case its sender becomes the accepted node."""
        with self._lock:
            if self._owner.accepts(message, self._topic):
                self._waiting.clear()
                self._callback(message)
                return
            caller = caller_of(message)
            self._waiting.pop(caller, None)
            self._waiting[caller] = message, time.monotonic()
            while len(self._waiting) > MAX_WAITING:
                del self._waiting[next(iter(self._waiting))]

    def waiting(self):
        """Return the number of kept messages."""
        with self._lock:
            return len(self._waiting)

    def forget(self, before):
        """Drop messages from before the call to the master, except from the accepted node."""
        with self._lock:
            self._waiting = {caller: said for caller, said in self._waiting.items()
                             if said[1] >= before}

    def replay_pending(self, caller):
        """Pass on the earlier messages of the node that has just been accepted."""
        with self._lock:
            if caller in self._waiting:
                message, _ = self._waiting.pop(caller)
                if self._owner.accepts(message, self._topic):
                    self._callback(message)


class RejectedSenders:
    """Counts rejected senders, by (caller, topic); bounded in number and length.

    :param clock: function that returns monotonic seconds
    """

    def __init__(self, clock=time.monotonic):
        self._clock = clock
        self._lock = threading.Lock()
        self._counts = {}

    def refuse(self, caller, topic):
        """Count a rejected message."""
        key = (caller[:200], topic)
        with self._lock:
            if len(self._counts) >= MAX_STRANGERS and key not in self._counts:
                self._counts.pop(next(iter(self._counts)))
            self._counts[key] = (self._counts.get(key, (0,))[0] + 1, self._clock())

    def forget(self, caller):
        """Remove a sender that has gone, or is trusted now."""
        with self._lock:
            self._counts = {key: said for key, said in self._counts.items()
                            if key[0] != caller[:200]}

    def clear(self):
        """Remove all senders."""
        with self._lock:
            self._counts.clear()

    def words(self, within_s=float('inf')):
        """Return ``CALLER: TOPIC, N times`` for each sender rejected within the last seconds."""
        with self._lock:
            return ['{}: {}, {} times'.format(caller, topic, count)
                    for (caller, topic), (count, at) in self._counts.items()
                    if self._clock() - at < within_s]
