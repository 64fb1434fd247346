# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A panel that is killed while a real key, pressed in the X server, drives two robots."""
import time

from support.keyboard import xdotool
from support.ros_system import insist, NotYet, System, wait_for
from support.windows import windows_called


def test_the_robots_stand_still_within_600_ms():
    import rospy
    from support.fake_mux import StateEar
    from support.robots import Witness, seconds_to_standstill
    from support.node_tools import measured
    with System() as system:
        system.screen()
        system.start_master()
        rospy.init_node('killed_test', disable_signals=True)
        system.node('mux', '__name:=mux')
        robots = [Witness('bot1'), Witness('bot2')]
        rospy.set_param('/bot1', {'robot_type': 'turtlebot2'})
        rospy.set_param('/bot2', {'robot_type': 'turtlebot3', 'robot_model': 'burger'})
        for robot in robots:
            system.node('sim_robot', '__name:=base', '__ns:=/' + robot.name)
        panel = system.node('panel', '--fresh', '--select', 'bot1 bot2')
        window, = wait_for(lambda: windows_called('^mhri'), what='the window of the panel')

        def press():
            xdotool('windowfocus', '--sync', window, 'keydown', 'a')
            try:
                return wait_for(lambda: all(robot.moving() and robot.latest().angular_rad_s > 1.0
                                            for robot in robots), 5.0, 'both robots to move')
            except NotYet:
                xdotool('keyup', 'a')
                raise

        wait_for(lambda: all(robot.live() for robot in robots), what='the robots')
        state = StateEar()
        state.wait(lambda said: not said.waits_for and len(said.robots) == 2 and all(
            robot.selected and robot.topic and not robot.stands for robot in said.robots),
            'both robots to be ready')
        # One that is first heard after that waits for neutral again. Let go, the key is left up
        # until that has been read.
        insist(press, 'the key to drive both robots', poll_s=0.5)
        since = time.monotonic()
        system.kill(panel, family=False)
        for name, took in seconds_to_standstill(robots, since).items():
            measured('panel killed while a key drives: {} stands'.format(name), took, 0.6)
        rospy.signal_shutdown('done')
