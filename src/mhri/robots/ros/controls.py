# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Who has control of robots that are linked (``mhri_link``), for the screen."""
from dataclasses import replace
import threading

import rospy
from std_srvs.srv import Trigger

from mhri.base.views import LIVE
from mhri.graph.ros.node_client import call
from mhri.msg import LinkControl
from mhri.robots.owners import shown


class Controls:
    """Subscribes ``/<robot>/mhri_link/state`` (``mhri/LinkControl``) of each robot.

    :param told: called with what came of a request, a sentence, on a thread of its own
    """

    def __init__(self, told):
        self._told = told
        self._states = {}
        self._subscribers = {}

    def watch(self, name):
        """Begin to listen for a robot; most are not linked, and nothing comes."""
        if name not in self._subscribers:
            self._subscribers[name] = rospy.Subscriber(
                '/{}/mhri_link/state'.format(name), LinkControl,
                lambda state: self._states.__setitem__(name, state), queue_size=1, tcp_nodelay=True)

    def forget(self, name):
        """Stop listening for a robot."""
        subscriber = self._subscribers.pop(name, None)
        self._states.pop(name, None)
        if subscriber is not None:
            # It asks the master, and the screen must not wait.
            threading.Thread(target=subscriber.unregister, daemon=True).start()

    def seen(self, view):
        """Return a :class:`mhri.base.views.RobotView` with who has control."""
        state = self._states.get(view.name)
        if state is None or not state.linked or view.link != LIVE:
            return view
        note, ask = shown(state.host, state.may_drive, state.holder, state.asking)
        asked = bool(state.asking and not ask and note)
        return replace(view, note=note or view.note, slow=view.slow or asked, ask=ask,
                       said=state.said)

    def ask(self, name):
        """Ask for control of a robot; asked again soon, it is taken. Returns at once."""
        threading.Thread(target=self._ask, args=(name,), name='ask', daemon=True).start()

    def _ask(self, name):
        answer = call('/{}/mhri_link/take_control'.format(name), Trigger)
        text = answer.message if answer else 'cannot ask for control: its link does not answer'
        self._told('{}: {}'.format(name, text))

    def close(self):
        """Stop listening (blocking: it asks the master)."""
        for subscriber in list(self._subscribers.values()):
            subscriber.unregister()
        self._subscribers.clear()
