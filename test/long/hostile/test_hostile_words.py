# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A stranger who speaks as the mux: robots drive on, the stick stays whose it is.

And the screen shows what is; who was not believed is counted and named.
"""
import ast
import time

import pytest

from support import graph
from support.ros_system import insist, NotYet, wait_for
from support.under_fire import UnderFire

STRANGER = '/attacker'
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
        wait_for(opened[-1].get_num_connections, what='somebody to listen to ' + name)
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


def drives_on(fire, lies):
    """Fail where robots that are driven are told to stand each time somebody lies.

    A stick that is late does it, too.
    """
    def driven():
        fire.drive()
        begun = time.monotonic()
        lies()
        stood = [name for name, log in fire.robots.items()
                 if not log.after(begun) or not all(any(word[1:]) for word in log.after(begun))]
        if stood:
            raise NotYet('made to stand: {}'.format(stood))
        return True
    # No more patience than for two attempts or three: what lies achieve they achieve each time.
    insist(driven, 'them to be driven on', 9.0)


def test_who_speaks_as_the_mux_changes_nothing(fire, topic):
    """Neither robots nor screen: what it says of stop and mode, and on the mirrors."""
    import rospy
    from geometry_msgs.msg import Twist
    from mhri.msg import DriveState
    from std_msgs.msg import Bool
    stop, twist = (rospy.Publisher(name, kind, queue_size=10) for name, kind in (
        (graph.STOP_ALL, Bool), (graph.COMMAND, Twist)))
    state = topic(graph.DRIVE_STATE, DriveState)

    def lies():
        wait_for(lambda: shown(fire, time.monotonic() - 0.3) == {('pedal', False)},
                 what='the truth')
        begun = time.monotonic()
        lie(LIES_S, (state, DriveState(mode='voice', stop_all=True)), (stop, Bool(True)),
            (twist, Twist()))
        assert shown(fire, begun) == {('pedal', False)}
    drives_on(fire, lies)
    print('MEASURED named by the screen: ' + diagnostics_name('mhri_panel'))
    for mirror in (stop, twist):
        mirror.unregister()


def test_who_speaks_as_the_mux_gives_nobody_the_stick(fire, topic):
    """The operator in control owns the virtual joystick: who says it is me, might drive."""
    from mhri.msg import DriveState
    from sensor_msgs.msg import Joy
    fire.drive()
    fire.order('mode', 'joy')
    wait_for(lambda: shown(fire, time.monotonic() - 0.3) == {('joy', False)},
             what='the mode')
    fire.order('stick', '0.0', '0.0')
    state, stick = topic(graph.DRIVE_STATE, DriveState), topic(graph.STICK, Joy)
    mine = DriveState(operator=STRANGER, leased=True)
    begun = time.monotonic()
    lie(1.0, (state, mine), (stick, Joy(axes=[0.0, 0.0])))
    lie(1.0, (state, mine), (stick, Joy(axes=[0.0, 0.9])))
    fire.check_stands(begun + 0.1)
    fire.order('mode', 'pedal')


def test_readings_that_cannot_be_are_counted(fire, topic):
    """What a feed of the screen leaves out is in the screen's diagnostics, by robot and view."""
    from sensor_msgs.msg import Imu
    fire.order('view', 'bot1', 'imu')
    imu = topic('/bot1/imu', Imu)
    message = Imu()
    message.angular_velocity.z = 1e30
    lie(1.0, (imu, message))
    print('MEASURED ' + diagnostics_name('mhri_panel', 'bot1: imu refused'))
