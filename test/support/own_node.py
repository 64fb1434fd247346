# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The fixture of test files that are ROS nodes themselves."""
from pathlib import Path

import pytest
import rospy

from support.ros_system import System, wait_for


def own_node(name, launch=''):
    """Return a fixture: a :class:`System` with a master, in which this process is a node.

    All tests of the file use it, whether they ask for it or not.

    :param launch: a launch file, from where the test file is, started before the node
    """
    @pytest.fixture(scope='module', autouse=True)
    def system(request):
        failed = request.session.testsfailed
        with System() as made:
            made.start_master()
            if launch:
                launched = made.start('roslaunch', str(
                    Path(str(request.fspath)).parent / launch))
                # All parameters are set before the first of its nodes starts.
                wait_for(lambda: 'started with pid' in Path(launched.log).read_text(), what=launch)
            rospy.init_node(name, disable_signals=True)
            yield made
            if request.session.testsfailed > failed:
                made.tell_ends()
            rospy.signal_shutdown('done')
    return system
