# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A stop-all outlives everything: drive and master killed at once; one line for each master."""
import os
import subprocess

from mhri.driving.ros.stop_line import StopLine
from support import graph
from support.ros_system import System, wait_for


def start(system):
    """Start the drive; return (it, a line to its stop)."""
    drive = system.node('mux', '--stand-by')
    line = StopLine('/test', system.env['ROS_MASTER_URI'])
    wait_for(line.connect, what='the drive')
    return drive, line


def stopped(system):
    """Return whether the drive says that everything is stopped, once it is there."""
    said = subprocess.check_output(['rostopic', 'echo', '-n1', graph.STOP_ALL], env=system.env,
                                   universal_newlines=True, timeout=60.0)
    return 'True' in said


def kept(home):
    """Return the masters in the file of stops."""
    path = os.path.join(home, 'mhri', 'stop')
    return open(path).read().split() if os.path.exists(path) else []


def test_a_stop_is_kept_over_a_restart_of_everything_and_for_its_master_alone():
    with System(adopt=False) as one, System(adopt=False) as other:
        other.env['ROS_HOME'] = one.home
        for system in (one, other):
            system.start_master()
        drive, line = start(one)
        _, other_line = start(other)
        assert line.call(True)[0] and other_line.call(True)[0]
        assert sorted(kept(one.home)) == sorted(
            system.env['ROS_MASTER_URI'] for system in (one, other))
        one.kill(drive)
        one.kill(one.master)
        one.start_master()
        drive, line = start(one)
        assert stopped(one) and not line.call(False)[0], 'the stick was not heard at neutral'
        stick = one.start('rostopic', 'pub', '-r', '20', graph.STICK, 'sensor_msgs/Joy',
                          '{axes: [0.0, 0.0]}')
        wait_for(lambda: line.call(False)[0], what='the release', poll_s=0.05)
        assert kept(one.home) == [other.env['ROS_MASTER_URI']]
        one.kill(stick)
        one.kill(drive)
        start(one)
        assert not stopped(one) and stopped(other)
