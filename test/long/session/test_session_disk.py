# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A session on a disk that is full, and on one that is read-only; and killed.

The session's recorder is a program of its own; an input of a lab's own is what it records.
"""
import os
import subprocess
import threading
import time

import pytest
import rosbag

from mhri.recording.folder import bags_of, read_events
from support.own_node import own_node
from support.ros_system import wait_for

system = own_node('session_disk')

TOPIC = '/mux_in/lab'
TIMEOUT_S = 60.0
KILLS = 2


class Recorder:
    """The program, and what it says."""

    def __init__(self, system):
        import rospy
        from mhri.msg import SessionState
        self.system = system
        self.state = SessionState()
        self.process = None
        self._subscriber = rospy.Subscriber('/mhri_session/state', SessionState, self._on_state)

    def _on_state(self, message):
        self.state = message

    def start(self, *parameters):
        import rospy
        self.process = self.system.node('mhri_session', '_warn_free_mb:=0', '_stop_free_mb:=0',
                                        *parameters)
        rospy.wait_for_service('/mhri_session/record', TIMEOUT_S)

    def record(self, on=True):
        import rospy
        from std_srvs.srv import SetBool
        return rospy.ServiceProxy('/mhri_session/record', SetBool)(on)

    def end(self):
        """End it for good: the next one continues no recording of this one."""
        import rospy
        from mhri.session.ros.session import RECORDING
        if self.process is not None:
            self.system.kill(self.process, 15)
        self._subscriber.unregister()
        rospy.set_param(RECORDING, '')


class Lab:
    """Sends numbers with some ballast."""

    def __init__(self):
        import rospy
        from std_msgs.msg import String
        self._publisher = rospy.Publisher(TOPIC, String, queue_size=1000)
        #: When each number was sent, in order [s since 1970]; the thread appends to it.
        self.sent_s = []
        self.kilobytes = 1
        threading.Thread(target=self._run, daemon=True).start()

    def _run(self):
        for number in range(10 ** 9):
            self._publisher.publish('{} {}'.format(number, 'x' * 1000 * self.kilobytes))
            self.sent_s.append(time.time())
            time.sleep(0.02)

    def last_before(self, when):
        """Return when the last number before a time was sent [s since 1970]."""
        return max(at for at in self.sent_s[:] if at < when)

    def heard(self):
        return self._publisher.get_num_connections() > 0


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
    wait_for(lab.heard, TIMEOUT_S, 'the recorder to listen')
    assert recorder.record().success
    wait_for(lambda: recorder.state.recording, TIMEOUT_S, 'the state')
    lab.kilobytes = 200
    try:
        wait_for(lambda: recorder.state.problem and not recorder.state.recording, TIMEOUT_S,
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
    wait_for(lambda: recorder.state.recording, TIMEOUT_S, 'the state')
    assert recorder.state.folder.startswith(system.home)
    assert 'read-only' in recorder.state.problem and folder in recorder.state.problem
    assert any('read-only' in event.text for event in events_of(recorder.state.folder))
    assert recorder.record(False).success


def test_killed_at_any_time_it_loses_little(recorder, lab, tmp_path):
    """Of what was sent until the kill, all but the end is there, and the next one goes on."""
    lost = []
    for kill in range(KILLS):
        recorder.start('_folder:=' + str(tmp_path))
        wait_for(lab.heard, TIMEOUT_S, 'the recorder to listen')
        if not kill:
            assert recorder.record().success
        wait_for(lambda: recorder.state.recording, TIMEOUT_S, 'the state')
        before = recorder.state.messages
        wait_for(lambda: recorder.state.messages > before + 20 + 7 * kill, TIMEOUT_S, 'messages')
        recorder.system.kill(recorder.process)
        killed = time.time()
        folder = recorder.state.folder
        path = os.path.join(folder, '{:04d}.bag.active'.format(kill))
        subprocess.run(['rosbag', 'reindex', path], check=True, timeout=120,
                       stdout=subprocess.DEVNULL)
        numbers = numbers_of(path)
        assert numbers == list(range(numbers[0], numbers[0] + len(numbers)))
        lost.append(lab.last_before(killed) - lab.sent_s[numbers[-1]])
        recorder.state.recording = False
    print('MEASURED lost by each of {} kills: {}'.format(
        KILLS, ', '.join('{:.2f} s'.format(seconds) for seconds in lost)))
    assert max(lost) < 3.0
    kinds = [event.kind for event in events_of(folder)]
    assert kinds.count('start') == 1 and len(os.listdir(str(tmp_path))) == 1
    recorder.start('_folder:=' + str(tmp_path))
    wait_for(lambda: recorder.state.recording, TIMEOUT_S, 'it goes on')
    assert recorder.record(False).success
