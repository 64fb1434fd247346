# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The topics that a session records, and the silence of each robot."""
from mhri.base.names import topic_of
from mhri.camera.transports import PICTURES
from mhri.session.topics import (
    camera_topics, fault_topic, HOST_TOPICS, inputs_of, PANEL_EVENTS, robot_topics)

_NS = 1e9


class SessionInputs:
    """Chooses the topics that a :class:`mhri.session.ros.tap.SessionTap` subscribes.

    :param robots: :class:`mhri.session.ros.graph_robots.GraphRobots`
    :param follow_faults: called with the names of simulated robots before subscribing their faults
    :param out_of_sight: connect to the cameras directly, whether a screen shows them or not; else
        screens relay their pictures, so that no camera has to send twice
    """

    def __init__(self, tap, robots, follow_faults, out_of_sight):
        self._tap = tap
        self._robots = robots
        self._follow_faults = follow_faults
        self._simulated = []
        self._out_of_sight = out_of_sight

    def update(self):
        """Subscribe the topics of the current robots."""
        topics = [*HOST_TOPICS, *inputs_of(self._robots.published), PANEL_EVENTS]
        # A simulated robot stays in the list when its driver dies.
        self._simulated += [name for name in self._robots.kinds if name not in self._simulated
                            and fault_topic(name) in self._robots.published]
        self._follow_faults(self._simulated)
        topics += [fault_topic(name) for name in self._simulated]
        cameras = []
        for name, kind in self._robots.kinds.items():
            topics += robot_topics(name, kind)
            cameras += camera_topics(name, kind)
        if self._out_of_sight:
            self._tap.subscribe(topics, [topic for topic in cameras
                                         if topic in self._robots.published])
        else:
            self._tap.subscribe(topics + [PICTURES])

    def silence_s(self, now_ns):
        """Return {robot: (silence, allowed silence)} [s] of the robots with odometry so far."""
        found = {}
        for name, kind in list(self._robots.kinds.items()):
            heard = [source.at_ns for source in (self._tap.newest(topic_of(name, topic))
                                                 for topic in kind.odometry) if source]
            if heard:
                found[name] = (now_ns - max(heard)) / _NS, kind.silent_after_s
        return found
