# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Which mux and which gates to believe: the nodes that serve their services, by caller id.

Anybody can publish their topics. A service has only one server, which the master knows.
"""
import threading
import time

import rospy

from mhri.graph.ros.master_api import MasterApi, MasterError
from mhri.graph.ros.rospy_inside import caller_of, link_of

STOP_SERVICE, TAKE_SERVICE = '/mux/set_stop_all', '/gates/take_control'
# A message from anybody else makes us ask the master, but not more often than this [s].
ASK_S = 0.2
# This many strangers are told apart, and this many may have a message waiting on a topic.
MOST_STRANGERS, MOST_WAITING = 32, 8


class InForce:
    """Knows whose messages count: those of the node that serves a service.

    A thread asks the master at the start and whenever somebody else speaks: a newer server takes
    the service over, a stranger does not.

    :param service: its absolute name
    :param on_refused: called with the caller id and the topic of a refused message
    :param on_new: called, on the thread that found out, when another node is in force, or another
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
        self._ears = []
        self._ask = threading.Event()
        self._done = threading.Event()

    @property
    def caller(self):
        """Caller id of the node in force, '' while unknown."""
        return self._caller

    def start(self):
        """Begin to watch; returns at once."""
        self._ask.set()
        threading.Thread(target=self._run, name='in_force ' + self._service, daemon=True).start()
        return self

    def stop(self):
        """End the thread; returns at once."""
        self._done.set()
        self._ask.set()

    def believes(self, message, topic):
        """Tell whether a message comes from the node in force.

        :param topic: its topic, for the count of refused messages
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

    def subscribe(self, topic, kind, hear, **options):
        """Return a ``rospy.Subscriber`` that hears only the node in force.

        Messages wait while nobody is known to be in force: a latched message comes only once.
        """
        ear = _Ear(self, topic, hear)
        self._ears.append(ear)
        return rospy.Subscriber(topic, kind, ear.on_message, **options)

    def waiting(self):
        """Return how many nodes not in force have their newest message kept."""
        return sum(ear.waiting() for ear in self._ears)

    def _run(self):
        api = MasterApi(rospy.get_name(), timeout_s=1.0)
        while not (rospy.is_shutdown() or self._done.is_set()):
            self._ask.wait()
            self._ask.clear()
            try:
                self._look(api)
            except MasterError as error:
                # Without a master the known node stays in force.
                rospy.logdebug('cannot ask now who serves %s: %s', self._service, error)
            except Exception as error:  # without this thread a newer server would not be believed
                rospy.logerr_throttle(10.0, 'could not ask who serves {}: {}'.format(
                    self._service, repr(error)[:300]))
            self._done.wait(ASK_S)

    def _look(self, api):
        """Ask who serves the service, and for the whole graph only if that has changed.

        :raises MasterError: the master cannot be asked now
        """
        begun = time.monotonic()
        uri = api.call_many([('lookupService', self._service)])[0]
        if uri and uri == self._uri:
            for ear in self._ears:
                ear.forget(begun)
        if uri in (None, self._uri):
            return
        servers = dict(api.call('getSystemState')[2]).get(self._service, [])
        if not servers:
            return
        self._uri = uri
        if servers[-1] != self._caller:
            self._caller, self._links = servers[-1], {}
            self._on_new(self._caller)
            for ear in self._ears:
                ear.catch_up(self._caller)


class _Ear:
    """One topic: believed messages at once, the newest of others kept aside."""

    def __init__(self, force, topic, hear):
        self._force = force
        self._topic = topic
        self._hear = hear
        self._lock = threading.Lock()
        self._waiting = {}

    def on_message(self, message):
        """Pass a message on, or keep it in case its sender comes into force."""
        with self._lock:
            if self._force.believes(message, self._topic):
                self._waiting.clear()
                self._hear(message)
                return
            caller = caller_of(message)
            self._waiting.pop(caller, None)
            self._waiting[caller] = message, time.monotonic()
            while len(self._waiting) > MOST_WAITING:
                del self._waiting[next(iter(self._waiting))]

    def waiting(self):
        """Return how many messages are kept."""
        with self._lock:
            return len(self._waiting)

    def forget(self, before):
        """Drop messages from before the master was asked, except from the node in force."""
        with self._lock:
            self._waiting = {caller: said for caller, said in self._waiting.items()
                             if said[1] >= before}

    def catch_up(self, caller):
        """Pass on what the node that has just come into force said before."""
        with self._lock:
            if caller in self._waiting:
                message, _ = self._waiting.pop(caller)
                if self._force.believes(message, self._topic):
                    self._hear(message)


class Strangers:
    """Counts who was not believed, by (caller, topic); bounded in number and length.

    :param clock: function that returns seconds, monotonic
    """

    def __init__(self, clock=time.monotonic):
        self._clock = clock
        self._lock = threading.Lock()
        self._counts = {}

    def refuse(self, caller, topic):
        """Count one."""
        key = (caller[:200], topic)
        with self._lock:
            if len(self._counts) >= MOST_STRANGERS and key not in self._counts:
                self._counts.pop(next(iter(self._counts)))
            self._counts[key] = (self._counts.get(key, (0,))[0] + 1, self._clock())

    def forget(self, caller):
        """Forget one who has gone, or is believed now."""
        with self._lock:
            self._counts = {key: said for key, said in self._counts.items()
                            if key[0] != caller[:200]}

    def clear(self):
        """Forget them all."""
        with self._lock:
            self._counts.clear()

    def words(self, within_s=float('inf')):
        """Return ``CALLER: TOPIC, N times`` for everybody refused within the last seconds."""
        with self._lock:
            return ['{}: {}, {} times'.format(caller, topic, count)
                    for (caller, topic), (count, at) in self._counts.items()
                    if self._clock() - at < within_s]
