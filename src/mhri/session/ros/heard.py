# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What a session hears of the graph, and for how long it has heard nothing of a robot."""
from mhri.base.names import topic_of
from mhri.session.topics import (
    camera_topics, fault_topic, HOST_TOPICS, inputs_of, PANEL_EVENTS, PICTURES, robot_topics)

_NS = 1e9


class Heard:
    """Tells a :class:`mhri.session.ros.tap.SessionTap` what to hear.

    :param robots: :class:`mhri.session.ros.graph_robots.GraphRobots`
    :param follow_faults: called with the names of simulated robots before their faults are heard
    :param out_of_sight: connect to the cameras themselves, whether a screen shows them or not; else
        pictures come from screens, so that no camera has to send twice
    """

    def __init__(self, tap, robots, follow_faults, out_of_sight):
        self._tap = tap
        self._robots = robots
        self._follow_faults = follow_faults
        self._simulated = []
        self._out_of_sight = out_of_sight

    def want(self):
        """Hear what there is now."""
        topics = [*HOST_TOPICS, *inputs_of(self._robots.published), PANEL_EVENTS]
        # One whose driver is dead for a while stays one.
        self._simulated += [name for name in self._robots.kinds if name not in self._simulated
                            and fault_topic(name) in self._robots.published]
        self._follow_faults(self._simulated)
        topics += [fault_topic(name) for name in self._simulated]
        cameras = []
        for name, kind in self._robots.kinds.items():
            topics += robot_topics(name, kind)
            cameras += camera_topics(name, kind)
        if self._out_of_sight:
            self._tap.want(topics, [topic for topic in cameras
                                    if topic in self._robots.published])
        else:
            self._tap.want(topics + [PICTURES])

    def silence_s(self, now_ns):
        """Return {robot: (how long it has been silent, how long it may be)} [s] of those heard."""
        found = {}
        for name, kind in list(self._robots.kinds.items()):
            heard = [source.at_ns for source in (self._tap.newest(topic_of(name, topic))
                                                 for topic in kind.odometry) if source]
            if heard:
                found[name] = (now_ns - max(heard)) / _NS, kind.silent_after_s
        return found
