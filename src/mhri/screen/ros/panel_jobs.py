# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What the panel asks the master: parameters, discovery."""
import rospy

from mhri.graph.ros.master_api import MasterApi, MasterError
from mhri.robots.ros.look import look_for_robots, shipped_ignore_list
from mhri.screen.settings import NAMESPACE, PanelSettings, parse_settings

# The robots in the panel's list, in its order: gates, voice and pad read it.
ROBOTS_PARAMETER = '/mhri/robots'
# ... and their numbers: the voice reads it.
NUMBERS_PARAMETER = '/mhri/robot_numbers'


class PanelJobs:
    """Each method blocks, so call it on a worker. Results are events.

    :param types: {name: RobotType}
    :param events: a :class:`queue.Queue`; gets ``('found', Found)``,
        ``('look_failed', sentence)``
    """

    def __init__(self, types, events):
        self._types = types
        self._events = events
        self._told_robots = None
        self._setting_errors = ()
        self.settings = PanelSettings()

    def settle_parameters(self, robots):
        """Read the panel's parameters, and write the list of robots for gates, voice and pad.

        :param robots: {name: number}; None if another screen is in control, whose list counts
        """
        calls = [('getParam', NAMESPACE)]
        if robots not in (None, self._told_robots):
            calls += [('setParam', NUMBERS_PARAMETER, robots),
                      ('setParam', ROBOTS_PARAMETER, list(robots))]
        try:
            parameters = MasterApi(rospy.get_name()).call_many(calls)[0]
        except MasterError as error:
            rospy.logdebug('the parameters cannot be read now: %s', error)
            return
        self._told_robots = robots
        self.settings, errors = parse_settings(parameters, self.settings)
        errors = tuple(str(error) for error in errors)
        if errors != self._setting_errors:
            self._setting_errors = errors
            for text in errors:
                rospy.logwarn('%s', text)

    def look(self, known):
        """Look for connected robots.

        :param known: names that are in the list
        """
        try:
            self._events.put(('found', look_for_robots(
                rospy.get_name(), shipped_ignore_list(), known, types=self._types)))
        except (MasterError, ValueError, OSError) as error:
            self._events.put(('look_failed', str(error)))
