# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The journal is written beside the driving; where it cannot be, it ends and the drive goes on."""
import os
import resource
import threading
import time

import pytest
import rospy

from mhri.base.limits import Velocity, ZERO
from mhri.base.robot_types import Limits
from mhri.devices.profile import Stick
from mhri.driving.io.journal_file import main, replay_file
from mhri.driving.journal import replay
from mhri.driving.operator_lease import Caller
from mhri.driving.ros import journal_writer as module
from mhri.driving.sources import MuxConfig, Source
from mhri.robots.ros.convert import packed_guard_zero, packed_twist
from support.ros_system import wait_for

CONFIG = MuxConfig((Source('joy', 'joy', '/joy', None),), 'joy', 0.5, 1.0)


class Publisher:
    """Takes what is sent to a topic."""

    def __init__(self, name, fails=False):
        self.resolved_name, self.sent, self._fails = name, [], fails

    def publish_packed(self, data, urgent=False):
        if self._fails:
            raise rospy.ROSException('unregistered')
        self.sent.append((data, urgent))


@pytest.fixture(name='said', autouse=True)
def _said(monkeypatch):
    """Return what was logged; that asks for no time here."""
    found = []
    monkeypatch.setattr(rospy, 'logerr', lambda *words: found.append(words))
    return found


def driven(writer, run='run'):
    """Return a drive that has set a robot in motion, and the publishers of what it is told."""
    drive = writer.drive(run, CONFIG, 0.0)
    topics = [Publisher('/bot1/mhri_guard/command'), Publisher('/bot1/cmd_vel')]
    writer.watch('bot1', topics)
    drive.open('bot1', Limits(0.4, 1.0), 0.1)
    drive.on_wish(Caller('/panel'), ('bot1',), (), '', 0.2)
    for stick in (Stick(0.0, 0.0, True), Stick(1.0, 0.2, False)):
        push(drive, stick, topics[1:])
    return drive, topics


def push(drive, stick, topics):
    """Push the stick, and publish what the drive orders."""
    orders, _ = drive.on_source('joy', '/panel', None, lambda _: stick, 0.3)
    for _, velocity in orders:
        for topic in topics:
            topic.publish_packed(packed_twist(*velocity), urgent=velocity.is_zero())
    return orders


def test_what_happens_and_what_leaves_is_in_the_file_in_its_order(tmp_path, said):
    path = str(tmp_path / 'a.journal')
    for run in ('one', 'two'):
        writer = module.JournalWriter(path)
        drive, topics = driven(writer, run)
        drive.on_stop(0.4)
        for topic, data in zip(topics, (packed_guard_zero('session:1'), packed_twist(0.0, 0.0))):
            topic.publish_packed(data, urgent=True)
            assert topic.sent[-1] == (data, True)
        drive.tick(0.41)
        writer.stop()
        with open(path, 'a') as file:
            file.write('["one","ti')
    assert replay_file(path)[:4] == (2, 12, 8, '') and not said and main(['', path]) == 0
    # It is closed; the drive is not.
    assert dict(drive.on_stop(0.5)) == {'bot1': ZERO}


def test_a_velocity_that_was_packed_otherwise_is_found(tmp_path, capsys):
    path = str(tmp_path / 'a.journal')
    writer = module.JournalWriter(path)
    drive, topics = driven(writer)
    (_, velocity), = push(drive, Stick(1.0, 0.2, False), [])
    topics[1].publish_packed(packed_twist(velocity.angular_rad_s, velocity.linear_mps))
    writer.stop()
    assert main(['', path]) == 1 and '"left","bot1","/bot1/cmd_vel"' in capsys.readouterr().out


def test_what_could_not_leave_is_not_said_to_have_left(tmp_path):
    writer = module.JournalWriter(str(tmp_path / 'a.journal'))
    drive, _ = driven(writer)
    gone = Publisher('/bot1/cmd_vel', fails=True)
    writer.watch('bot1', [gone])
    drive.on_stop(0.4)
    with pytest.raises(rospy.ROSException):
        gone.publish_packed(packed_twist(0.0, 0.0), urgent=True)
    drive.tick(0.41)
    writer.stop()
    assert 'has not left' in replay_file(str(tmp_path / 'a.journal')).difference


def test_a_full_disk_ends_the_journal_and_nothing_else(tmp_path, said):
    path = str(tmp_path / 'a.journal')
    writer = module.JournalWriter(path)
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (600, before[1]))
    try:
        drive, _ = driven(writer)
        wait_for(lambda: said, what='the word that it ends')
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    assert push(drive, Stick(1.0, 0.0, False), []) == [('bot1', Velocity(0.4))]
    writer.stop()
    assert len(said) == 1 and os.path.getsize(path) == 600
    report = replay_file(path)
    assert 0 < report.events < 4 and not report.difference


def test_a_disk_that_hangs_ends_the_journal_and_nothing_waits_for_it(tmp_path, said, monkeypatch):
    monkeypatch.setattr(module, 'LAST_S', 0.1)
    path = str(tmp_path / 'pipe.journal')
    os.mkfifo(path)
    # A pipe is open once somebody reads it; this one does so much later.
    late, lines = threading.Event(), []

    def read():
        with open(path) as pipe:
            late.wait()
            lines.extend(pipe)
    reader = threading.Thread(target=read)
    reader.start()
    writer = module.JournalWriter(path)
    drive, _ = driven(writer)
    for number in range(3 * module.MAX_WAITING):
        drive.tick(0.4 + 1e-6 * number)
    begun = time.monotonic()
    writer.stop()
    assert time.monotonic() - begun < 20.0 and not said
    late.set()
    reader.join()
    assert len(said) == 1
    # Nothing is missing in the middle.
    report = replay(lines)
    assert 0 < report.events < 3 * module.MAX_WAITING and not report.difference


@pytest.mark.parametrize('path', ['full.journal', 'no/such/folder/a.journal', '..', 'other'])
def test_without_a_file_that_can_be_written_there_is_a_drive(said, tmp_path, path):
    (tmp_path / 'full.journal').symlink_to('/dev/full')
    (tmp_path / 'other').write_text('of somebody')
    writer = module.JournalWriter(str(tmp_path / path))
    drive, _ = driven(writer)
    wait_for(lambda: said, what='the word that there is no journal')
    assert push(drive, Stick(1.0, 0.0, False), []) == [('bot1', Velocity(0.4))]
    writer.stop()
    assert len(said) == 1 and (tmp_path / 'other').read_text() == 'of somebody'


@pytest.mark.parametrize('words', [[''], ['', '/no/such/file'], ['', '/etc/hostname'],
                                   ['', '/dev/null']])
def test_the_command_says_when_there_is_no_journal(words, capsys):
    assert main(words) == 2 and capsys.readouterr().err
