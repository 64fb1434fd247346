# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Stop all, pressed before there is a master: it is shown, kept, and told to the mux."""
import os
import sys

import pytest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..'))

from support.ros_system import System, wait_for  # noqa: E402

PANEL = """
import time
import rospy
from std_msgs.msg import Bool
from mhri.ros.screen.backend import ScreenBackend
operator = ScreenBackend(['panel'])
operator.start()
while operator.view().ros != 'no_master':
    time.sleep(0.02)
operator.stop_all()
print('shown', operator.view().stop_all, flush=True)
if {release}:
    operator.release()
    print('released', operator.view().stop_all, flush=True)
while operator.view().ros != 'connected':
    time.sleep(0.02)
heard = []
rospy.Subscriber('/robot_controller/stop_all', Bool, lambda message: heard.append(message.data))
while not heard or {release} - heard[-1] == 0:
    time.sleep(0.02)
print('the mux says', heard[-1], flush=True)
time.sleep(1000)
"""


@pytest.mark.parametrize('release', [False, True])
def test_stop_all_waits_for_the_mux(release):
    with System(adopt=False) as system:
        panel = system.start(sys.executable, '-c', PANEL.format(release=release))

        def said(text):
            with open(panel.log) as log:
                return text in log.read()
        wait_for(lambda: said('shown True'), 30, 'the stop on the screen', poll_s=0.05)
        assert not release or wait_for(lambda: said('released False'), 10, 'its end', poll_s=0.05)
        system.start_master()
        system.node('mux', '__name:=mux')
        wait_for(lambda: said('the mux says {}'.format(not release)), 60, 'the mux', poll_s=0.05)
