# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A stranger who speaks as mux or as gates: robots drive on, the stick stays whose it is.

And the screen shows what is; who was not believed is counted and named.
"""
import ast
import os
import sys
import time

import pytest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..'))

from support.ros_system import wait_for  # noqa: E402
from support.under_fire import UnderFire  # noqa: E402

STRANGER = '/attacker'
# The mux takes over a stop that the gates have held for 1 s.
LIES_S = 2.5


@pytest.fixture(scope='module')
def fire():
    with UnderFire() as system:
        system.drive()
        yield system


@pytest.fixture
def topic(fire):
    """Return a function that gives the connected, latched publisher of a topic."""
    import rospy
    opened = []

    def publisher(name, kind):
        opened.append(rospy.Publisher(name, kind, queue_size=10, latch=True))
        wait_for(opened[-1].get_num_connections, 6.0, 'somebody to listen to ' + name)
        return opened[-1]
    yield publisher
    for one in opened:
        one.unregister()


def lie(seconds, *lies):
    """Publish (publisher, message) again and again."""
    until = time.monotonic() + seconds
    while time.monotonic() < until:
        for publisher, message in lies:
            publisher.publish(message)
        time.sleep(0.05)


def shown(fire, since):
    """Return {(mode, stop_all)} that the operator's screen has shown."""
    with open(fire.operator_log) as log:
        lines = [line.split(' ', 3) for line in log if line.endswith('\n')]
    return {ast.literal_eval(words[3])[1:] for words in lines if float(words[0]) > since}


def diagnostics_name(who, what=STRANGER):
    """Wait until a node names something in its diagnostics; return the key and value."""
    import rospy
    from diagnostic_msgs.msg import DiagnosticArray
    named = []

    def hear(message):
        named.extend(value.key + ': ' + value.value for status in message.status
                     for value in status.values
                     if status.name.startswith(who) and what in value.key + value.value)
    ear = rospy.Subscriber('/diagnostics', DiagnosticArray, hear)
    wait_for(lambda: named, 10.0, who + ' to name ' + what)
    ear.unregister()
    return named[-1]


def driven_on(fire, seconds_ago):
    """Fail where a robot was told to stand within the last seconds."""
    since = time.monotonic() - seconds_ago
    for name, log in fire.robots.items():
        stood = [word for word in log.after(since) if not any(word[1:])]
        assert log.after(since) and not stood, '{} was made to stand: {}'.format(name, stood[:3])


def test_who_speaks_as_the_gates_keeps_nobody_standing(fire, topic):
    from mhri.msg import GatesState
    fire.drive()
    state = topic('/gates/state', GatesState)
    begun = time.monotonic()
    lie(LIES_S, (state, GatesState(stop_all=True, mux='/mux', mux_heard=True)))
    driven_on(fire, time.monotonic() - begun)
    print('MEASURED named by the mux: ' + diagnostics_name('mux'))
    print('MEASURED named by the screen: ' + diagnostics_name('mhri_panel'))


def test_who_speaks_as_the_gates_gives_nobody_the_stick(fire, topic):
    """The operator in control owns the virtual joystick: who says it is me, might drive."""
    from mhri.msg import GatesState
    from sensor_msgs.msg import Joy
    fire.drive()
    fire.order('mode', 'joy')
    wait_for(lambda: shown(fire, time.monotonic() - 0.3) == {('joy', False)}, 5.0, 'the mode')
    fire.order('stick', '0.0', '0.0')
    state, stick = topic('/gates/state', GatesState), topic('/mux_in/joy', Joy)
    mine = GatesState(operator=STRANGER, mux='/mux', mux_heard=True)
    begun = time.monotonic()
    lie(1.0, (state, mine), (stick, Joy(axes=[0.0, 0.0])))
    lie(1.0, (state, mine), (stick, Joy(axes=[0.0, 0.9])))
    fire.check_stands(begun + 0.1)
    fire.order('mode', 'pedal')


def test_who_speaks_as_mux_or_gates_changes_nothing_on_the_screen(fire, topic):
    from std_msgs.msg import Bool
    from mhri.msg import ControlMode, GatesState
    fire.drive()
    wait_for(lambda: shown(fire, time.monotonic() - 0.3) == {('pedal', False)}, 5.0, 'the truth')
    lies = [(topic('/mux/mode', ControlMode), ControlMode(source='voice')),
            (topic('/robot_controller/stop_all', Bool), Bool(True)),
            (topic('/gates/state', GatesState), GatesState(stop_all=True))]
    begun = time.monotonic()
    lie(LIES_S, *lies)
    assert shown(fire, begun) == {('pedal', False)}
    driven_on(fire, time.monotonic() - begun)


def test_readings_that_cannot_be_are_counted(fire, topic):
    """What a feed of the screen leaves out is in the screen's diagnostics, by robot and view."""
    from sensor_msgs.msg import Imu
    fire.order('view', 'bot1', 'imu')
    imu = topic('/bot1/imu', Imu)
    message = Imu()
    message.angular_velocity.z = 1e30
    lie(1.0, (imu, message))
    print('MEASURED ' + diagnostics_name('mhri_panel', 'bot1: imu refused'))
