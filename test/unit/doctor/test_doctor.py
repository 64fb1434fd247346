# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The doctor's judgement of nodes, connections, robots, mhri's own nodes: a table of ailments."""
from dataclasses import replace
import json

import pytest

from mhri.doctor.facts import (
    Connection, FAULT, FINE, REFUSED, SILENT, STRANGER, Stream, UNRESOLVED, WARNING)
from mhri.doctor.judgement import as_dict, as_lines, diagnose, exit_status, odd_ones
from mhri.doctor.robots import clock_offset, robots_of

from support.doctor_world import (
    add, answer, apart, at, BOOL, BOT_IP, change, HOST_IP, IGNORE, links, ODOMETRY, parameter,
    seen_as, seen_at, stream, TWIST, TYPES, without, World)


def samples(ahead_s, count=20):
    return tuple((100.0 + number, 100.0 + number + ahead_s - 0.002 * (1 + number % 3))
                 for number in range(count))


CASES = {
    'healthy': ([], []),
    'dead': ([answer(state=REFUSED)], ['node_dead']),
    'silent': ([answer(state=SILENT)], ['host_silent']),
    'hangs beside one that answers': (
        [answer(state=SILENT), add('/bot1/camera', host=BOT_IP, publish=['/bot1/x'])],
        ['node_silent', 'velocity_unheard']),
    'its other network': ([answer(host='198.51.100.5', state=SILENT),
                           add('/bot1/cam', ['/bot1/x'], host=BOT_IP)],
                          ['node_address', 'velocity_unheard']),
    'its other network, by its connections': (
        [answer(host='198.51.100.5', state=REFUSED), seen_at(base=BOT_IP)], ['node_address']),
    'lost from where it was connected': (
        [answer(state=SILENT), seen_at(base=BOT_IP)], ['host_silent']),
    'its other network, and the host has a node of its name': (
        [answer(state=SILENT), add('/bot1/rviz', ['/bot1/x'])],
        ['host_silent', 'velocity_unheard']),
    'loopback, refused': ([answer(host='127.0.0.1', state=REFUSED),
                           add('/bot1/cam', ['/bot1/x'], host=BOT_IP)],
                          ['node_loopback', 'velocity_unheard']),
    'unresolved': ([answer(state=UNRESOLVED)], ['host_unresolved']),
    'no node at all': ([answer(state=STRANGER)], ['node_stranger']),
    'another node there': ([stream('/bot1/odom', callerid='/other')], ['node_stranger']),
    'loopback': ([answer(host='127.0.0.1'), add('/bot1/cam', ['/bot1/x'], host=BOT_IP)],
                 ['node_loopback']),
    'forgotten topic': ([answer(publications={})], ['registration_stale']),
    'moved': ([answer(uri_later='http://192.0.2.8:4000/')], ['name_fought']),
    'same name twice': ([links('/mux', Connection(True, '/bot1/cmd_vel', '/bot1/base'))],
                        ['name_twice']),
    'forgotten node': ([links('/mux', Connection(True, '/mux/mode', '/lost'))],
                       ['node_forgotten']),
    'a doctor is no forgotten node': (
        [links('/mux', Connection(True, '/mux/mode', '/mhri_doctor_77'))], []),
    'does not reach back': ([apart(('/bot1/cmd_vel', '/mux', '/bot1/base'))], ['one_way']),
    'not reached': ([apart(('/bot1/odom', '/bot1/base', '/mhri_panel'))], ['one_way']),
    'definitions differ': (
        [apart(('/mux/state', '/mux', '/mhri_panel'))], ['definition_differs']),
    'names of types differ': (
        [apart(('/bot1/cmd_vel', '/mux', '/bot1/base')),
         seen_as('/bot1/cmd_vel', BOOL, '/bot1/base')], ['type_differs']),
    'md5 differs': ([stream('/bot1/odom', md5sum='other')], ['md5_differs']),
    'message unknown': ([add('/x', ['/x/y'], kind='turtlesim/Odd')], ['message_unknown']),
    'message that mhri does not read': ([add('/x', ['/x/y'], kind='kobuki_msgs/Odd')], []),
    'no mux': ([without('/mux')], ['mux_missing']),
    'no panel': ([without('/mhri_panel')], []),
    'two muxes': ([add('/mux_2', ['/mux/mode'])], ['mux_several']),
    'mux bypassed': ([add('/rogue', ['/robot_controller/twist'])], ['mux_bypassed']),
    'stop bypassed': ([add('/rogue', ['/robot_controller/stop_all'])], ['mux_bypassed']),
    'state bypassed': ([add('/rogue', ['/mux/state'])], ['mux_bypassed']),
    'mux dead': ([change('/mux', state=REFUSED)], ['mux_missing', 'node_dead']),
    'mux hangs': ([change('/mux', state=SILENT)], ['mux_silent']),
    'mux answers, but says nothing': ([stream('/mux/state', messages=0)], ['mux_silent']),
    'mux repeats an old state': (
        [stream('/mux/state', samples=((100.0, 98.0),))], ['mux_silent']),
    'mux of another computer': (
        [stream('/mux/state', samples=((100.0, 98.0),)), at('/mux', BOT_IP)], []),
    'mux in simulated time': (
        [stream('/mux/state', samples=((100.0, 9.0),)), parameter(use_sim_time=True),
         add('/gazebo', ['/clock'])], []),
    'mux refuses somebody': (
        [stream('/mux/state', refused=('/rogue: joy, 3 times', '/gone: joy, 1 times')),
         add('/rogue', ['/x'])], ['mux_refused']),
    'mux refused somebody who has gone': (
        [stream('/mux/state', refused=('/rogue: joy, 3 times',))], []),
    'two sticks': ([add('/script', ['/mux_in/joy']), add('/mhri_panel', ['/mux_in/joy'])],
                   ['stick_several']),
    'two panels, two sticks': (
        [add('/panel_2', ['/robot_controller/robot_select', '/mux_in/joy']),
         add('/mhri_panel', ['/mux_in/joy'])], ['panel_several']),
    'two panels': ([add('/panel_2', ['/robot_controller/robot_select'])], ['panel_several']),
    'no clock': ([parameter(use_sim_time=True)], ['sim_time']),
    'clock': ([parameter(use_sim_time=True), add('/gazebo', ['/clock'])], []),
    'untyped': ([parameter(bot1={})], ['robot_untyped']),
    'unknown type': ([parameter(bot1={'robot_type': 'tank'})], ['robot_type_unknown']),
    'bad parameter': ([parameter(bot1={'robot_type': 'generic', 'mhri': {'limits': 3}})],
                      ['parameter_bad']),
    'unknown model': ([parameter(bot1={'robot_type': 'generic', 'robot_model': 'x'})],
                      ['parameter_bad']),
    'leftover': ([parameter(bot9={'robot_type': 'generic'})], ['robot_leftover']),
    'bad name': ([add('/_bot/base', ['/_bot/x'])], ['robot_name_bad']),
    'in the list of the panel': ([parameter(mhri={'robots': ['bot1', 'bot7']})], ['robot_absent']),
    'foreign velocity': ([add('/key', ['/bot1/cmd_vel'])], ['velocity_foreign']),
    'its own navigation': ([add('/bot1/move_base', ['/bot1/cmd_vel'], host=BOT_IP)], []),
    'its own twist_mux': ([add('/bot1/twist_mux', ['/bot1/cmd_vel'], ['/bot1/nav_vel'],
                               host=BOT_IP)], []),
    'its own twist_mux, of another name': (
        [add('/twist_mux', ['/bot1/cmd_vel'], ['/bot1/nav_vel'], host=BOT_IP)], []),
    'a key below its name on the desk': (
        [add('/bot1/key', ['/bot1/cmd_vel'])], ['velocity_foreign']),
    'its guard': ([add('/bot1/mhri_guard', ['/bot1/cmd_vel'], host=BOT_IP)], []),
    'the guard of another robot': (
        [add('/bot2/mhri_guard', ['/bot1/cmd_vel'], host=BOT_IP)],
        ['odometry_missing', 'robot_untyped', 'velocity_foreign', 'velocity_unheard']),
    'a panel that drives': ([add('/mhri_panel_2', ['/bot1/cmd_vel'])], ['velocity_foreign']),
    'a gate keeper of an old release': (
        [add('/mhri_gate_keeper_1', ['/bot1/cmd_vel'])], ['velocity_foreign']),
    'mux of another name': (
        [without('/mux'), add('/lab_mux', ['/mux/mode', '/bot1/cmd_vel'])], []),
    'its watchdog tried': ([add('/mhri_doctor_77', ['/bot1/cmd_vel'])], []),
    'past the guard': ([add('/rogue', ['/bot1/mhri_guard/command']),
                        add('/bot1/mhri_guard', (), ['/bot1/mhri_guard/command'], host=BOT_IP)],
                       ['velocity_foreign']),
    'hidden velocity': (
        [links('/bot1/base', Connection(False, '/bot1/cmd_vel', 'http://192.0.2.9:1/'))],
        ['velocity_hidden']),
    'topic of another type': ([add('/bot1/imu', ['/bot1/imu'], host=BOT_IP)], ['topic_type']),
    'two odometries': ([add('/bot1/other', ['/bot1/odom'], host=BOT_IP)], ['odometry_twice']),
    'silent odometry': ([stream('/bot1/odom', messages=0)], ['odometry_silent']),
    'clock a little off': ([stream('/bot1/odom', samples=samples(-0.05))], []),
    'clock off': ([stream('/bot1/odom', samples=samples(-0.3))], ['clock_offset']),
    'clock far off': ([stream('/bot1/odom', samples=samples(5.0))], ['clock_offset']),
}


