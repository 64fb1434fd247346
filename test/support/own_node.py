# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A test file that is a node itself, on a master of its own."""
from pathlib import Path

import pytest
import rospy

from support.ros_system import System, wait_for


def own_node(name, launch=''):
    """Return the fixture that the tests of a file have: its :class:`System`, and this node in it.

    :param launch: a launch file beside the test file, which is started first
    """
    @pytest.fixture(scope='module', autouse=True)
    def system(request):
        failed = request.session.testsfailed
        with System() as made:
            made.start_master()
            if launch:
                launched = made.start('roslaunch', str(
                    Path(str(request.fspath)).with_name(launch)))
                # All parameters are set before the first of its nodes starts.
                wait_for(lambda: 'started with pid' in Path(launched.log).read_text(), what=launch)
            rospy.init_node(name, disable_signals=True)
            yield made
            if request.session.testsfailed > failed:
                made.tell_ends()
            rospy.signal_shutdown('done')
    return system
