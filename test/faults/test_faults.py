# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What stops the robots when a part of the system dies while they are driven, and how fast.

Everything is real: master, mux, gates, panel with its windows on a virtual screen, simulated robots
in processes of their own. Each test prints the measured times; the limits asserted are those
promised plus the deceleration of the robots and one odometry reading.
"""
import os
import signal
import sys
import time

import pytest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..'))

from support.ros_system import System, wait_for  # noqa: E402

# Deceleration from the speeds driven here, and the next odometry message.
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
        self.mux = self.system.node('mux', '__name:=mux')
        self.gates = self.system.node('gates')
        self.robots = {name: self.start_robot(name, number)
                       for number, name in enumerate(ROBOTS)}
        self.witnesses = [Witness(name) for name in ROBOTS]
        self.panel = self.start_panel()
        self.stick = Stick()
        self._mode_class = ControlMode
        self._mode = rospy.Publisher('/mux_in/mode_select', ControlMode, queue_size=1, latch=True)
        self._mode.publish('pedal')
        wait_for(lambda: all(witness.live() for witness in self.witnesses), 30, 'the robots')

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
        def through():
            if all(witness.moving() for witness in self.witnesses):
                return True
            self.stick.hold(0.0, 0.0)
            time.sleep(0.12)
            self.stick.hold(0.3, 0.5)
            deadline = time.monotonic() + 0.6
            while time.monotonic() < deadline:
                if all(witness.moving() for witness in self.witnesses):
                    return True
                time.sleep(0.01)
            return False

        def steadily():
            if not through():
                return False
            time.sleep(0.3)
            return all(witness.moving() for witness in self.witnesses)
        wait_for(steadily, 60, 'the robots to be driven')

    def close(self):
        import rospy
        rospy.signal_shutdown('done')
        self.system.close()


@pytest.fixture(scope='module')
def bench():
    built = Bench()
    yield built
    built.close()


def measured(bench, event, since, witnesses=None):
    """Wait for standstill and print the times; return the longest."""
    from support.robots import report, seconds_to_standstill
    times = seconds_to_standstill(witnesses or bench.witnesses, since)
    report(event, times)
    return max(times.values())


def test_released_stick(bench):
    bench.drive()
    since = time.monotonic()
    bench.stick.hold(0.0, 0.0)
    assert measured(bench, 'stick released', since) <= 0.05 + BRAKING_S


def test_the_mux_is_killed_and_comes_back(bench):
    bench.drive()
    since = time.monotonic()
    bench.system.kill(bench.mux)
    assert measured(bench, 'mux killed (SIGKILL)', since) <= 0.55 + BRAKING_S
    bench.mux = bench.system.node('mux', '__name:=mux')
    bench.drive()


def test_the_mux_is_terminated(bench):
    bench.drive()
    since = time.monotonic()
    bench.mux.send_signal(signal.SIGTERM)
    assert measured(bench, 'mux terminated (SIGTERM)', since) <= 0.05 + BRAKING_S
    bench.mux.wait(10)
    bench.mux = bench.system.node('mux', '__name:=mux')


def test_the_panel_is_killed_and_started_again(bench):
    bench.drive()
    since = time.monotonic()
    bench.system.kill(bench.panel, family=False)
    try:
        assert measured(bench, 'panel killed (SIGKILL)', since) <= 0.6
    finally:
        bench.panel = bench.start_panel()
    bench.drive()


def test_the_panel_hangs(bench):
    """The pad goes on, but nobody could see or stop anything on the screen: its lease runs out."""
    bench.drive()
    since = time.monotonic()
    bench.panel.send_signal(signal.SIGSTOP)
    try:
        assert measured(bench, 'panel hung (SIGSTOP)', since) <= 1.6 + BRAKING_S
    finally:
        bench.panel.send_signal(signal.SIGCONT)
    bench.drive()


def test_the_gates_are_killed_and_come_back(bench):
    bench.drive()
    since = time.monotonic()
    bench.system.kill(bench.gates)
    bench.gates = bench.system.node('gates')
    assert measured(bench, 'gates killed (SIGKILL)', since) <= 1.5 + BRAKING_S
    bench.drive()


def test_the_gates_are_terminated(bench):
    bench.drive()
    since = time.monotonic()
    bench.gates.send_signal(signal.SIGTERM)
    assert measured(bench, 'gates terminated (SIGTERM)', since) <= 0.05 + BRAKING_S
    bench.gates.wait(10)
    bench.gates = bench.system.node('gates')
    bench.drive()


def test_the_panel_is_terminated(bench):
    bench.drive()
    since = time.monotonic()
    bench.panel.send_signal(signal.SIGTERM)
    assert measured(bench, 'panel terminated (SIGTERM)', since) <= 0.05 + BRAKING_S
    bench.panel.wait(10)
    assert bench.panel.returncode == 0
    bench.panel = bench.start_panel()


def test_a_robot_is_killed_and_started_again(bench):
    bench.drive()
    bench.system.kill(bench.robots['bot2'])
    other = bench.witnesses[0]
    since = time.monotonic()
    wait_for(lambda: not bench.witnesses[1].live(), 5, 'bot2 to be gone')
    assert other.moving(), 'the other robot was disturbed'
    bench.robots['bot2'] = bench.start_robot('bot2', 1)
    wait_for(bench.witnesses[1].live, 20, 'bot2 to be back')
    print('MEASURED bot2 killed and started again: heard after {:.1f} s, bot1 driving all the '
          'time'.format(time.monotonic() - since))
    bench.stick.hold(0.0, 0.0)
    wait_for(lambda: all(witness.at_rest() for witness in bench.witnesses), 5, 'rest')
    bench.drive()


def test_the_master_is_restarted(bench):
    bench.drive()
    since = time.monotonic()
    bench.system.kill(bench.system.master)
    assert measured(bench, 'master killed', since) <= 1.5 + BRAKING_S
    bench.system.start_master()
    begun = time.monotonic()
    bench.drive()
    print('MEASURED master restarted: driving again {:.1f} s after it'.format(
        time.monotonic() - begun))


def test_the_device_falls_silent(bench):
    bench.drive()
    since = time.monotonic()
    bench.stick.unplug()
    assert measured(bench, 'device silent', since) <= 0.55 + 0.05 + BRAKING_S
