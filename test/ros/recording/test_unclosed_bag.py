# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The last bag of a killed recorder: read as far as it is whole, never written."""
import os
import stat

import pytest
import rosbag

from mhri.recording.ros.bag_set import BagSet, open_session
from support import made_session as made

NS = 10 ** 9


def nobody(*_):
    raise AssertionError('a session says itself which robots it has')


@pytest.fixture
def killed(tmp_path):
    """Return the folder of a session whose last bag was never closed, and was cut off."""
    folder = made.write_session(tmp_path / 'session')
    last = folder / '0002.bag'
    with rosbag.Bag(str(last), 'w', chunk_threshold=2000) as bag:
        for time_s, topic, message, _ in made.rows_between(40.0, 60.0):
            bag.write(topic, message, made.stamp(time_s))
    data = bytearray(last.read_bytes())
    # As it is while it is written: no place of an index yet, and a chunk that is not whole.
    place = data.index(b'index_pos=') + len(b'index_pos=')
    data[place:place + 8] = bytes(8)
    active = folder / '0002.bag.active'
    active.write_bytes(bytes(data[:len(data) * 2 // 3]))
    last.unlink()
    active.chmod(stat.S_IRUSR)
    return folder, active


def test_what_is_whole_is_played(killed):
    folder, active = killed
    before = active.read_bytes()
    kept = open_session(str(folder), nobody)
    start_ns, end_ns = kept.bags.start_ns, kept.bags.end_ns
    assert 45.0 < (end_ns - start_ns) / NS < 59.0
    assert [text.partition(' ')[0] for text in kept.bags.problems] == ['0002.bag.active']
    told = [one for one in kept.bags.after(start_ns) if one.connection.topic == '/bot1/odom']
    times = [one.time_ns for one in told]
    assert times == sorted(times) and times[-1] > start_ns + 45 * NS
    newest = {one.connection.topic: one for one in kept.bags.newest(end_ns)}
    assert newest['/bot1/odom'].data == told[-1].data
    kept.bags.close()
    assert active.read_bytes() == before
    assert sorted(os.listdir(str(folder))) == [
        '0000.bag', '0001.bag', '0002.bag.active', 'events.jsonl', 'session.yaml']


@pytest.mark.parametrize('size', (0, 10, 13, 4100))
def test_one_with_nothing_in_it_is_left_out(killed, size):
    folder, active = killed
    data = active.read_bytes()[:size]
    active.chmod(stat.S_IRUSR | stat.S_IWUSR)
    active.write_bytes(data)
    bags = BagSet([str(folder / '0000.bag'), str(active)])
    assert bags.end_ns < bags.start_ns + 21 * NS
    bags.close()