@pytest.mark.parametrize('case', sorted(CASES))
def test_ailment(case):
    """Each is found, and nothing else."""
    spoils, expected = CASES[case]
    world = World()
    for spoil in spoils:
        spoil(world)
    assert sorted(item.check for item in world.wrong()) == expected


SCAN, IMAGE = 'sensor_msgs/LaserScan', 'sensor_msgs/Image'
CAMERA = '/bot1/camera/rgb/image_raw'


@pytest.mark.parametrize('seen, found', [
    (dict(messages=0), ['scan_silent']), (dict(beams=(360, 0, 0, 0)), ['scan_blind']),
    (dict(beams=(360, 0, 0, 360)), ['scan_blind']), (dict(beams=(360, 0, 1, 359)), []),
    (dict(beams=(360, 20, 0, 0)), [])])
def test_a_laser(seen, found):
    world = World()
    add('/bot1/laser', ['/bot1/scan'], kind=SCAN, host=BOT_IP)(world)
    stream('/bot1/scan', **seen)(world)
    assert [item.check for item in world.wrong()] == found


@pytest.mark.parametrize('row, found', [
    ({'topic': 'lamp'}, []), ({'topic': 'horn'}, ['accessory_unheard']),
    ({'topic': 'recorded'}, ['accessory_unheard']),
    ({'topic': 'recorded', 'type': 'odd_msgs/Odd', 'optional': True}, []),
    ({'topic': 'horn', 'optional': True}, []),
    ({'topic': 'lamp', 'type': 'odd_msgs/Odd'}, ['accessory_type']),
    ({'topic': 'lamp', 'type': 'odd_msgs/Odd', 'optional': True}, ['accessory_type']),
    ({'topic': 'horn', 'type': 'odd_msgs/Odd', 'optional': True}, []),
    ({'service': 'horn', 'type': 'std_srvs/SetBool'}, []),
    ({'action': 'arm', 'type': 'x_msgs/Arm', 'on_stop': 'cancel'}, ['accessory_unheard']),
    ({'kind': 'readout', 'topic': 'gas'}, [])])
