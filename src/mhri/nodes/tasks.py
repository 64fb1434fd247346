# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The executable ``tasks``: runs :class:`mhri.tasks.ros.tasks.Tasks` as ``/mhri_tasks``.

With ``--stand-by`` its process is replaced by another one, already loaded, if it is killed, crashes
or hangs (:mod:`mhri.graph.ros.stand_by`). Parameters: ``~map`` (path of a YAML file of map_server;
it is published as ``/map``; default: none), ``~keep_to_map`` (true: a robot on a task does not
leave the free floor of the map, if its position is known and on that floor; default: true).
"""
import sys

from diagnostic_msgs.msg import DiagnosticStatus
import rospy

from mhri.base.config import ConfigError, short
from mhri.graph.ros import parameters
from mhri.graph.ros.diagnostics import publish_diagnostics
from mhri.graph.ros.master_watch import MasterWatch
from mhri.graph.ros.resources import robot_types
from mhri.graph.ros.shutdown import start_node
from mhri.graph.ros.stand_by import HUNG_S, stand_by
from mhri.map.ros.map_source import load_map
from mhri.tasks.ros.exported import task_kinds
from mhri.tasks.ros.tasks import Tasks


def map_of_parameter():
    """Return the :class:`Grid` of the file in ``~map``, None if that is empty.

    An unusable file is logged; tasks also work without a map.
    """
    try:
        path = parameters.text('~map', '')
        return load_map(path) if path else None
    except (ConfigError, OSError) as error:
        rospy.logerr('there is no map: %s', short(error))
        return None


def keeps_to_map():
    """Return ``~keep_to_map``; if it is not a boolean, log that and return true."""
    try:
        return parameters.flag('~keep_to_map', True)
    except ConfigError as error:
        rospy.logerr('robots keep to the map: %s', short(error))
        return True


def main():
    """Run until shut down; then every robot on a task gets a zero.

    After ``rosnode kill`` the exit status is 1, so that the node is restarted.
    """
    types, _ = robot_types()
    kinds, errors = task_kinds()
    undertaker = stand_by('the tasks', HUNG_S)
    by_hand = start_node('mhri_tasks', disable_rostime=True)
    rospy.on_shutdown(undertaker.end)
    for error in errors:
        rospy.logwarn('a task is left out: %s', error)
    tasks = Tasks(types, kinds, map_of_parameter(), keeps_to_map=keeps_to_map(),
                  beat=undertaker.beat)
    rospy.on_shutdown(tasks.close)
    MasterWatch().start()
    tasks.start()

    def fill(status):
        """Fill in the diagnostics: each robot on a task."""
        summary = tasks.summary()
        status.summary(DiagnosticStatus.OK, '{} robots on a task'.format(len(summary)))
        for name, (state, text) in sorted(summary.items()):
            status.add(name, '{}: {}'.format(state, text))
        return status

    publish_diagnostics({'tasks': fill})
    rospy.spin()
    if by_hand():
        sys.exit('the tasks were ended by rosnode kill')
