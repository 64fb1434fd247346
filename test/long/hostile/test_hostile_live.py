# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Every topic, service, port and parameter of the driving path under fire, while robots are driven.

Nothing dies, nothing moves but for the legitimate stick, STOP ALL works within 50 ms after each
batch, what is logged and what memory is taken stays bounded. ``MHRI_SEED`` repeats a run,
``MHRI_LONG=1`` is the long form (twenty times as much).
"""
import socket
import struct
import time
from urllib.parse import urlsplit
import xmlrpc.client

import pytest

from support import graph
from support.hostile import Hostile, is_long, seed_of
from support.hostile_wire import (
    call, class_of, Fixed, handshake, torn_call, torn_class)
from support.ros_system import wait_for
from support.under_fire import ROBOTS, table, UnderFire

FACTOR = 20 if is_long() else 1
MESSAGES = 40 * FACTOR
# A line a second for each kind of mishap, in each of the programs, and what drive() makes them say.
# The mux has the services of what were two nodes.
MAX_LINES, MAX_LINES_PER_S = 160, 20.0
GROWTH_MB = 60.0

JOY, TWIST, TEAM = 'sensor_msgs/Joy', 'geometry_msgs/Twist', 'mhri/TeamTwist'
TOPICS = (
    (graph.PEDAL, JOY), (graph.STICK, JOY), (graph.PAD, JOY), (graph.VOICE, JOY),
    (graph.MODE_SELECT, 'mhri/ControlMode'),
    (graph.TASK_INPUT, TEAM), (graph.DRIVE_STATE, 'mhri/DriveState'),
    (graph.SELECT, 'mhri/RobotSelect'),
    ('/bot1/odom', 'nav_msgs/Odometry'),
    ('/bot1/mhri_guard/echo', 'geometry_msgs/TwistStamped'),
    (graph.PANEL_REQUEST, 'mhri/PanelRequest'), (graph.HEARD, 'mhri/Heard'))
# Anybody's word counts where it is a good one: these are no attacks.
SOURCES = ('joy', 'ps3joy', 'voice')


@pytest.fixture(scope='module')
def fire():
    with UnderFire() as system:
        system.hostile = Hostile(seed_of(20261122))
        system.drive()
        # What is loaded at the first message of each kind, and the first stop, is no growth.
        system.stop_all()
        system.wait_loaded()
        system.begun = system.sizes()
        system.sent, system.speakers = {}, {}
        yield system
        print('\nMEASURED sent: {} messages, {} calls, {} connections, {} parameters'.format(*(
            system.sent.get(kind, 0) for kind in ('messages', 'calls', 'connections',
                                                  'parameters'))))
        print('MEASURED stop-all, {} times: median {:.1f} ms, longest {:.1f} ms'.format(
            len(system.stops), 1000 * sorted(system.stops)[len(system.stops) // 2],
            1000 * max(system.stops)))
        table(system.begun, system.sizes())


def count(fire, kind, number=1):
    fire.sent[kind] = fire.sent.get(kind, 0) + number


def is_attack(topic, message):
    """Return whether a message is nothing that anybody may ask for."""
    import math
    if topic == graph.PEDAL:
        return len(message.axes) < 2 or not all(map(math.isfinite, message.axes[:2]))
    if topic == graph.MODE_SELECT:
        return message.source not in SOURCES
    if topic == graph.TASK_INPUT:
        return not set(message.robots) & set(ROBOTS)
    return True


def plausible(kind, random):
    """Return what a stranger would say who knows the system, None where it is anybody's right."""
    message = kind()
    if hasattr(message, 'linear'):
        message.linear.x, message.angular.z = 0.3, random.uniform(-1.0, 1.0)
    elif kind._type == TEAM:
        message.robots = list(ROBOTS)
        message.twists = [plausible(class_of(TWIST), random) for _ in ROBOTS]
    elif kind._type == 'mhri/RobotSelect':
        message.robots = [random.choice(ROBOTS)]
    elif kind._type == 'mhri/DriveState':
        message.operator, message.leased = random.choice(('/attacker', '')), True
    elif kind._type == 'sensor_msgs/Joy':
        message.axes, message.buttons = [random.uniform(-1.0, 1.0) for _ in range(8)], [1] * 12
    return message


def speaker(fire, topic, kind):
    """Return the publisher of a topic, connected.

    It stays: rospy's subscribers knock for half a minute at one that was given back, and take no
    other of that node meanwhile. Bytes that are no message cost its connection each time.
    """
    import rospy
    if topic not in fire.speakers:
        fire.speakers[topic] = rospy.Publisher(topic, kind, queue_size=1000)
    wait_for(fire.speakers[topic].get_num_connections, what='somebody to listen to ' + topic)
    return fire.speakers[topic]


