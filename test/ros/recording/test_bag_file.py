# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A bag file as it stands on the disk at any moment, read back with the rosbag library."""
import errno
import io
import os
import shutil
import struct
import tracemalloc

import pytest
import rosbag
from std_msgs.msg import Empty, Int32, String

from mhri.recording.ros import bag_file
from mhri.recording.ros.bag_file import BagFile, Publisher

S = 10 ** 9


def frame(message):
    """Return a message as it comes over the wire."""
    buffer = io.BytesIO()
    message.serialize(buffer)
    return struct.pack('<I', len(buffer.getvalue())) + buffer.getvalue()


def publisher(topic, kind, **more):
    return Publisher(dict(more, topic=topic, type=kind._type, md5sum=kind._md5sum,
                          message_definition=kind._full_text))


def small_bag(path):
    """Write a bag of two chunks and two topics that is not closed yet; return (file, content)."""
    numbers = publisher('/n', Int32, callerid='/a')
    texts = publisher('/t', String, callerid='/b', latching='1')
    file = BagFile(str(path))
    file.write([(numbers, S + value, frame(Int32(value))) for value in range(5)])
    file.write([(texts, 2 * S, frame(String('x' * 100))), (numbers, 2 * S + 1, frame(Int32(5))),
                (texts, 3 * S - 1, frame(String('')))])
    wanted = [('/n', value, S + value) for value in range(5)]
    wanted += [('/t', 'x' * 100, 2 * S), ('/n', 5, 2 * S + 1), ('/t', '', 3 * S - 1)]
    return file, wanted


def content(bag):
    return [(topic, message.data, time.to_nsec()) for topic, message, time in bag.read_messages()]


def reindexed(path):
    """Return what the library saves of a file without an index."""
    with rosbag.Bag(str(path), 'a', allow_unindexed=True) as bag:
        for _ in bag.reindex():
            pass
    with rosbag.Bag(str(path)) as bag:
        return content(bag)


def test_written_and_read(tmp_path):
    file, wanted = small_bag(tmp_path / 'a.bag')
    assert os.listdir(str(tmp_path)) == ['a.bag.active']
    assert file.close() == str(tmp_path / 'a.bag') and os.listdir(str(tmp_path)) == ['a.bag']
    assert (file.messages, file.size) == (8, os.path.getsize(file.path))
    with rosbag.Bag(file.path) as bag:
        assert content(bag) == wanted
        assert bag.get_message_count() == 8
        assert (bag.get_start_time(), bag.get_end_time()) == (1.0, pytest.approx(3.0))
        header = next(bag.read_messages('/t', return_connection_header=True))[3]
        assert (header['callerid'], header['latching']) == (b'/b', b'1')
        assert header['message_definition'].decode() == String._full_text


def test_publishers_of_one_topic_are_told_apart(tmp_path):
    """By caller, and even by type: one that this computer does not know, and one without bytes."""
    unknown = Publisher({'topic': '/t', 'type': 'lab_msgs/Nowhere', 'md5sum': 'f' * 32,
                         'message_definition': 'int8 x', 'callerid': '/c'})
    senders = [publisher('/t', String, callerid='/a'), publisher('/t', String, callerid='/b'),
               publisher('/t', Empty, callerid='/a'), unknown]
    data = [frame(String('a')), frame(String('b')), frame(Empty()), frame(Int32(7))]
    file = BagFile(str(tmp_path / 'a.bag'))
    file.write([(sender, S + turn, data[turn]) for turn, sender in enumerate(senders)])
    file.write([(senders[1], 2 * S, data[1])])
    file.close()
    with rosbag.Bag(file.path) as bag:
        found = [(header['callerid'], raw[0], raw[1]) for _, raw, _, header in bag.read_messages(
            '/t', raw=True, return_connection_header=True)]
    assert found == [
        (b'/a', 'std_msgs/String', data[0][4:]), (b'/b', 'std_msgs/String', data[1][4:]),
        (b'/a', 'std_msgs/Empty', b''), (b'/c', 'lab_msgs/Nowhere', data[3][4:]),
        (b'/b', 'std_msgs/String', data[1][4:])]


@pytest.mark.parametrize('lost, left', [(0, 8), (1, 5), (100, 5), (-1, 0)])
def test_reindexed_after_a_kill(tmp_path, lost, left):
    """The file as it stands while open, and with its last chunk cut: all whole chunks are found."""
    file, wanted = small_bag(tmp_path / 'a.bag')
    path = tmp_path / 'killed.bag'
    shutil.copy(str(tmp_path / 'a.bag.active'), str(path))
    os.truncate(str(path), 4200 if lost < 0 else file.size - lost)
    assert reindexed(path) == wanted[:left]
    file.close()


def test_a_chunk_comes_to_the_disk_in_one_piece(tmp_path, monkeypatch):
    """Whatever moment the program is killed at, no chunk without a size is there."""
    writes, real = [], os.pwrite
    monkeypatch.setattr(bag_file.os, 'pwrite', lambda *args: writes.append(args) or real(*args))
    file, _ = small_bag(tmp_path / 'a.bag')
    assert len(writes) == 3, 'the beginning of the file and two chunks'
    file.close()


class FullDisk:
    """A disk with room for some bytes in the file: what is beyond is refused."""

    def __init__(self, room):
        self.room = room

    def pwrite(self, descriptor, data, position):
        left = self.room - position
        if left <= 0:
            raise OSError(errno.ENOSPC, 'No space left on device')
        return REAL_PWRITE(descriptor, data[:left], position)


REAL_PWRITE = os.pwrite


@pytest.mark.parametrize('room, left', [(2000, 8), (150, 5)])
def test_a_disk_that_is_full(tmp_path, monkeypatch, room, left):
    """A chunk that finds no room is not there; one that leaves the index none is given up."""
    file, wanted = small_bag(tmp_path / 'a.bag')
    size = file.size
    monkeypatch.setattr(bag_file.os, 'pwrite', FullDisk(size + room).pwrite)
    with pytest.raises(OSError):
        file.write([(publisher('/big', String), 4 * S, frame(String('x' * 10000)))])
    assert os.path.getsize(str(tmp_path / 'a.bag.active')) == size and file.messages == 8
    with rosbag.Bag(file.close()) as bag:
        assert content(bag) == wanted[:left]
    assert file.messages == left


def test_memory_does_not_grow_with_the_messages(tmp_path):
    item, data = publisher('/n', Int32), frame(Int32(1))
    file = BagFile(str(tmp_path / 'a.bag'))

    def write(chunks):
        for turn in range(chunks):
            file.write([(item, S + turn, data)] * 1000)
    write(1)
    tracemalloc.start()
    try:
        before, _ = tracemalloc.get_traced_memory()
        write(5)
        grown = tracemalloc.get_traced_memory()[0] - before
    finally:
        tracemalloc.stop()
    file.close()
    assert grown < 5 * 1000 * 10, '{} bytes for 5000 messages'.format(grown)