def test_an_accessory(row, found):
    world = World()
    add('/bot1/tools', subscribe=['/bot1/lamp'], host=BOT_IP)(world)
    add('/mhri_session', subscribe=['/bot1/recorded'])(world)
    world.kinds['/odd'] = 'odd_msgs/Odd'
    world.parameters['bot1']['mhri'] = {'accessories': {'tool': {
        'kind': 'tap', **({} if row.get('kind') else {'on_stop': 'stop'}), **row}}}
    assert [item.check for item in world.wrong()] == found


@pytest.mark.parametrize('host, topics, found', [
    (BOT_IP, [CAMERA], ['camera_raw']), (BOT_IP, [CAMERA, CAMERA + '/compressed'], []),
    (HOST_IP, [CAMERA], [])])
def test_a_camera_that_takes_the_radio_for_itself(host, topics, found):
    world = World()
    add('/bot1/camera', topics[:1], kind=IMAGE, host=host)(world)
    add('/bot1/camera', topics[1:], kind='sensor_msgs/CompressedImage', host=host)(world)
    assert [item.check for item in world.wrong()] == found


@pytest.mark.parametrize('frames, found', [
    ((('odom', 'base_link'), ('odom', 'base_link')), ['frames_same']),
    ((('bot1/odom', 'bot1/base'), ('bot2/odom', 'bot2/base')), []),
    ((('map', 'bot1/base'), ('map', 'bot2/base')), []), ((('odom', ''), ('x', '')), [])])
def test_two_robots_with_the_same_frames(frames, found):
    world = World()
    add('/bot2/base', ['/bot2/odom'], ['/bot2/cmd_vel'], kind=ODOMETRY, host=BOT_IP)(world)
    world.kinds['/bot2/cmd_vel'] = TWIST
    parameter(bot2={'robot_type': 'generic'})(world)
    for name, of in zip(('bot1', 'bot2'), frames):
        topic = '/{}/odom'.format(name)
        world.streams[topic] = Stream(topic, '/{}/base'.format(name), ODOMETRY, 'same',
                                      '/{}/base'.format(name), '', 0.6, 9, frames=of)
    assert [item.check for item in world.wrong()] == found
    world.requested = ('bot2',)
    assert [item.check for item in world.wrong()] == found