def speak(fire, topic, kind, number):
    """Send hostile messages on one topic, and bytes that are none behind them."""
    import rospy
    hostile, random = fire.hostile, fire.hostile.random
    publisher, torn = speaker(fire, topic, kind), torn_class(kind, hostile)
    for place in range(number):
        message = torn() if place >= 0.8 * number else plausible(kind, random) \
            if random.random() < 0.25 else hostile.message(kind, class_of)
        if place < 0.8 * number and not is_attack(topic, message):
            continue
        try:
            publisher.publish(message)
            count(fire, 'messages')
        except rospy.ROSSerializationException:
            pass  # it could not be sent
        time.sleep(0.002)
    if topic.endswith('/mhri_guard/echo'):
        # Or it is a guard of another version, which is not driven past while it is there.
        message = kind()
        message.header.frame_id = 'a:1:token'
        speaker(fire, topic, kind).publish(message)
    time.sleep(0.05)


def under_attack(fire, attack):
    """Attack while everything drives, and again under STOP ALL; hold everybody to the promises."""
    lines, begun = fire.lines(), time.monotonic()
    fire.drive()
    attack()
    fire.stop_all()
    attack()
    fire.check_alive()
    fire.check_stands(fire.stopped_at)
    fire.check_straight()
    seconds = time.monotonic() - begun
    for name, number in fire.lines().items():
        assert number - lines[name] <= MAX_LINES + MAX_LINES_PER_S * seconds, \
            '{} wrote {} lines in {:.1f} s'.format(name, number - lines[name], seconds)


# Each alone in the long form, so that what did harm is known by its name.
BATCHES = [[row] for row in TOPICS] if is_long() else [TOPICS[first::3] for first in range(3)]


