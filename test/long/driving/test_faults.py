# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What stops the robots when a part of the system dies while they are driven, and how fast.

Everything is real: master, mux, panel with its windows on a virtual screen, simulated robots
in processes of their own. Each test prints the measured times; the limits asserted are those
promised plus the deceleration of the robots and one odometry reading.
"""
import signal
import time

import pytest

from support import graph
from support.journals import Journal
from support.ros_system import freeze, insist, System, wait_for

# Deceleration from the speeds driven here, and the next odometry message [s].
BRAKING_S = 0.35
ROBOTS = ('bot1', 'bot2')


class Bench:
    """The whole system, driven by a stick of the test's own."""

    def __init__(self):
        import rospy
        from mhri.graph.ros.master_watch import MasterWatch
        from mhri.msg import ControlMode
        from support.robots import Stick, Witness
        self.system = System()
        self.system.screen()
        self.system.start_master()
        # As the node of the pedal: it may choose the mode.
        rospy.init_node('mhri_pedal', disable_signals=True)
        self.watch = MasterWatch().start()
        self.journal = Journal(self.system.home)
        self.start_mux()
        self.robots = {name: self.start_robot(name, number)
                       for number, name in enumerate(ROBOTS)}
        self.witnesses = [Witness(name) for name in ROBOTS]
        self.panel = self.start_panel()
        self.stick = Stick()
        self._mode_class = ControlMode
        self._mode = rospy.Publisher(graph.MODE_SELECT, ControlMode, queue_size=1, latch=True)
        self._mode.publish('pedal')
        wait_for(lambda: all(witness.live() for witness in self.witnesses), 30, 'the robots')

    def start_mux(self):
        self.mux = self.system.node('mux', '__name:=mux', self.journal.argument)

    def start_robot(self, name, number):
        """Start the node that turtlebot.launch starts; roslaunch itself would take seconds."""
        import rospy
        rospy.set_param('/' + name, ({'robot_type': 'turtlebot2'}, {
            'robot_type': 'turtlebot3', 'robot_model': 'burger'})[number])
        return self.system.node('sim_robot', '__name:=base', '__ns:=/' + name,
                                '_x:={}'.format(2.0 + 2.0 * number), '_y:=1.5')

    def start_panel(self):
        return self.system.node('panel', '--fresh', '--select', ' '.join(ROBOTS),
                                '__name:=mhri_panel')

    def drive(self):
        """Drive all robots in a circle on the spot; return when they do."""
        def moving():
            return all(witness.moving() for witness in self.witnesses)

        def steadily():
            if not moving():
                self.stick.drive(0.3, 0.5, moving, 60, 'the robots to be driven')
            time.sleep(0.3)
            return moving()
        insist(steadily, 'the robots to be driven')

    def close(self):
        import rospy
        rospy.signal_shutdown('done')
        self.system.close()


@pytest.fixture(scope='module')
def bench():
    built = Bench()
    yield built
    built.close()


def stand_after(bench, event, since, promised_s):
    """Wait for standstill, and hold the last robot to what is promised of its zero."""
    from support.robots import report, seconds_to_standstill
    from support.node_tools import measured
    times = seconds_to_standstill(bench.witnesses, since)
    report(event, times)
    measured(event + ': the last one stands', max(times.values()), promised_s + BRAKING_S)


def test_the_panel_hangs(bench):
    """The pad goes on, but nobody could see or stop anything on the screen: its lease runs out."""
    bench.drive()
    since = freeze(bench.panel.pid)
    try:
        stand_after(bench, 'panel hung (SIGSTOP)', since, 1.6)
    finally:
        bench.panel.send_signal(signal.SIGCONT)
    bench.drive()


def test_the_panel_is_terminated(bench):
    bench.drive()
    since = time.monotonic()
    bench.panel.send_signal(signal.SIGTERM)
    stand_after(bench, 'panel terminated (SIGTERM)', since, 0.05)
    assert bench.panel.wait(60) == 0
    bench.panel = bench.start_panel()


def test_every_velocity_that_left_is_what_the_drive_says(bench):
    bench.drive()
    bench.journal.conforms()
