# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The one mux in force: whoever serves ``/mux/set_stop_all`` is believed, by its caller id."""
import threading
import time

import rospy

from mhri.ros.graph.master_api import MasterApi, MasterError
from mhri.ros.graph.rospy_inside import caller_of, link_of

STOP_SERVICE = '/mux/set_stop_all'
# Whoever speaks as a mux and is none makes the master be asked, but not more often than this [s].
ASK_S = 0.2


class MuxInForce:
    """Knows whose words on the driving topics count.

    The master is asked on a thread of its own, at the start and whenever somebody else speaks: a
    newer mux takes the service over, a stranger does not.

    :param on_refused: called with the caller id and what it said, under no lock
    :param on_new: called on the thread that heard it when the mux in force is another, or another
        process or connection of the same name
    """

    def __init__(self, on_refused, on_new):
        self._on_refused = on_refused
        self._on_new = on_new
        self._caller = ''
        self._links = {}
        self._ask = threading.Event()

    @property
    def caller(self):
        """Caller id of the mux in force, '' while none is known."""
        return self._caller

    def start(self):
        """Begin to look; returns at once."""
        self._ask.set()
        threading.Thread(target=self._run, name='mux_in_force', daemon=True).start()
        return self

    def believes(self, message, topic):
        """Tell whether a message comes from the mux in force.

        :param topic: what it was said on, for the count of what is refused
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

    def _run(self):
        api = MasterApi(rospy.get_name(), timeout_s=1.0)
        while not rospy.is_shutdown():
            self._ask.wait()
            self._ask.clear()
            try:
                servers = dict(api.call('getSystemState')[2]).get(STOP_SERVICE, [])
            except MasterError as error:
                # Without a master the one that is known stays in force.
                rospy.logdebug('who is the mux cannot be asked now: %s', error)
                servers = []
            if servers and servers[-1] != self._caller:
                self._caller, self._links = servers[-1], {}
                self._on_new(self._caller)
            time.sleep(ASK_S)
