# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The bytes of a bag, read back with the rosbag library; and frames cut out of a stream."""
import io
import struct

import genpy
import pytest
import rosbag
from std_msgs.msg import Int32, String

from mhri.core.recording.bag_format import (
    Chunk, Connection, file_header, FrameSplitter, VERSION_LINE)

S = 10 ** 9


class Stream(io.BytesIO):
    """A file in memory that the library takes for one."""

    mode = 'w+b'


def frame(message):
    """Return a message as it comes over the wire."""
    buffer = io.BytesIO()
    message.serialize(buffer)
    return struct.pack('<I', len(buffer.getvalue())) + buffer.getvalue()


def connection(number, topic, kind, **more):
    return Connection(number, dict(more, topic=topic, type=kind._type, md5sum=kind._md5sum,
                                   message_definition=kind._full_text))


def bag_of(chunks, connections):
    """Return the bytes of a whole bag."""
    data, infos = VERSION_LINE + file_header(), []
    for chunk in chunks:
        piece, info = chunk.finish(len(data))
        data += piece
        infos.append(info)
    index = b''.join([item.record for item in connections] + infos)
    head = VERSION_LINE + file_header(len(data), len(connections), len(infos))
    return head + data[len(head):] + index


def small_bag():
    """Return (bytes, what is in it as (topic, value, time)) of two chunks and two topics."""
    numbers = connection(0, '/n', Int32, callerid='/a')
    texts = connection(1, '/t', String, callerid='/b', latching='1')
    first, second = Chunk(), Chunk()
    first.introduce(numbers)
    for value in range(5):
        first.add(numbers, S + value, frame(Int32(value)))
    second.introduce(texts)
    second.add(texts, 2 * S, frame(String('x' * 100)))
    second.add(numbers, 2 * S + 1, frame(Int32(5)))
    second.add(texts, 3 * S - 1, frame(String('')))
    wanted = [('/n', value, S + value) for value in range(5)]
    wanted += [('/t', 'x' * 100, 2 * S), ('/n', 5, 2 * S + 1), ('/t', '', 3 * S - 1)]
    return bag_of([first, second], [numbers, texts]), wanted


def content(bag):
    return [(topic, message.data, time.to_nsec()) for topic, message, time in bag.read_messages()]


def test_read_by_the_library():
    data, wanted = small_bag()
    with rosbag.Bag(Stream(data)) as bag:
        assert content(bag) == wanted
        assert (bag.get_message_count(), len(bag._chunks)) == (8, 2)
        assert (bag.get_start_time(), bag.get_end_time()) == (1.0, pytest.approx(3.0))
        header = [item.header for item in bag._get_connections('/t')][0]
        assert (header['callerid'], header['latching']) == (b'/b', b'1')
        assert header['message_definition'].decode() == String._full_text


def test_same_file_as_the_library_writes():
    """Byte for byte, where the chunks end at the same messages."""
    numbers, texts = connection(0, '/n', Int32), connection(1, '/t', String)
    first, second = Chunk(), Chunk()
    stream = Stream()
    bag = rosbag.Bag(stream, 'w')
    first.introduce(numbers)
    for value in range(3):
        first.add(numbers, S + value, frame(Int32(value)))
        bag.write('/n', Int32(value), genpy.Time(1, value))
    bag.flush()
    second.introduce(texts)
    for value in range(3):
        second.add(texts, 2 * S + value, frame(String('x' * value)))
        bag.write('/t', String('x' * value), genpy.Time(2, value))
    bag._stop_writing()
    assert bag_of([first, second], [numbers, texts]) == stream.getvalue()


def test_a_clock_that_runs_back_is_indexed_by_time():
    item = connection(0, '/n', Int32)
    chunk = Chunk()
    chunk.introduce(item)
    times = [5 * S, 5 * S + 300, 2 * S + 70000, 2 * S, 7 * S]
    for value, time_ns in enumerate(times):
        chunk.add(item, time_ns, frame(Int32(value)))
    with rosbag.Bag(Stream(bag_of([chunk], [item]))) as bag:
        assert [value for _, value, _ in content(bag)] == [3, 2, 0, 1, 4]
        assert (bag.get_start_time(), bag.get_end_time()) == (2.0, 7.0)


@pytest.mark.parametrize('lost, left', [(0, 8), (1, 5), (100, 5), (-1, 0)])
def test_reindexed_after_a_kill(tmp_path, lost, left):
    """Without its index, and with its last chunk cut, the library finds all whole chunks."""
    data, wanted = small_bag()
    with rosbag.Bag(Stream(data)) as bag:
        end = bag._index_data_pos
        start = bag._chunks[0].pos
    cut = start + 10 if lost < 0 else end - lost
    path = tmp_path / 'killed.bag'
    head = VERSION_LINE + file_header()
    path.write_bytes(head + data[len(head):cut])
    with rosbag.Bag(str(path), 'a', allow_unindexed=True) as bag:
        for _ in bag.reindex():
            pass
    with rosbag.Bag(str(path)) as bag:
        assert content(bag) == wanted[:left]


FRAMES = [struct.pack('<I', size) + bytes([65 + size % 26]) * size
          for size in (0, 1, 3, 4, 5, 70, 0, 1000)]


@pytest.mark.parametrize('step', [1, 2, 3, 4, 5, 7, 64, 1000, 10000])
def test_frames_of_a_stream_in_pieces(step):
    stream, splitter, found = b''.join(FRAMES), FrameSplitter(), []
    for start in range(0, len(stream), step):
        found += splitter.split(stream[start:start + step])
    assert found == FRAMES


def test_what_is_missing_of_a_long_message():
    splitter = FrameSplitter()
    assert list(splitter.split(struct.pack('<I', 1000) + b'x' * 300)) == []
    assert splitter.wanted == 700
    assert list(splitter.split(b'x' * 699)) == [] and splitter.wanted == 1
    assert [len(item) for item in splitter.split(b'x')] == [1004]
    assert splitter.wanted == 0


def test_a_length_that_cannot_be():
    with pytest.raises(ValueError):
        FrameSplitter().split(struct.pack('<I', 2 * 10 ** 9) + b'x')
