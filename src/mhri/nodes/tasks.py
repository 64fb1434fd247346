# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The executable ``tasks``: runs :class:`mhri.tasks.ros.tasks.Tasks` as ``/mhri_tasks``.

``tasks --stand-by`` does so in a process that another one, already loaded, replaces if it is
killed or hangs (:mod:`mhri.graph.ros.stand_by`). Parameter: ``~map`` (path of a YAML file of
map_server; it is published as ``/map``; default: none), ``~keep_to_map`` (true: no robot on a
task leaves the free floor of the map, where it is placed on it and stands there; default: true).
"""
import sys

from diagnostic_msgs.msg import DiagnosticStatus
import rospy

from mhri.base.config import ConfigError, short
from mhri.graph.ros import log, parameters
from mhri.graph.ros.diagnostics import publish_diagnostics
from mhri.graph.ros.ending import init_node
from mhri.graph.ros.master_watch import MasterWatch
from mhri.graph.ros.peers import limit_peers
from mhri.graph.ros.resources import robot_types
from mhri.graph.ros.rospy_inside import ended_by_hand
from mhri.graph.ros.stand_by import stand_by
from mhri.map.ros.map_source import load_map
from mhri.tasks.ros.exported import task_kinds
from mhri.tasks.ros.tasks import Tasks


def map_of_parameter():
    """Return the :class:`Grid` of the file that ``~map`` names, None where it names none.

    A file that cannot be used is said; robots can be on tasks without a map.
    """
    try:
        path = parameters.text('~map', '')
        return load_map(path) if path else None
    except (ConfigError, OSError) as error:
        rospy.logerr('there is no map: %s', short(error))
        return None


def keeps_to_map():
    """Return ``~keep_to_map``; true where it is neither true nor false, which is said."""
    try:
        return parameters.flag('~keep_to_map', True)
    except ConfigError as error:
        rospy.logerr('robots keep to the map: %s', short(error))
        return True


def main():
    """Run until shut down; every robot on a task gets a zero then.

    Ended by ``rosnode kill`` the exit status is 1, so that ``mhri.launch`` starts it again.
    """
    types, _ = robot_types()
    kinds, errors = task_kinds()
    beat = stand_by('the tasks', beats=True)
    limit_peers()
    init_node('mhri_tasks', disable_rostime=True)
    rospy.on_shutdown(beat.end)
    log.install()
    by_hand = ended_by_hand()
    for error in errors:
        rospy.logwarn('a task is left out: %s', error)
    tasks = Tasks(types, kinds, map_of_parameter(), keeps_to_map=keeps_to_map(), beat=beat)
    rospy.on_shutdown(tasks.close)
    MasterWatch().start()
    tasks.start()

    def fill(status):
        """Fill the diagnostics: each robot on a task."""
        summary = tasks.summary()
        status.summary(DiagnosticStatus.OK, '{} robots on a task'.format(len(summary)))
        for name, (state, text) in sorted(summary.items()):
            status.add(name, '{}: {}'.format(state, text))
        return status

    publish_diagnostics({'tasks': fill})
    rospy.spin()
    if by_hand():
        sys.exit('the tasks were ended by rosnode kill')