def test_what_nobody_had_time_to_listen_to_is_told():
    facts = replace(World().facts(), unheard=('/bot1/odom',))
    found = [item for item in diagnose(facts, TYPES, IGNORE) if item.severity != FINE]
    assert [item.check for item in found] == ['time_short'] and '/bot1/odom' in found[0].problem


def test_why_the_mux_does_not_start():
    world = World()
    without('/mux')(world)
    facts = replace(world.facts(), mux_error='mux.yaml: sources: is missing')
    found = [item for item in diagnose(facts, TYPES, IGNORE) if item.check == 'mux_config_bad']
    assert [item.severity for item in found] == [FAULT] and 'mux.yaml' in found[0].problem
    facts = replace(World().facts(), mux_error='mux.yaml: sources: is missing')
    assert [item.check for item in diagnose(facts, TYPES, IGNORE)
            if item.severity != FINE] == ['mux_config_bad']


def test_the_base_of_a_turtlebot2_is_left_alone():
    """Its smoother runs in the process of the base, and publishes a topic that takes commands."""
    world = World()
    world.parameters = {'bot1': {'robot_type': 'turtlebot2'}}
    topics = ['/bot1/teleop/input', '/bot1/cmd_vel_mux/input/teleop']
    base = '/bot1/mobile_base_nodelet_manager'
    add(base, topics[1:], topics, kind=TWIST, host=BOT_IP)(world)
    add('/mux', topics, kind=TWIST)(world)
    add(base, subscribe=['/bot1/' + row.name for row in TYPES['turtlebot2'].accessories],
        host=BOT_IP)(world)
    assert world.wrong() == []
    assert not any(base in item.remedy for item in diagnose(world.facts(), TYPES, IGNORE))


def guarded_turtlebot3():
    """Return a system whose robot's base listens to its guard alone, with navigation of its own."""
    world = World()
    topics = ['/bot1/cmd_vel', '/bot1/mhri_guard/velocity']
    world.parameters = {'bot1': {'robot_type': 'turtlebot3', 'robot_model': 'burger'}}
    world.subscribe.pop(topics[0])
    add('/bot1/base', (), topics[1:], kind=TWIST, host=BOT_IP)(world)
    add('/bot1/mhri_guard', topics[1:], topics, kind=TWIST, host=BOT_IP)(world)
    add('/mux', (), topics[:1], kind=TWIST)(world)
    add('/bot1/move_base', topics[:1], kind=TWIST, host=BOT_IP)(world)
    return world


def test_a_base_that_listens_to_its_guard_alone_is_right():
    world = guarded_turtlebot3()
    assert world.wrong() == []
    # Somebody else there is named, behind the guard and past it.
    for topic, said in (('/bot1/cmd_vel', 'its guard passes'),
                        ('/bot1/mhri_guard/velocity', 'past the mux')):
        world = guarded_turtlebot3()
        add('/rogue', [topic], kind=TWIST)(world)
        found = world.wrong()
        assert [item.check for item in found] == ['velocity_foreign'] and (
            topic in found[0].problem and said in found[0].problem)
    world = guarded_turtlebot3()
    for node in ('/bot1/mhri_guard', '/bot1/base'):
        without(node)(world)
    assert 'velocity_unheard' in [item.check for item in world.wrong()]


def test_what_heals_by_itself_is_not_told():
    """Only what is wrong in both looks counts: nodes come and go all the time."""
    for spoil in ('forgotten topic', 'same name twice', 'forgotten node', 'does not reach back',
                  'definitions differ', 'hidden velocity'):
        world = World()
        CASES[spoil][0][0](world)

        def heal(one):
            one.changed, one.extra, one.apart = {}, {}, set()
        world.again = heal
        assert world.wrong() == [], spoil


def test_nodes_that_look_odd_are_asked_again():
    for spoil, node in (('forgotten topic', '/bot1/base'), ('same name twice', '/mux'),
                        ('hidden velocity', '/bot1/base'), ('does not reach back', '/bot1/base')):
        world = World()
        CASES[spoil][0][0](world)
        facts = world.facts()
        assert node in odd_ones(facts, robots_of(facts.graph, TYPES, IGNORE)), spoil
    facts = World().facts()
    assert odd_ones(facts, robots_of(facts.graph, TYPES, IGNORE)) == set()


