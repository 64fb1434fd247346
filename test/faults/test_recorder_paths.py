# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Recordings asked for where no file can be, where one is, and where all is well.

Every case is a real recording of a real publisher. "Unwritable" is a disk mounted read-only (root
may write everywhere else), which needs the right to mount.
"""
import glob
import os
import sys

import pytest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..'))

from support.recordings import numbers_in, record  # noqa: E402
from support.ros_system import wait_for  # noqa: E402


def default_is_used(system, status, text):
    """The bag is in $ROS_HOME under its default name, and the note says what was asked for."""
    assert os.path.dirname(status.path) == system.home, status
    assert os.path.basename(status.path).startswith('bot1_20')
    assert status.note.startswith('cannot write to "' + text[:20]), status
    assert 'saving to {} instead'.format(status.path) in status.note
    assert numbers_in(status.path)


def test_a_read_only_disk(system, sender, disk):
    folder = disk(4, 'ro')
    status = record(folder + '/a.bag')
    default_is_used(system, status, folder)
    assert 'read-only' in status.note


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
        text, said = cases[what]
        status = recorder.status()
        print('{}: {}'.format(what, status.note[:300]))
        default_is_used(system, status, text.replace('\0', '?').replace('\ud800', '?'))
        assert said in status.note, what
    assert len({recorder.status().path for recorder in recorders.values()}) == len(cases)
    assert sorted(os.listdir(str(tmp_path))) == before, 'nothing was made or removed'
    assert (tmp_path / 'file').read_text() == 'mine'


@pytest.mark.parametrize('text, wanted', [
    ('', '{home}/bot1_20*.bag'),
    ('{folder}', '{folder}/bot1_20*.bag'),
    ('{folder}/new/deep/', '{folder}/new/deep/bot1_20*.bag'),
    ('{folder}/new/run 1', '{folder}/new/run 1.bag'),
    ('{folder}/run.bag', '{folder}/run.bag'),
    ('$MHRI_LAB/run', '{folder}/run.bag'),
    ('~/run', '{folder}/run.bag'),
    ('run', '{home}/run.bag'),
    ('{folder}/\u00e9\u4e2d\U0001f916 ;"\'*?\n-rf',
     '{folder}/\u00e9\u4e2d\U0001f916 ;"\'[*][?]\n-rf.bag'),
])
def test_paths_that_are_taken(system, sender, tmp_path, monkeypatch, text, wanted):
    monkeypatch.setenv('MHRI_LAB', str(tmp_path))
    monkeypatch.setenv('HOME', str(tmp_path))
    place = {'folder': str(tmp_path), 'home': system.home}
    status = record(text.format(**place), messages=5)
    assert status.path in glob.glob(wanted.format(**place)), status
    assert numbers_in(status.path) and status.state == 'ended'
    # Where an earlier test has taken the default names of this second, the note says that first.
    assert 'saved ' in status.note and 'instead' not in status.note, status


def test_existing_files_are_kept(system, sender, tmp_path):
    path = str(tmp_path / 'run.bag')
    (tmp_path / 'run.bag').write_text('mine')
    (tmp_path / 'run-1.bag.active').write_text('left by a kill')
    os.symlink('nowhere', str(tmp_path / 'run-2.bag'))
    paths = [record(path, messages=3) for _ in range(2)]
    assert [os.path.basename(status.path) for status in paths] == ['run-3.bag', 'run-4.bag']
    assert 'run.bag exists already; saving to run-3.bag' in paths[0].note
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
    status = record('', until=lambda status: status.state == 'failed')
    assert status.note.startswith('cannot write to ' + os.environ['ROS_HOME'])
    assert 'read-only' in status.note and status.path == ''
