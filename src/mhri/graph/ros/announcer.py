# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Announces topics again to nodes that should subscribe to them but have not connected."""
import time

import rospy

from mhri.graph.ros.master_api import MasterApi

# How often topics without a subscriber are announced again to a node that is present [s].
ANNOUNCE_S = 5.0


class Announcer:
    """Has the master announce a topic again while a present node should subscribe but does not.

    The master announces a publisher only once. A node that hung or was out of reach at that moment
    never connects, nor does a rospy node whose connection ended during the handshake, e.g. because
    it connected twice: rospy does not try again.

    :param unheard: returns a list of (topic, type), those that present nodes should subscribe to
        but do not
    :param clock: seconds, monotonic
    """

    def __init__(self, unheard, clock=time.monotonic):
        self._unheard = unheard
        self._clock = clock
        self._announced_at = clock() - ANNOUNCE_S

    def announce(self):
        """Announce topics again if it is time (blocking: calls the master).

        :raises MasterError: the master is unavailable
        """
        now = self._clock()
        if now - self._announced_at < ANNOUNCE_S:
            return
        self._announced_at = now
        own = rospy.get_node_uri()
        calls = [('registerPublisher', topic, kind, own) for topic, kind in self._unheard()]
        if calls:
            MasterApi(rospy.get_name(), timeout_s=2.0).call_many(calls)
