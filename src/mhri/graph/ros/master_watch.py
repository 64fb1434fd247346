# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Watches the master, and registers this node again after a restart of the master.

rospy registers only once: after a restart of the master its nodes live on, but cannot be found
(robot_upstart#35). Existing connections outlive the master; new ones need it.
"""
import threading
import time

import rospy

from mhri.graph.ros.master_api import MasterApi, MasterError
from mhri.graph.ros.rospy_inside import is_ending, connect_publishers, never_ask_for, registrations


def log_without_master():
    """Keep rospy from calling the master for every log line; call it after ``rospy.init_node``.

    rospy adds the names of the topics to each line for /rosout, unless a parameter forbids it;
    while that parameter is not set, rospy subscribes to it again every time. An unreachable master
    would block the logging thread; and a node whose name was taken over would take it back,
    whereupon the master ends both (ros_comm#2018). That subscription outlives the node: at its next
    start the master ends the node that uses the old address by then.
    """
    name = '/rosout_disable_topics_generation'
    never_ask_for(name, bool(rospy.get_param(name, False)))


class MasterWatch:
    """Checks periodically whether the master is alive and has this node registered.

    It calls ``on_lost(reason)``, on its own thread, once when the master refused two calls in a
    row, or did not answer one for ``patience_s``: at most ``period_s`` plus ``patience_s`` after it
    hung. A master restarted between two calls counts as lost, too. A new master process without
    this node gets its registrations and ``parameters``. ``lost`` is whether the master is lost now.

    :param parameters: {absolute name: value} that this node owns and restores
    :param period_s: the time between two calls [s]
    :param patience_s: timeout of a call [s]; a slower one counts as a lost master, so allow at
        least about one second for a busy computer
    """

    def __init__(self, on_lost=lambda reason: None, parameters=None, period_s=0.5,
                 patience_s=1.0):
        self._on_lost = on_lost
        self.parameters = dict(parameters or {})
        self._period_s = period_s
        self._patience_s = patience_s
        self._api = MasterApi(rospy.get_name(), timeout_s=patience_s)
        self._misses = 0
        self.lost = False
        self._due = {}
        self._done, self._news = threading.Event(), threading.Event()
        self._thread = threading.Thread(target=self._run, name='master_watch', daemon=True)

    def start(self):
        """Start watching; call it after ``rospy.init_node``."""
        log_without_master()
        for name, value in self.parameters.items():
            rospy.set_param(name, value)
        self._thread.start()
        return self

    def stop(self):
        """Stop the thread; return at once."""
        self._done.set()
        self._news.set()

    def keep_parameter(self, name, value):
        """Set a parameter soon, and after every restart; return at once."""
        self.parameters[name] = self._due[name] = value
        self._news.set()

    def set_parameter(self, name, value):
        """Set a parameter now (blocking, so never on the GUI thread) and after every restart."""
        self.parameters[name] = value
        # Not with the watch's own proxy, which belongs to its thread.
        MasterApi(rospy.get_name(), timeout_s=1.0).call('setParam', name, value)

    def _run(self):
        while not rospy.is_shutdown():
            # A call that failed is repeated after the period, whatever there is to be set.
            (self._done if self._misses else self._news).wait(self._period_s)
            self._news.clear()
            if self._done.is_set():
                return
            begun = time.monotonic()
            try:
                self._look()
            except MasterError as error:
                self._miss(str(error), time.monotonic() - begun >= self._patience_s)

    def _look(self):
        """Check once; register again if needed."""
        own = rospy.get_node_uri()
        # In this order: the second call sees a node that takes the name over between the two. The
        # other way round it would look like a master that has forgotten this node.
        service, uri = self._api.call_many([
            ('lookupService', rospy.get_name() + '/get_loggers'),
            ('lookupNode', rospy.get_name())])
        self._misses = 0
        if service is None:
            # The name alone proves nothing: a new master has it after any call that mentions this
            # node. But the service that every rospy node has is registered with the rest.
            uri = None if uri == own else uri
        if uri is not None and uri != own:
            rospy.signal_shutdown('name taken over')
            rospy.logwarn('another node has taken over the name %s: this one ends',
                          rospy.get_name())
            return
        if is_ending():
            # This node itself has unregistered it.
            return
        if uri is None:
            if not self.lost:
                self._lose('the ROS master was restarted')
            self._register()
            rospy.loginfo('the ROS master had forgotten %s: registered again', rospy.get_name())
        self.lost = False
        for name in list(self._due):
            value = self._due.pop(name)
            try:
                self._api.call('setParam', name, value)
            except MasterError:
                self._due.setdefault(name, value)
                raise

    def _miss(self, reason, hangs):
        """Count a call without an answer; two in a row, or one that hangs, mean a lost master."""
        self._misses += 2 if hangs else 1
        if self._misses >= 2 and not self.lost:
            self._lose(reason)

    def _lose(self, reason):
        self.lost = True
        self._on_lost(reason)
        rospy.logwarn('ROS master lost: %s', reason)

    def _register(self):
        """Repeat all of rospy's registrations at the master.

        :raises MasterError: the master was lost again meanwhile
        """
        own = rospy.get_node_uri()
        publications, services, subscriptions = registrations()
        calls = [('registerPublisher', name, kind, own) for name, kind in publications]
        calls += [('registerService', name, uri, own) for name, uri in services]
        calls += [('setParam', name, value) for name, value in self.parameters.items()]
        calls += [('registerSubscriber', name, kind, own) for name, kind in subscriptions]
        answers = self._api.call_many(calls)
        for (name, _), uris in zip(subscriptions, answers[len(calls) - len(subscriptions):]):
            connect_publishers(name, uris or [])
