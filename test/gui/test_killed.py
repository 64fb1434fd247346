# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A panel that is killed while a real key, pressed in the X server, drives two robots."""
import os
import subprocess
import sys
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..'))

from support.ros_system import System, wait_for  # noqa: E402


def xdotool(*words):
    return subprocess.run(('xdotool',) + words, stdout=subprocess.PIPE,
                          universal_newlines=True).stdout.split()


def test_the_robots_stand_still_within_600_ms():
    import rospy
    from support.robots import Witness, report, seconds_to_standstill
    with System() as system:
        system.screen()
        system.start_master()
        rospy.init_node('killed_test', disable_signals=True)
        system.node('mux', '__name:=mux')
        system.node('gates')
        robots = [Witness('bot1'), Witness('bot2')]
        rospy.set_param('/bot1', {'robot_type': 'turtlebot2'})
        rospy.set_param('/bot2', {'robot_type': 'turtlebot3', 'robot_model': 'burger'})
        for robot in robots:
            system.node('sim_robot', '__name:=base', '__ns:=/' + robot.name)
        panel = system.node('panel', '--fresh', '--select', 'bot1 bot2')
        window = wait_for(lambda: xdotool('search', '--onlyvisible', '--name', '^mhri'), 60,
                          'the window of the panel', poll_s=0.1)[0]

        def press():
            xdotool('windowfocus', '--sync', window, 'keyup', 'a', 'keydown', 'a')
            deadline = time.monotonic() + 2.0
            while time.monotonic() < deadline:
                if all(robot.moving() and robot.latest().angular_rad_s > 1.0 for robot in robots):
                    return True
                time.sleep(0.01)
            return False

        wait_for(lambda: all(robot.live() for robot in robots), 40, 'the robots')
        wait_for(press, 40, 'the key to drive both robots')
        since = time.monotonic()
        system.kill(panel, family=False)
        times = seconds_to_standstill(robots, since)
        xdotool('keyup', 'a')
        report('panel killed (SIGKILL) while a key drives', times)
        assert max(times.values()) <= 0.6
        rospy.signal_shutdown('done')
