# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The state of a drill: published by the referee, subscribed by screens.

``/mhri_drill/state`` (``mhri/DrillState``, latched, on change and at 1 Hz until the end).
"""
import math

import rospy

from mhri.base.text import tidy_names, tidy_text
from mhri.drill.view import DrillView
from mhri.graph.ros.node_client import NodeClient
from mhri.msg import DrillState
from mhri.session.topics import DRILL

AGAIN_S = 1.0
# Limit of received targets, more than any drill has.
MAX_TARGETS = 1000


class DrillPublisher:
    """Publishes the state of one run; not thread-safe.

    :param scenario: :class:`mhri.drill.scenario.Scenario`
    :param referee: :class:`mhri.drill.referee.Referee`
    """

    def __init__(self, scenario, referee):
        self._scenario, self._referee = scenario, referee
        self._said, self._said_at = None, rospy.Time()
        self._publisher = rospy.Publisher(DRILL, DrillState, queue_size=10, latch=True)

    def publish(self, phase, ended='', page=''):
        """Publish the state if it has changed, or once a second.

        :param phase: one of the constants of the message
        :param page: path of the file with the result
        """
        news, now = (phase, len(self._referee.found), ended, page), rospy.Time.now()
        if news == self._said and now - self._said_at < rospy.Duration(AGAIN_S):
            return
        self._said, self._said_at = news, now
        state = DrillState(
            title=self._scenario.title, about=self._scenario.about, phase=phase,
            limit_s=self._scenario.limit_s, in_order=self._scenario.in_order, ended=ended,
            page=page, found=[each.target for each in self._referee.found],
            left=[target.name for target in self._referee.left])
        state.header.stamp = now
        if phase != DrillState.WAITING:
            state.elapsed_s = self._referee.elapsed_s
        self._publisher.publish(state)


class DrillClient:
    """Subscribes the state; :meth:`view` returns the newest one."""

    def __init__(self):
        self._view = None
        self._node = NodeClient('drill_client')

    def start(self):
        """Start, after ``rospy.init_node``; return at once."""
        self._node.do(self._node.subscribe, DRILL, DrillState, self._on_state, 10)

    def _on_state(self, state):
        if not math.isfinite(state.elapsed_s + state.limit_s):
            return
        self._view = DrillView(
            state.header.stamp.to_sec(), tidy_text(state.title), tidy_text(state.about),
            state.phase, state.elapsed_s, state.limit_s, tidy_names(state.found, MAX_TARGETS),
            tidy_names(state.left, MAX_TARGETS), state.in_order, tidy_text(state.ended),
            tidy_text(state.page))

    def view(self):
        """Return a :class:`DrillView`, None before the first message."""
        return self._view

    def close(self):
        """Unsubscribe; return at once."""
        self._node.close(forget=True)
