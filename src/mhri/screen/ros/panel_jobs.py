# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Requests of the panel to the master: parameters and discovery."""
import rospy

from mhri.base.names import NUMBERS, ROBOTS
from mhri.graph.ros.master_api import MasterApi, MasterError
from mhri.robots.ros.graph_scan import look_for_robots, shipped_ignore_list
from mhri.screen.settings import NAMESPACE, PanelSettings, parse_settings


class PanelJobs:
    """The requests; each method blocks, so call it on a worker. Results are events.

    :param types: {name: RobotType}
    :param events: a :class:`queue.Queue`; gets ``('found', Found)``,
        ``('look_failed', sentence)``
    """

    def __init__(self, types, events):
        self._types = types
        self._events = events
        self._written_robots = None
        self._setting_errors = ()
        self.settings = PanelSettings()

    def settle_parameters(self, robots):
        """Read the panel's parameters, and write the list of robots for drive, voice and pad.

        :param robots: {name: number}; None if another screen is in control and writes its list
        """
        calls = [('getParam', NAMESPACE)]
        if robots not in (None, self._written_robots):
            calls += [('setParam', NUMBERS, robots),
                      ('setParam', ROBOTS, list(robots))]
        try:
            parameters = MasterApi(rospy.get_name()).call_many(calls)[0]
        except MasterError as error:
            rospy.logdebug('the parameters cannot be read now: %s', error)
            return
        self._written_robots = robots
        self.settings, errors = parse_settings(parameters, self.settings)
        errors = tuple(str(error) for error in errors)
        if errors != self._setting_errors:
            self._setting_errors = errors
            for text in errors:
                rospy.logwarn('%s', text)

    def look(self, known):
        """Search for connected robots.

        :param known: names already in the list
        """
        try:
            self._events.put(('found', look_for_robots(
                rospy.get_name(), shipped_ignore_list(), known, types=self._types)))
        except (MasterError, ValueError, OSError) as error:
            self._events.put(('look_failed', str(error)))
