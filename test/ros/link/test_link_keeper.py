# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What a robot keeps of what its host missed: the newest, and never more than there is room for."""
import os

import pytest

from mhri.link.ros.keeper import Keeper, LATE_S
from mhri.recording.recording import ENDED, MB, RECORDING, RecordingStatus


class FakeRecorder:
    """Writes as many bytes as the time that it ran is worth."""

    def __init__(self, lab, path):
        self.lab, self.path, self.begun, self.ended = lab, path, lab.now, None

    def start(self):
        """Begin."""

    def stop(self):
        self.ended = self.lab.now
        with open(self.path, 'wb') as file:
            file.truncate(self.size())

    def size(self):
        return int(self.lab.rate * ((self.ended or self.lab.now) - self.begun))

    def status(self):
        return RecordingStatus(RECORDING if self.ended is None else ENDED, self.path, messages=1,
                               bytes=self.size())


class Lab:
    """A keeper, its clock, and its recorders with so many bytes a second."""

    def __init__(self, folder, max_mb):
        self.folder, self.now, self.rate, self.topics = folder, 1700000000.0, 0, []
        self.keeper = Keeper('bot1', str(folder), lambda: self.now, self.make)
        self.keeper.max_mb = max_mb

    def make(self, _robot, topics, path):
        self.topics.append(list(topics))
        return FakeRecorder(self, path)

    def go_on(self, seconds, heard, rate, pictures=False):
        """Let time pass, half a second at a time."""
        self.rate = rate
        for _ in range(int(2 * seconds)):
            self.now += 0.5
            self.keeper.request('host', True, heard, pictures)
            self.keeper.tick(['/bot1/odom'] + ['/bot1/camera'] * self.keeper.pictures_too())

    def kept(self):
        """Return (bytes on the disk, when the first kept piece began, when the last ended)."""
        rows = self.keeper.pieces()
        return (sum(os.path.getsize(str(self.folder / row.name)) for row in rows),
                min(row.begun_ms for row in rows) / 1e3,
                max(row.begun_ms + row.lasts_ms for row in rows) / 1e3)


def test_nothing_is_kept_while_the_host_is_there(tmp_path):
    lab = Lab(tmp_path, 10)
    lab.go_on(60, True, 1000)
    assert lab.keeper.pieces() == []


@pytest.mark.parametrize('rate', [1000, MB // 10, MB])
def test_of_an_outage_the_newest_is_kept_and_no_more_than_there_is_room_for(tmp_path, rate):
    lab = Lab(tmp_path, 10)
    lab.go_on(20, True, rate)
    gone_at = lab.now
    lab.go_on(120, False, rate)
    back_at = lab.now
    lab.go_on(3 * LATE_S, True, rate)
    size, begun, ended = lab.kept()
    assert size <= 10 * MB and ended >= back_at
    # All of it, or as much as has room.
    assert begun <= gone_at or size > 5 * MB


def test_pictures_are_recorded_while_a_host_wants_them(tmp_path):
    lab = Lab(tmp_path, 10)
    lab.go_on(15, True, 1000)
    lab.go_on(15, True, 1000, pictures=True)
    assert lab.topics[0] == ['/bot1/odom'] and lab.topics[-1] == ['/bot1/odom', '/bot1/camera']
