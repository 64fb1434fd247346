# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A session on a disk that is full, and on one that is read-only; killed, and others around it.

The session's recorder is a program of its own; an input of a lab's own is what it records.
"""
import os
import random
import subprocess
import sys
import threading
import time
import xmlrpc.client

import pytest
import rosbag

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..'))

from mhri.recording.folder import bags_of, read_events  # noqa: E402
from support.ros_system import wait_for  # noqa: E402

TOPIC = '/mux_in/lab'
PATIENCE_S = 60.0
KILLS = 3
# Whom a session hears: executable, its name on the graph, and what it says again and again.
OTHERS = (('mux', 'mux', '/mux/mode'), ('gates', 'gates', '/gates/state'),
          ('tasks', 'mhri_tasks', '/mhri_tasks/list'))


class Recorder:
    """The program, and what it says."""

    def __init__(self, system):
        import rospy
        from mhri.msg import SessionState
        self.system = system
        self.state = SessionState()
        self.process = None
        rospy.Subscriber('/mhri_session/state', SessionState, self._hear)

    def _hear(self, message):
        self.state = message

    def start(self, *parameters):
        import rospy
        self.process = self.system.node('mhri_session', '_warn_free_mb:=0', '_stop_free_mb:=0',
                                        *parameters)
        rospy.wait_for_service('/mhri_session/record', PATIENCE_S)

    def record(self, on=True):
        import rospy
        from std_srvs.srv import SetBool
        return rospy.ServiceProxy('/mhri_session/record', SetBool)(on)

    def end(self):
        self.system.kill(self.process, 15)


class Lab:
    """Sends numbers with some ballast."""

    def __init__(self):
        import rospy
        from std_msgs.msg import String
        self._publisher = rospy.Publisher(TOPIC, String, queue_size=1000)
        self.sent = {}
        self.kilobytes = 1
        threading.Thread(target=self._run, daemon=True).start()

    def _run(self):
        for number in range(10 ** 9):
            self._publisher.publish('{} {}'.format(number, 'x' * 1000 * self.kilobytes))
            self.sent[number] = time.time()
            time.sleep(0.02)

    def heard(self):
        return self._publisher.get_num_connections() > 0


class Ear:
    """Hears a topic, whoever says it."""

    def __init__(self, topic):
        import rospy
        self.heard_s = 0.0
        rospy.Subscriber(topic, rospy.AnyMsg, self._hear)

    def _hear(self, _):
        self.heard_s = self.heard_s or time.time()

    def forget(self):
        self.heard_s = 0.0

    def wait(self):
        wait_for(lambda: self.heard_s, PATIENCE_S, 'somebody to say something')


@pytest.fixture(scope='module')
def lab(system):
    return Lab()


@pytest.fixture
def recorder(system, lab):
    recorder = Recorder(system)
    yield recorder
    recorder.end()


def numbers_of(path):
    with rosbag.Bag(path) as bag:
        return [int(message.data.split()[0]) for _, message, _ in bag.read_messages([TOPIC])]


def events_of(folder):
    with open(os.path.join(folder, 'events.jsonl'), encoding='utf-8') as file:
        return read_events(file.read())


def test_a_full_disk_ends_it_whole_and_says_so(recorder, lab, disk):
    recorder.start('_folder:=' + disk(6))
    wait_for(lab.heard, PATIENCE_S, 'the recorder to listen')
    assert recorder.record().success
    wait_for(lambda: recorder.state.recording, PATIENCE_S, 'the state')
    lab.kilobytes = 200
    try:
        wait_for(lambda: recorder.state.problem and not recorder.state.recording, PATIENCE_S,
                 'the end')
    finally:
        lab.kilobytes = 1
    assert 'full' in recorder.state.problem, recorder.state
    folder = recorder.state.folder
    bag, = bags_of(os.listdir(folder))
    numbers = numbers_of(os.path.join(folder, bag))
    assert bag == '0000.bag' and numbers == list(range(numbers[0], numbers[0] + len(numbers)))


def test_a_read_only_disk_is_said_and_another_one_taken(recorder, system, disk):
    folder = disk(4, 'ro')
    recorder.start('_folder:=' + folder)
    assert recorder.record().success
    wait_for(lambda: recorder.state.recording, PATIENCE_S, 'the state')
    assert recorder.state.folder.startswith(system.home)
    assert 'read-only' in recorder.state.problem and folder in recorder.state.problem
    assert any('read-only' in event.text for event in events_of(recorder.state.folder))
    assert recorder.record(False).success


def test_killed_at_any_time_it_loses_little(recorder, lab, tmp_path):
    """Of what was sent until the kill, all but the end is there, and the next one goes on."""
    lost = []
    for kill in range(KILLS):
        recorder.start('_folder:=' + str(tmp_path))
        wait_for(lab.heard, PATIENCE_S, 'the recorder to listen')
        if not kill:
            assert recorder.record().success
        wait_for(lambda: recorder.state.recording, PATIENCE_S, 'the state')
        before = recorder.state.messages
        wait_for(lambda: recorder.state.messages > before + 20 + 7 * kill, PATIENCE_S, 'messages')
        recorder.system.kill(recorder.process)
        killed = time.time()
        folder = recorder.state.folder
        path = os.path.join(folder, '{:04d}.bag.active'.format(kill))
        subprocess.run(['rosbag', 'reindex', path], check=True, timeout=120,
                       stdout=subprocess.DEVNULL)
        numbers = numbers_of(path)
        assert numbers == list(range(numbers[0], numbers[0] + len(numbers)))
        last = max(number for number, at in list(lab.sent.items()) if at < killed)
        lost.append(lab.sent[last] - lab.sent[numbers[-1]])
        recorder.state.recording = False
    print('MEASURED lost by each of {} kills: {}'.format(
        KILLS, ', '.join('{:.2f} s'.format(seconds) for seconds in lost)))
    assert max(lost) < 3.0
    kinds = [event.kind for event in events_of(folder)]
    assert kinds.count('start') == 1 and len(os.listdir(str(tmp_path))) == 1
    recorder.start('_folder:=' + str(tmp_path))
    wait_for(lambda: recorder.state.recording, PATIENCE_S, 'it goes on')
    assert recorder.record(False).success


def times_of(folder, topic):
    """Return when messages of a topic were received [s since 1970]."""
    found = []
    for name in bags_of(os.listdir(folder)):
        with rosbag.Bag(os.path.join(folder, name)) as bag:
            found += [when.to_sec() for _, _, when in bag.read_messages([topic], raw=True)]
    return found


def records(node, topic):
    """Tell whether a node has the recorder among those who hear a topic of it."""
    import rosgraph
    try:
        rows = xmlrpc.client.ServerProxy(
            rosgraph.Master('/test').lookupNode(node)).getBusInfo('/test')[2]
    except (OSError, rosgraph.MasterException, xmlrpc.client.Error):
        return False
    return any(row[4] == topic and 'mhri_session' in row[1] and row[2] == 'o' for row in rows)


def test_whoever_is_killed_it_goes_on_and_hears_who_comes_back(recorder, lab, system, tmp_path):
    """Mux, gates, tasks and the master, each at a random time: only their own silence is lost."""
    recorder.start('_folder:=' + str(tmp_path))
    wait_for(lab.heard, PATIENCE_S, 'the recorder to listen')
    assert recorder.record().success
    wait_for(lambda: recorder.state.recording, PATIENCE_S, 'the state')
    folder = recorder.state.folder
    chance = random.Random(14)
    # The master last: those who listen here would not be known to the next one.
    kills = [*chance.sample(OTHERS, len(OTHERS)), None]
    ears = {topic: Ear(topic) for _, _, topic in OTHERS}
    running = {topic: system.node(name, '__name:=' + node) for name, node, topic in OTHERS}
    gone = []

    def bring(node, topic):
        """Wait until it is heard here and by the recorder, and for some time after."""
        ears[topic].wait()
        wait_for(lambda: records(node, topic), PATIENCE_S, 'the recorder to hear ' + topic)
        passed(chance.randint(20, 60))

    def passed(messages):
        before = recorder.state.messages
        wait_for(lambda: recorder.state.messages > before + messages, PATIENCE_S, 'messages')
    for _, node, topic in OTHERS:
        bring(node, topic)
    for other in kills:
        killed = time.time()
        if other is None:
            system.kill(system.master)
            system.start_master()
            passed(20)
            continue
        name, node, topic = other
        system.kill(running[topic])
        ears[topic].forget()
        running[topic] = system.node(name, '__name:=' + node)
        bring(node, topic)
        gone.append((name, topic, killed, ears[topic].heard_s))
    recorder.end()
    for name, topic, killed, back in gone:
        times = times_of(folder, topic)
        last = max(when for when in times if when < killed)
        first = min(when for when in times if when > killed)
        print('MEASURED {} killed: back after {:.2f} s, recorded again after {:.2f} s, silent for '
              '{:.2f} s'.format(name, back - killed, first - killed, first - last))
    numbers = [number for name in sorted(bags_of(os.listdir(folder)))
               for number in numbers_of(os.path.join(folder, name))]
    print('MEASURED lost of what others said meanwhile: {} of {}'.format(
        numbers[-1] - numbers[0] + 1 - len(numbers), len(numbers)))
    assert numbers == list(range(numbers[0], numbers[0] + len(numbers)))
