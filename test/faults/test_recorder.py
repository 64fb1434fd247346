# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Recordings that go wrong: killed, out of space, on a slow disk, without a master.

Every case is a real recording of a real publisher. A full disk is a tmpfs of a few MB, which needs
the right to mount.
"""
import os
import signal
import subprocess
import sys
import time

import pytest
import rosbag

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..'))

from support.recordings import numbers_in, record  # noqa: E402
from support.ros_system import wait_for  # noqa: E402

MB = 10 ** 6
RECORD = '''
import sys, time, rospy
from mhri.recording.ros.recorder import Recorder
rospy.init_node('killed', disable_signals=True)
recorder = Recorder('bot1', sys.argv[2:], sys.argv[1])
recorder.start()
while True:
    time.sleep(0.05)
    print(recorder.status().messages, flush=True)
'''
TERMINATED = '''
import signal, sys, threading, rospy
from mhri.recording.ros.recorder import Recorder
rospy.init_node('terminated', disable_signals=True)
recorder = Recorder('bot1', sys.argv[2:], sys.argv[1])
recorder.start()
ended = threading.Event()
signal.signal(signal.SIGTERM, lambda *_: ended.set())
ended.wait()
recorder.stop(wait=True)
'''


@pytest.mark.parametrize('rate_hz, number', [(200, signal.SIGKILL), (10, signal.SIGKILL)])
def test_killed_while_recording(system, tmp_path, rate_hz, number):
    path = str(tmp_path / 'killed.bag')
    topic = '/bot1/imu{}'.format(rate_hz)
    process = system.start(sys.executable, '-c', RECORD, path, topic)
    imus = system.start(sys.executable, os.path.join(
        os.path.dirname(__file__), '..', 'support', 'imu_sender.py'), '60', str(rate_hz), topic)
    wait_for(lambda: last_number(process.log) >= 3.3 * rate_hz, 30, 'some seconds of messages')
    killed_at = time.time()
    system.kill(process, number, family=False)
    system.kill(imus)
    assert os.listdir(str(tmp_path)) == ['killed.bag.active']
    received = last_number(process.log)
    done = subprocess.run(['rosbag', 'reindex', path + '.active'], stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT)
    assert done.returncode == 0, done.stdout.decode()
    with rosbag.Bag(path + '.active') as bag:
        found = [(when.to_sec(), message.angular_velocity.z)
                 for _, message, when in bag.read_messages()]
    assert [value for _, value in found] == list(range(len(found)))
    missing_s = killed_at - found[-1][0]
    print('MEASURED SIGKILL while recording {} Hz: the last message saved is {:.2f} s old, {} of '
          '{} messages saved'.format(rate_hz, missing_s, len(found), received))
    assert missing_s <= 1.0 + 1.0 / rate_hz
    assert received - len(found) <= rate_hz


def last_number(path):
    with open(path) as stream:
        lines = [line for line in stream.read().splitlines() if line.isdigit()]
    return int(lines[-1]) if lines else 0


def test_terminated_while_recording(system, sender, tmp_path):
    path = str(tmp_path / 'ended.bag')
    process = system.start(sys.executable, '-c', TERMINATED, path, '/bot1/text')
    active = path + '.active'
    wait_for(lambda: os.path.exists(active) and os.path.getsize(active) > 5000, 20,
             'the first messages')
    process.send_signal(signal.SIGTERM)
    assert process.wait(10) == 0
    assert os.listdir(str(tmp_path)) == ['ended.bag'] and numbers_in(path)


def test_a_full_disk_at_the_start(system, sender, disk):
    status = record(disk(8) + '/a', until=lambda status: status.state == 'failed')
    assert 'the disk is full' in status.note and status.attention
    assert os.path.getsize(status.path) < 20000


def test_stopped_before_the_disk_is_full(system, sender, disk):
    from mhri.recording.recording import RecordingLimits
    folder, notes = disk(12), set()
    limits = RecordingLimits(warn_free_bytes=11 * MB, stop_free_bytes=4 * MB)

    def ended(status):
        notes.add(status.note.split(':')[0])
        return status.state == 'failed'
    status = record(folder + '/a.bag', limits=limits, until=ended)
    assert 'the disk is nearly full' in notes
    assert 'recording stopped, the disk is full' in status.note, status
    left = os.statvfs(folder)
    assert left.f_bavail * left.f_frsize > 2 * MB
    assert len(numbers_in(folder + '/a.bag')) == status.messages, 'everything received is in it'
    assert os.listdir(folder) == ['a.bag']


@pytest.mark.parametrize('filled_by', ['this recording', 'another program'])
def test_no_space_left(system, sender, disk, filled_by):
    """ENOSPC itself, in the middle of a chunk; then the file is closed whole all the same."""
    from mhri.recording.recording import RecordingLimits
    folder, limits = disk(3), RecordingLimits(warn_free_bytes=0, stop_free_bytes=0)

    def ended(status):
        if filled_by == 'another program' and 100 < status.messages:
            with open(folder + '/other', 'ab', buffering=0) as stream:
                fill(stream)
        return status.state == 'failed'
    status = record(folder + '/a.bag', limits=limits, until=ended)
    assert 'recording stopped, the disk is full; saved' in status.note, status
    found = numbers_in(folder + '/a.bag')
    print('MEASURED disk filled by {}: {} of {} messages in the bag'.format(
        filled_by, len(found), status.messages))
    assert len(found) >= 40
    assert 'saved {} messages'.format(len(found)) in status.note
    for tool in ('info', 'check'):
        assert subprocess.run(['rosbag', tool, folder + '/a.bag'],
                              stdout=subprocess.DEVNULL).returncode == 0
    assert not os.path.exists(folder + '/a.bag.active')


def fill(stream):
    for size in (65536, 4096, 1):
        try:
            while stream.write(b'x' * size) == size:
                pass
        except OSError:
            pass


def test_the_folder_is_removed_while_recording(system, sender, tmp_path):
    import shutil
    folder = str(tmp_path / 'gone')
    gone = []

    def removed(status):
        if status.messages > 5 and not gone:
            gone.append(shutil.rmtree(folder))
        return gone
    status = record(folder + '/run', until=removed)
    assert status.state == 'failed' and status.note, status


def test_a_slow_disk_is_told_and_loses_nothing(system, sender, tmp_path, monkeypatch):
    """The disk holds each write up for a while: what waits in memory is said, and written."""
    from mhri.recording.recording import RecordingLimits
    from mhri.recording.ros.bag_file import BagFile
    real = BagFile.write
    notes = set()

    def slow(self, messages):
        time.sleep(0.3)
        real(self, messages)
    monkeypatch.setattr(BagFile, 'write', slow)

    def seen(status):
        notes.add(status.note.split(':')[0])
        return status.messages > 60
    limits = RecordingLimits(chunk_bytes=50000, warn_queue_bytes=200000)
    status = record(str(tmp_path / 'slow'), limits=limits, until=seen)
    assert 'the disk is slow' in notes
    assert status.state == 'ended' and len(numbers_in(status.path)) == status.messages


def test_a_disk_that_stands_still_ends_the_recording(system, sender, tmp_path, monkeypatch):
    """Memory is not endless: the recording ends, and what was received is written."""
    from mhri.recording.recording import RecordingLimits
    from mhri.recording.ros.bag_file import BagFile
    real = BagFile.write

    def slow(self, messages):
        time.sleep(0.4)
        real(self, messages)
    monkeypatch.setattr(BagFile, 'write', slow)
    limits = RecordingLimits(chunk_bytes=50000, warn_queue_bytes=100000, stop_queue_bytes=250000)
    status = record(str(tmp_path / 'still'), limits=limits,
                    until=lambda status: status.state == 'failed')
    assert 'the disk is too slow' in status.note
    assert len(numbers_in(status.path)) == status.messages


def test_the_master_is_restarted(system, tmp_path):
    """What is connected goes on; what comes up at the new master is recorded as well.

    The last test of all: the publishers of the others are not known to the new master.
    """
    import rospy
    from mhri.recording.ros.recorder import Recorder
    from std_msgs.msg import String
    publisher = rospy.Publisher('/bot2/text', String, queue_size=10)
    recorder = Recorder('bot2', ['/bot2/text', '/bot2/imu'], str(tmp_path / 'm'))
    recorder.start()
    wait_for(publisher.get_num_connections, 10, 'the recorder')
    system.kill(system.master)
    system.start_master()
    publisher.publish('still here')
    wait_for(lambda: recorder.status().messages == 1, 10, 'the old connection')
    imus = system.start(sys.executable, os.path.join(
        os.path.dirname(__file__), '..', 'support', 'imu_sender.py'), '0.5', '20', '/bot2/imu')
    wait_for(lambda: recorder.status().messages == 11, 20, 'the new one')
    assert recorder.stop(wait=True)
    imus.wait(20)
    publisher.unregister()
