# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Stop all, pressed before there is a master: it is shown, kept, and told to the mux."""
import sys

from support.ros_system import System, wait_for

PANEL = """
import time
import rospy
from std_msgs.msg import Bool
from mhri.screen.ros.backend import ScreenBackend
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


class Case:
    """One screen, with a master and a mux of its own that come later."""

    def __init__(self, release, system):
        self.release, self._system = release, system
        self._panel = system.start(sys.executable, '-c', PANEL.format(release=release))

    def wait(self, text, what, timeout_s=30):
        """Wait until the screen says something."""
        def said():
            with open(self._panel.log) as log:
                return text in log.read()
        wait_for(said, timeout_s, what, poll_s=0.05)

    def start_mux(self):
        self._system.start_master()
        self._system.node('mux', '__name:=mux')


def test_stop_all_waits_for_the_mux():
    """Released meanwhile, or not; both at the same time."""
    with System(adopt=False) as one, System(adopt=False) as other:
        cases = [Case(False, one), Case(True, other)]
        for case in cases:
            case.wait('shown True', 'the stop on the screen')
            if case.release:
                case.wait('released False', 'its end')
        for case in cases:
            case.start_mux()
        for case in cases:
            case.wait('the mux says {}'.format(not case.release), 'the mux', 60)