def test_only_the_robots_asked_for():
    world = World()
    add('/bot2/base', ['/bot2/odom'], kind=ODOMETRY, host=BOT_IP)(world)
    world.changed['/bot2/base'] = {'state': REFUSED}
    assert [item.about for item in world.wrong()] == ['bot2', 'bot2']
    world.requested = ('bot1',)
    assert world.wrong() == []
    world.requested = ('bot11',)
    assert [(item.check, item.about) for item in world.wrong()] == [('robot_absent', 'bot11')]


def test_nobody_listens_and_nobody_tells():
    world = World()
    world.subscribe.pop('/bot1/cmd_vel')
    assert [item.check for item in world.wrong()] == ['velocity_unheard']
    world = World()
    world.publish.pop('/bot1/odom')
    assert [item.check for item in world.wrong()] == ['odometry_missing']


def test_sensors_of_other_names():
    """The only one is used; of several, the line that uses one is the remedy."""
    world = World()
    world.publish['/bot1/wheels'] = world.publish.pop('/bot1/odom')
    world.kinds['/bot1/wheels'] = ODOMETRY
    assert world.wrong() == []
    found, = [item for item in diagnose(world.facts(), TYPES, IGNORE)
              if item.check == 'sensor_found']
    assert found.remedy == 'rosparam set /bot1/mhri/odometry "[wheels]"'
    world.publish['/bot1/filtered'], world.kinds['/bot1/filtered'] = ['/bot1/base'], ODOMETRY
    finding, = world.wrong()
    assert (finding.check, finding.remedy) == (
        'sensor_names', 'rosparam set /bot1/mhri/odometry "[filtered]"')


def test_publishers_disagree():
    world = World()
    add('/two', ['/bot1/odom'])(world)
    world.streams['second'] = Stream('/bot1/odom', '/two', ODOMETRY, 'x', '/two')
    assert 'publishers_differ' in [item.check for item in world.wrong()]


def test_a_robot_that_reaches_back_is_said_so():
    found = {item.check: item for item in diagnose(World().facts(), TYPES, IGNORE)}
    assert found['reaches_back'].severity == FINE and 'connections' in found['reaches_back'].problem
    world = World()
    without('/mux')(world)
    found = {item.check: item for item in diagnose(world.facts(), TYPES, IGNORE)}
    assert found['reaches_back'].confidence == 'unknown'


@pytest.mark.parametrize('ahead_s', [-100.0, -0.2, 0.0, 0.2, 1e6])
def test_clock_offset(ahead_s):
    offset_s, error_s = clock_offset(samples(ahead_s))
    assert abs(offset_s - ahead_s) <= 0.003
    assert 0.005 <= error_s < 0.01


@pytest.mark.parametrize('stamp_s', [0.5, 1234.5])
def test_simulated_time_is_not_called_a_clock_that_is_behind(stamp_s):
    """By 56 years, to the millisecond."""
    world = World()
    stream('/bot1/odom', samples=tuple(
        (1.76e9 + number, stamp_s + number) for number in range(20)))(world)
    finding, = world.wrong()
    assert (finding.check, finding.severity) == ('clock_offset', WARNING)
    assert 'behind' not in finding.problem


def test_few_stamps_prove_little():
    assert clock_offset(samples(0.0, 1))[1] == 0.1
    assert clock_offset(samples(0.0, 5))[1] < 0.1


@pytest.mark.parametrize('ahead_s, severity', [(0.3, WARNING), (-0.7, FAULT)])
def test_clock_severity(ahead_s, severity):
    world = World()
    stream('/bot1/odom', samples=samples(ahead_s))(world)
    finding, = world.wrong()
    assert finding.severity == severity and 'messages' in finding.confidence
    assert ('ahead of' if ahead_s > 0 else 'behind') in finding.problem


def test_report():
    world = World()
    answer(state=REFUSED)(world)
    findings = diagnose(world.facts(), TYPES, IGNORE)
    lines = as_lines(findings, 1.234)
    assert lines[0].startswith('[X] fault  bot1: ') and lines[1].startswith('      symptom:')
    assert lines[-1].startswith('1 faults, 0 warnings') and lines[-1].endswith('1.2 s')
    report = json.loads(json.dumps(as_dict(findings, 1.234)))
    assert (report['faults'], report['warnings'], report['took_s']) == (1, 0, 1.234)
    assert report['findings'][0]['check'] == 'node_dead'
    assert exit_status(findings) == 1
    assert exit_status(diagnose(World().facts(), TYPES, IGNORE)) == 0
