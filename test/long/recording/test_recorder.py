# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Recordings that go wrong: out of space, on a slow disk, where no file can be.

Every case is a real recording of a real publisher. A full disk is a tmpfs of a few MB, which needs
the right to mount; so does one that is read-only (root may write everywhere else).
"""
import glob
import os
import subprocess
import sys
import time

import pytest

from mhri.recording.recording import ENDED, FAILED, RECORDING, RecordingLimits
from support.own_node import own_node
from support.paths import SUPPORT
from support.recordings import numbers_in, record
from support.ros_system import wait_for

system = own_node('recorder_faults')

MB = 10 ** 6


def test_a_full_disk_at_the_start(system, sender, disk):
    status = record(disk(8) + '/a', until=lambda status: status.state == FAILED)
    assert status.note and status.attention
    assert os.path.getsize(status.path) < 20000


def test_stopped_before_the_disk_is_full(system, sender, disk):
    folder, warned = disk(12), []
    limits = RecordingLimits(warn_free_bytes=11 * MB, stop_free_bytes=4 * MB)

    def ended(status):
        warned.extend([status] * (status.state == RECORDING and status.attention))
        return status.state == FAILED
    status = record(folder + '/a.bag', limits=limits, until=ended)
    assert warned and status.note, status
    left = os.statvfs(folder)
    assert left.f_bavail * left.f_frsize > 2 * MB
    assert len(numbers_in(folder + '/a.bag')) == status.messages, 'everything received is in it'
    assert os.listdir(folder) == ['a.bag']


def test_no_space_left(system, sender, disk):
    """ENOSPC itself, in the middle of a chunk; then the file is closed whole all the same."""
    folder, limits = disk(3), RecordingLimits(warn_free_bytes=0, stop_free_bytes=0)

    def ended(status):
        if 100 < status.messages:
            with open(folder + '/other', 'ab', buffering=0) as stream:
                fill(stream)
        return status.state == FAILED
    status = record(folder + '/a.bag', limits=limits, until=ended)
    found = numbers_in(folder + '/a.bag')
    assert len(found) >= 40 and str(len(found)) in status.note, status
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
    assert status.state == FAILED and status.note, status


@pytest.mark.parametrize('stop_queue_bytes, state', [(10 * MB, ENDED), (250000, FAILED)])
def test_a_slow_disk_is_told_and_loses_nothing(system, sender, tmp_path, monkeypatch,
                                               stop_queue_bytes, state):
    """The disk holds up each write; memory is not endless, and the recording ends before."""
    from mhri.recording.ros.bag_file import BagFile
    real, warned = BagFile.write, []

    def slow(self, messages):
        time.sleep(0.4)
        real(self, messages)
    monkeypatch.setattr(BagFile, 'write', slow)

    def seen(status):
        warned.extend([status] * status.attention)
        return status.state == FAILED or state == ENDED and status.messages > 60
    limits = RecordingLimits(chunk_bytes=50000, warn_queue_bytes=100000,
                             stop_queue_bytes=stop_queue_bytes)
    status = record(str(tmp_path / 'slow'), limits=limits, until=seen)
    assert warned and status.state == state, status
    assert len(numbers_in(status.path)) == status.messages


def default_is_used(system, status):
    """The bag is in $ROS_HOME under its default name."""
    assert os.path.dirname(status.path) == system.home, status
    assert os.path.basename(status.path).startswith('bot1_20')
    assert numbers_in(status.path)


def make_hostile(folder):
    """Make one of everything that is no place for a bag; return {what: (path, words)}."""
    os.mkfifo(folder + '/fifo.bag')
    os.mkdir(folder + '/folder.bag')
    os.symlink(folder + '/loop.bag', folder + '/loop.bag')
    os.symlink('round', folder + '/round')
    os.symlink('/dev/null', folder + '/null.bag')
    os.symlink('/proc/self', folder + '/self')
    with open(folder + '/file', 'w') as stream:
        stream.write('mine')
    return {
        'fifo': (folder + '/fifo', 'is not a file'),
        'folder': (folder + '/folder.bag', 'is a folder'),
        'a link to itself': (folder + '/loop.bag', 'links lead in a circle'),
        'through a link to itself': (folder + '/round/x', ''),
        'a link to a device': (folder + '/null', 'is not a file'),
        'a link into /proc': (folder + '/self/x', '/proc belongs to the system'),
        'device': ('/dev/null', '/dev belongs to the system'),
        'below a device': ('/dev/null/x', ''),
        'shared memory': ('/dev/shm/x', '/dev belongs to the system'),
        'proc': ('/proc/sys/kernel/x', '/proc belongs to the system'),
        'sys': ('/sys/x.bag', '/sys belongs to the system'),
        'below a file': (folder + '/file/x', 'a part of it is a file'),
        'long name': (folder + '/' + 'n' * 300, 'the name is too long'),
        'long name with its ending': (folder + '/' + 'n' * 250, 'the name is too long'),
        'long path': (folder + '/n' * 3000, 'the name is too long'),
        'deep path': (folder + '/n' * 1500, 'nested too deeply'),
        'nul': (folder + '/a\0b', 'a character that no name can have'),
        'half a character': (folder + '/\ud800', 'a character that no name can have'),
        'a variable that is not set': ('$MHRI_NOT_SET/x', '$MHRI_NOT_SET is not set'),
        'somebody': ('~nobody/x', '~name is not known'),
    }


def test_hostile_paths(system, sender, tmp_path):
    """All of them at once, each a recording of its own; the default names get numbers."""
    from mhri.recording.ros.recorder import Recorder
    cases = make_hostile(str(tmp_path))
    before = sorted(os.listdir(str(tmp_path)))
    recorders = {what: Recorder('bot1', ['/bot1/text'], text) for what, (text, _) in cases.items()}
    for recorder in recorders.values():
        recorder.start()
    wait_for(lambda: all(recorder.status().messages > 5 for recorder in recorders.values()), 30,
             'all to record')
    for what, recorder in recorders.items():
        assert recorder.stop(wait=True), what
        status = recorder.status()
        default_is_used(system, status)
        assert cases[what][1] in status.elsewhere, (what, status.elsewhere[:300])
    assert len({recorder.status().path for recorder in recorders.values()}) == len(cases)
    assert sorted(os.listdir(str(tmp_path))) == before, 'nothing was made or removed'
    assert (tmp_path / 'file').read_text() == 'mine'


@pytest.mark.parametrize('text, wanted', [
    ('', '{home}/bot1_20*.bag'),
    ('{folder}/new/run 1', '{folder}/new/run 1.bag'),
    ('{folder}/\u00e9\u4e2d\U0001f916 ;"\'*?\n-rf',
     '{folder}/\u00e9\u4e2d\U0001f916 ;"\'[*][?]\n-rf.bag'),
])
def test_paths_that_are_taken(system, sender, tmp_path, text, wanted):
    place = {'folder': str(tmp_path), 'home': system.home}
    status = record(text.format(**place), messages=5)
    assert status.path in glob.glob(wanted.format(**place)), status
    assert numbers_in(status.path) and status.state == ENDED
    assert status.note and not status.elsewhere, status


def test_existing_files_are_kept(system, sender, tmp_path):
    path = str(tmp_path / 'run.bag')
    (tmp_path / 'run.bag').write_text('mine')
    (tmp_path / 'run-1.bag.active').write_text('left by a kill')
    os.symlink('nowhere', str(tmp_path / 'run-2.bag'))
    paths = [record(path, messages=3) for _ in range(2)]
    assert [os.path.basename(status.path) for status in paths] == ['run-3.bag', 'run-4.bag']
    assert 'run-3.bag' in paths[0].note
    assert (tmp_path / 'run.bag').read_text() == 'mine'
    assert (tmp_path / 'run-1.bag.active').read_text() == 'left by a kill'
    assert os.readlink(str(tmp_path / 'run-2.bag')) == 'nowhere'


def test_a_file_that_comes_up_meanwhile_is_kept(system, sender, tmp_path):
    from mhri.recording.ros.recorder import Recorder
    recorder = Recorder('bot1', ['/bot1/text'], str(tmp_path / 'run'))
    recorder.start()
    wait_for(lambda: recorder.status().messages > 3, 10, 'the recording')
    (tmp_path / 'run.bag').write_text('theirs')
    assert recorder.stop(wait=True)
    assert (tmp_path / 'run.bag').read_text() == 'theirs'
    assert recorder.status().path == str(tmp_path / 'run-1.bag')
    assert numbers_in(recorder.status().path)


def test_not_even_the_default(system, sender, disk, monkeypatch):
    monkeypatch.setenv('ROS_HOME', disk(4, 'ro'))
    status = record('', until=lambda status: status.state == FAILED)
    assert os.environ['ROS_HOME'] in status.note and status.path == ''


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
    imus = system.start(sys.executable, str(SUPPORT / 'imu_sender.py'), '0.5', '20', '/bot2/imu')
    wait_for(lambda: recorder.status().messages == 11, 20, 'the new one')
    assert recorder.stop(wait=True)
    imus.wait(20)
    publisher.unregister()