@pytest.mark.parametrize('batch', BATCHES, ids=lambda batch: ' '.join(row[0] for row in batch))
def test_topics(fire, batch):
    def attack():
        for topic, ros_type in batch:
            speak(fire, topic, class_of(ros_type), MESSAGES // 2)
    under_attack(fire, attack)


def test_who_sent_bytes_that_are_no_message_is_heard_again(fire):
    """rospy took what was left of them for the header of the next connection, and gave up."""
    import rospy
    kind, name = class_of(TEAM), ROBOTS[-1]
    publisher = speaker(fire, graph.TASK_INPUT, kind)
    fire.drive()
    # It stands: from now on it obeys its task.
    fire.order('select', *ROBOTS[:-1])
    wait_for(lambda: not fire.robots[name].moves(), what='it to be let go of')
    publisher.publish(torn_class(kind, Fixed(b'\x55' * 20))())
    good = kind(robots=[name], twists=[class_of(TWIST)()])
    good.twists[0].linear.x = 0.1
    begun = time.monotonic()

    def is_heard():
        good.header.stamp = rospy.Time.now()
        publisher.publish(good)
        return fire.robots[name].moves()
    wait_for(is_heard, what='it to be heard again', poll_s=0.05)
    print('MEASURED heard again after {:.1f} s'.format(time.monotonic() - begun))


def test_a_released_stick_stays_released(fire):
    """All topics at once, with the stick centred: nobody moves."""
    fire.drive()
    fire.hold(0.0)
    since = fire.stands()
    for topic, ros_type in TOPICS:
        speak(fire, topic, class_of(ros_type), 4 * FACTOR)
    fire.check_alive()
    fire.check_stands(since)


def service_uri(name):
    import rosgraph
    return urlsplit(rosgraph.Master('/attacker').lookupService(name))


def test_services(fire):
    import rosgraph
    hostile = fire.hostile
    names = [name for name, nodes in rosgraph.Master('/attacker').getSystemState()[2]
             if set(nodes) & {'/mux', '/mhri_panel'}]
    assert len(names) >= 6, names

    def attack():
        for name in names:
            uri = service_uri(name)
            for _ in range(3 * FACTOR):
                good = handshake(callerid='/attacker', service=name, md5sum='*')
                # Never a good request behind a good header: anybody may lift a stop.
                tail = struct.pack('<I', hostile.random.choice((2 ** 32 - 1, 2 ** 31, 99))) \
                    + hostile.torn()
                bad = handshake(callerid=hostile.text(), service=hostile.text(),
                                md5sum=hostile.text(), probe=hostile.text(), type=hostile.text())
                for header, body in ((good, tail), (bad, tail), (b'', hostile.torn())):
                    torn_call(uri, header, body, 0.05)
                    count(fire, 'calls')
    under_attack(fire, attack)


def test_anybody_may_take_control_and_nothing_moves_by_it(fire):
    import rospy
    from mhri.msg import RobotSelect
    from std_srvs.srv import SetBool, Trigger
    fire.drive()
    # Who publishes no selection is refused.
    rospy.Publisher(graph.SELECT, RobotSelect, queue_size=1)
    wait_for(lambda: rospy.ServiceProxy(graph.TAKE_CONTROL, Trigger)().success, what='control')
    since = fire.stands()
    for _ in range(3):
        rospy.ServiceProxy(graph.TAKE_CONTROL, Trigger)()
        rospy.ServiceProxy(graph.SET_MOTOR_POWER, SetBool)(True)
        count(fire, 'calls', 2)
    fire.check_stands(since)
    fire.stop_all()
    fire.check_straight()


def node_uris():
    import rosgraph
    master = rosgraph.Master('/attacker')
    return {name: urlsplit(master.lookupNode(name)) for name in ('/mux',)}


def test_ports(fire):
    """Bytes that are no handshake, connections that say nothing, absurd calls of the slave API."""
    hostile, silent = fire.hostile, []

    def attack():
        for name, uri in node_uris().items():
            proxy = xmlrpc.client.ServerProxy(uri.geturl())
            tcpros = proxy.requestTopic('/attacker', '/rosout', [['TCPROS']])[2]
            for _ in range(5 * FACTOR):
                for port in (uri.port, tcpros[2]):
                    link = socket.create_connection((uri.hostname, port), 20.0)
                    link.settimeout(0.02)
                    try:
                        link.sendall(hostile.torn() if hostile.random.random() < 0.7 else handshake(
                            callerid=hostile.text(), topic='/rosout', md5sum=hostile.text()))
                    except OSError:
                        pass
                    # Some hang on and say no more.
                    (silent.append if len(silent) < 30 else lambda one: one.close())(link)
                    count(fire, 'connections')
                call(proxy, hostile)
                count(fire, 'calls')
    under_attack(fire, attack)
    for link in silent:
        link.close()


KEYS = (
    '/mhri/robots', '/bot1', '/bot1/robot_type', '/bot1/robot_model', '/bot1/mhri',
    '/bot1/mhri/limits', '/bot1/mhri/limits/linear_mps', '/bot1/mhri/command',
    '/bot1/mhri/odometry',
    '/bot1/mhri/odometry_type', '/bot1/mhri/motor_power', '/bot1/mhri/hardware_stop',
    '/bot1/mhri/silent_after_s', '/bot1/mhri/label', '/bot2/mhri/imu', '/mux', graph.SOURCES,
    '/mux/robots', '/mux/enabling', '/mux/dead_man', '/mhri', '/mhri_panel', '/mhri/panel',
    '/mhri/panel/thumbnail_hz', '/mhri/panel/record_warn_free_mb', '/robot_name', '/robot_type',
    '/robot_model', '/tf_prefix', '/run_id')


def set_parameter(fire, key, value):
    import rospy
    try:
        rospy.set_param(key, value)
        count(fire, 'parameters')
    except (OverflowError, xmlrpc.client.Error, rospy.ROSException, TypeError):
        pass  # it could not be sent


def restore_parameters(kept):
    import rospy
    for key in set(rospy.get_param_names()) - set(kept):
        try:
            rospy.delete_param(key)
        except (KeyError, rospy.ROSException, xmlrpc.client.Error):
            pass  # it went with another
    for name in ROBOTS:
        rospy.set_param('/' + name, {'robot_type': 'generic'})
    for key, value in kept.items():
        rospy.set_param(key, value)


def test_parameters(fire):
    """Values of every type and shape under every name that is read while it runs."""
    import rospy
    hostile = fire.hostile
    kept = {key: rospy.get_param(key) for key in rospy.get_param_names()}

    def attack():
        for key in KEYS:
            for _ in range(FACTOR):
                begun = time.monotonic()
                set_parameter(fire, key, hostile.value())
                if time.monotonic() - begun > 1.0:
                    print('slow: {} took {:.1f} s'.format(key, time.monotonic() - begun))
            time.sleep(0.01)
        # Mux and panel look once a second.
        time.sleep(1.2)
        restore_parameters(kept)
        time.sleep(1.2)
    under_attack(fire, attack)


COMMANDS = [['no name!'], ['cmd_vel'] * 2000, [''], ['/'], ['cmd_vel', 'cmd_vel'], ['\u00e9'],
            ['a' * 5000], ['//x']]


@pytest.mark.parametrize('command', COMMANDS if is_long() else COMMANDS[:1])
def test_a_robot_whose_topics_cannot_be_leaves_the_others_alone(fire, command):
    """Parameter of one robot; the other one is driven, and so is this one when it is mended."""
    import rospy
    fire.hold(0.0)
    fire.stands()
    rospy.set_param('/bot1/mhri/command', command)
    time.sleep(1.3)
    fire.check_alive()
    fire.drive('bot2')
    rospy.delete_param('/bot1/mhri/command')
    time.sleep(1.2)
    fire.drive()


def test_memory_is_flat(fire):
    """Behind all of it: what a message took was given back."""
    # The attacker's own connections are still there.
    most = GROWTH_MB, 8 + len(fire.speakers), 24 + len(fire.speakers)

    def grown():
        """Return {name: (memory [MB], threads, descriptors) more} of what is too much."""
        more = {name: tuple(now - then for now, then in zip(sizes, fire.begun[name]))
                for name, sizes in fire.sizes().items()}
        return {name: sizes for name, sizes in more.items()
                if any(size > limit for size, limit in zip(sizes, most))}
    wait_for(lambda: not grown(), what=lambda: 'less than {}'.format(grown()), poll_s=0.5)
