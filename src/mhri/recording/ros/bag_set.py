# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The reader of bags: the newest messages at a time, and the messages after it.

Bags are read by ``rosbag.Bag``. This is the only module that uses private parts of it: its
connections, its table of types, its indexes (to find the newest message before a time its public
interface would read all) and the reading of a single message. A bag that was never closed is
indexed in memory; nothing is ever written.

``rosbag`` compiles the definitions in a bag, even to read it raw, and a definition can contain any
Python. An opened bag is therefore reduced to the types that are installed here in the same version,
with the installed definitions; see :func:`keep_installed`. Why not ``rosbags``: see
doc/libraries.md.
"""
from bisect import bisect_right
from collections import OrderedDict
from dataclasses import replace
import heapq
import io
import itertools
import os
import re
import struct
from types import SimpleNamespace
from typing import NamedTuple

import genpy
import numpy as np
import rosbag
import rosbag.bag
from rosbag.bag import ROSBagException, ROSBagUnindexedException

from mhri.base.io.files import text_in
from mhri.base.text import listed, tidy_text
from mhri.graph.ros.messages import installed_class, MessageMissing
from mhri.recording.folder import (
    bags_of, EVENTS_JSONL, NotASession, read_events, read_info, robots_of, SESSION_YAML)
from mhri.recording.time_fold import GAP_NS, spans_of, TimeFold

# Maximum number of open bags: the one being played, its neighbours, and those that a seek reads.
MAX_OPEN = 6
# A seek looks for the last message of a topic in at most this many earlier bags.
MAX_LOOKED_INTO = 3
# At most this many omitted topics are named.
MAX_NAMED = 5
#: errors of ``rosbag`` for a damaged file
DAMAGED = (ROSBagException, OSError, EOFError, ValueError, KeyError, IndexError, TypeError,
           struct.error, MemoryError, OverflowError, RuntimeError, genpy.DeserializationError)
_NS = 10 ** 9
_VERSION = 200
# Legal names (http://wiki.ros.org/Names), except private ones; the types of old versions.
_LEGAL = re.compile(r'/*[A-Za-z][A-Za-z0-9_]*(/+[A-Za-z0-9_]+)*/*\Z')
_RENAMED = {'tf/tfMessage': 'tf2_msgs/TFMessage'}
# Parts of an index record: lengths, the field with the number of its connection, and its entries.
_LENGTH, _CONN = struct.Struct('<I'), b'conn='
_ENTRY = np.dtype([('s', '<u4'), ('n', '<u4'), ('offset', '<u4')])


class Connection(NamedTuple):
    """A publisher of a topic: its type in the bag, and whether it was latched."""

    topic: str
    kind: str
    md5sum: str
    definition: str
    latched: bool


class Recorded(NamedTuple):
    """One message: its time of receipt [ns], its :class:`Connection`, and its bytes."""

    time_ns: int
    connection: Connection
    data: bytes

    def message(self):
        """Return the message.

        :raises MessageMissing, genpy.DeserializationError, ValueError: the message is unreadable
        """
        return installed_class(self.connection.kind, self.connection.md5sum)().deserialize(
            self.data)


class _Place(NamedTuple):
    """The location of a message: bag, number of its connection there, chunk, and offset in that."""

    time_ns: int
    bag: int
    number: int
    chunk: int
    offset: int


class BagSet:
    """Bags in the order of time; not thread-safe.

    :param paths: files; they may overlap a little, since each begins with the latched messages
    :param folds: whether times are without strays and long gaps (:class:`TimeFold`)
    :raises NotASession: none of them can be read
    """

    def __init__(self, paths, folds=False):
        self._paths, self._spans = [], []
        self._kinds, self._there = [], []
        self._fold = None
        self._open = OrderedDict()
        #: sentences about omissions
        self.problems = []
        left_out = {}
        for path in paths:
            self._add_bag(path, left_out, folds)
        if left_out:
            self.problems.append(_left_out(left_out))
        if not self._paths:
            raise NotASession('; '.join(self.problems) or 'there is no bag in it')
        fold = TimeFold(itertools.chain(*self._spans)) if folds else None
        if fold is not None and fold.problems:
            self._fold = fold
            self.problems += fold.problems
            self._spans = list(map(fold.spans, self._spans))
        self._starts = [min(begin for begin, *_ in spans) for spans in self._spans]
        self._ends = [max(end for _, end, _ in spans) for spans in self._spans]
        order = sorted(range(len(self._paths)), key=lambda index: self._starts[index])
        for name in ('_paths', '_starts', '_ends', '_kinds', '_there'):
            setattr(self, name, [getattr(self, name)[index] for index in order])

    def folded(self, event):
        """Return a line of a session at its time among the messages."""
        if self._fold is None:
            return event
        time_ns = np.array(min(max(event.ros, 0.0), 4e9) * _NS).astype(np.int64)
        return replace(event, ros=int(self._fold(time_ns)) / _NS)

    def _add_bag(self, path, left_out, folds):
        """Add a bag, without its index."""
        try:
            opened = _opened(path)
            with opened.bag as bag:
                if not opened.whole:
                    self.problems.append('{} was never closed, or cut off: its end may be missing'
                                         .format(os.path.basename(path)))
                left_out.update(opened.left_out)
                if not bag._chunks:
                    return
                self._spans.append(_spans(bag, folds))
                self._kinds.append({number: _connection(found)
                                    for number, found in bag._connections.items()})
        except DAMAGED as error:
            self.problems.append('{} cannot be read: {}'.format(
                os.path.basename(path), _reason(error)))
            return
        self._paths.append(path)
        self._there.append({kind.topic for kind in self._kinds[-1].values()})

    @property
    def start_ns(self):
        """The time of receipt of the first message."""
        return self._starts[0]

    @property
    def end_ns(self):
        """The time of receipt of the last message."""
        return max(self._ends)

    def connections(self):
        """Return all connections without repetition, in order of time."""
        return list(dict.fromkeys(kind for kinds in self._kinds for kind in kinds.values()))

    def _bag(self, index):
        """Return (bag, {connection: its :class:`Entries`}), opened if necessary."""
        if index in self._open:
            self._open.move_to_end(index)
            return self._open[index]
        bag = _opened(self._paths[index]).bag
        entries = index_of(bag)
        if self._fold is not None:
            entries = {number: self._folded(index, entries[number], kind.latched)
                       for number, kind in self._kinds[index].items() if number in entries}
        self._open[index] = bag, entries
        while len(self._open) > MAX_OPEN:
            self._open.popitem(last=False)[1][0].close()
        return self._open[index]

    def _folded(self, index, entries, latched):
        """Return entries of a bag at their folded times; of strays only latched ones, first."""
        stray = self._fold.is_stray(entries.times)
        times = np.where(stray, self._starts[index], self._fold(entries.times))
        return _in_order(*(part[~stray | latched] for part in (times, *entries[1:])))

    def _read(self, place):
        bag, _ = self._bag(place.bag)
        kind = self._kinds[place.bag][place.number]
        try:
            found = bag._read_message((place.chunk, place.offset), raw=True).message
        except DAMAGED as error:
            raise ROSBagException(_reason(error))
        # The record itself names a connection, too, and either may be wrong.
        if (found[0], found[2]) != (kind.kind, kind.md5sum):
            raise ROSBagException('its index is damaged: a {} for a {}'.format(
                found[0], kind.kind))
        return Recorded(place.time_ns, kind, found[1])

    def newest(self, time_ns, wanted=lambda connection: True):
        """Return the newest message of each topic at a time, the oldest first.

        :param wanted: function from a connection to whether it counts
        """
        last = max(0, bisect_right(self._starts, time_ns) - 1)
        found = self._newest_in(last, time_ns, wanted)
        looked = 0
        for index in range(last - 1, -1, -1):
            missing = {kind.topic for kind in self._kinds[index].values()
                       if wanted(kind) and kind.topic not in found}
            if missing:
                looked += 1
                found = {**self._newest_in(index, time_ns, lambda kind: wanted(kind)
                                           and kind.topic in missing), **found}
            if looked == MAX_LOOKED_INTO:
                break
        return list(self._readable(sorted(
            found.values(), key=lambda place: (place.time_ns, place.bag))))

    def _readable(self, places):
        for place in places:
            try:
                yield self._read(place)
            except ROSBagException as error:
                problem = '{} is damaged: {}'.format(
                    os.path.basename(self._paths[place.bag]), error)
                if problem not in self.problems:
                    self.problems.append(problem)

    def _newest_in(self, index, time_ns, wanted):
        """Return {topic: location of its newest message in a bag}."""
        (_, entries), found = self._bag(index), {}
        for number, kind in self._kinds[index].items():
            row = entries.get(number) if wanted(kind) else None
            last = row.until(time_ns) if row else 0
            if last:
                at, = self._places(index, number, row, last - 1, last)
                if kind.topic not in found or found[kind.topic].time_ns <= at.time_ns:
                    found[kind.topic] = at
        return found

    def after(self, time_ns, wanted=lambda connection: True):
        """Yield every message after a time, in order.

        :raises: one of :data:`DAMAGED`: the rest is unreadable
        """
        first = max(0, bisect_right(self._starts, time_ns) - 1)
        # The previous bag may end a moment after this one begins.
        for index in range(max(0, first - 1), len(self._paths)):
            if self._ends[index] <= time_ns:
                continue
            _, entries = self._bag(index)
            rows = [self._row(index, number, entries[number], time_ns)
                    for number, kind in self._kinds[index].items()
                    if number in entries and wanted(kind)]
            for place in heapq.merge(*rows, key=lambda place: place.time_ns):
                yield self._read(place)

    def _row(self, index, number, entries, time_ns):
        return self._places(index, number, entries, entries.until(time_ns), len(entries.times))

    @staticmethod
    def _places(index, number, entries, begin, end):
        """Yield the :class:`_Place` of some entries of a connection."""
        for time_ns, chunk, offset in zip(*(part[begin:end].tolist() for part in entries)):
            yield _Place(time_ns, index, number, chunk, offset)

    def close(self):
        """Close every file."""
        while self._open:
            self._open.popitem()[1][0].close()


def _spans(bag, folds):
    """Return the :data:`Span` rows of an open bag."""
    spans = [(chunk.start_time.to_nsec(), chunk.end_time.to_nsec(),
              sum(chunk.connection_counts.values())) for chunk in bag._chunks]
    if not folds or all(end - begin <= GAP_NS for begin, end, _ in spans):
        return spans
    # There may be a gap within a chunk.
    entries = index_of(bag).values()
    return spans_of(np.sort(np.concatenate([one.times for one in entries]))) if entries else spans


class Entries(NamedTuple):
    """The locations of a connection's messages, in order of time: arrays of the same length."""

    times: np.ndarray
    chunks: np.ndarray
    offsets: np.ndarray

    def until(self, time_ns):
        """Return the number of messages up to a time."""
        return int(np.searchsorted(self.times, time_ns, 'right'))


def index_of(bag):
    """Return {connection: :class:`Entries`} of an open bag, for connections with messages.

    The reader of ``rosbag`` makes an object per message, which takes ten times as long.

    :raises ROSBagException: the index is damaged
    """
    found = {}
    try:
        in_memory = any(bag._connection_indexes.values())
        for number, chunk, rows in (_entries_in_memory if in_memory else _entries_on_disk)(bag):
            parts = found.setdefault(number, ([], [], []))
            for part, values in zip(parts, (rows['s'].astype(np.int64) * _NS + rows['n'],
                                            np.full(len(rows), chunk), rows['offset'])):
                part.append(values)
    except (struct.error, ValueError) as error:
        raise ROSBagException('its index is damaged: {}'.format(error))
    return {number: _in_order(*map(np.concatenate, parts)) for number, parts in found.items()}


def _in_order(times, chunks, offsets):
    order = np.argsort(times, kind='stable')
    return Entries(times[order], chunks[order], offsets[order])


def _entries_on_disk(bag):
    """Yield (connection, chunk, its entries there) from the index records after each chunk."""
    stream = bag._file
    for chunk in bag._chunks:
        header = bag._chunk_headers[chunk.pos]
        stream.seek(header.data_pos + header.compressed_size)
        for _ in chunk.connection_counts:
            fields = stream.read(_LENGTH.unpack(stream.read(_LENGTH.size))[0])
            rows = np.frombuffer(stream.read(_LENGTH.unpack(stream.read(_LENGTH.size))[0]), _ENTRY)
            yield _LENGTH.unpack_from(fields, fields.index(_CONN) + len(_CONN))[0], chunk.pos, rows


def _entries_in_memory(bag):
    """Yield the same for a bag that was indexed in memory."""
    for number, entries in bag._connection_indexes.items():
        for chunk, of_chunk in itertools.groupby(entries, lambda entry: entry.chunk_pos):
            yield number, chunk, np.array([(entry.time.secs, entry.time.nsecs, entry.offset)
                                           for entry in of_chunk], _ENTRY)


class _Opened(NamedTuple):
    """A bag to read, whether its writer closed it, and {topic: why it is left out}."""

    bag: rosbag.Bag
    whole: bool
    left_out: dict


def _opened(path):
    """Open a bag to read, without its index unless it was never closed.

    :raises: one of :data:`DAMAGED`
    """
    try:
        bag, whole = rosbag.Bag(path, 'r', skip_index=True), True
    except ROSBagUnindexedException:
        bag, whole = rosbag.Bag(path, 'r', allow_unindexed=True, skip_index=True), False
    try:
        if bag.version != _VERSION:
            raise ROSBagException('it is of version {}: "rosbag fix" makes a new one of it'.format(
                bag.version))
        if not whole:
            _index(bag)
        return _Opened(bag, whole, keep_installed(bag))
    except BaseException:
        bag.close()
        raise


def _index(bag):
    """Index a bag in memory."""
    try:
        for _ in bag.reindex():
            pass
    except io.UnsupportedOperation:
        pass  # it would truncate an incomplete chunk, but the file is open for reading
    whole = bag._chunk_headers
    for number, entries in bag._connection_indexes.items():
        bag._connection_indexes[number] = [
            entry for entry in entries if entry.chunk_pos in whole]


def keep_installed(bag):
    """Reduce an opened bag to the types that are installed here; nothing in it is compiled.

    A message is read by the connection in its own record, regardless of the index: messages of a
    removed connection cannot be read.

    :returns: {topic: why it is left out}
    """
    left_out = {}
    for number, found in list(bag._connections.items()):
        found.datatype = _RENAMED.get(found.datatype, found.datatype)
        try:
            if not _LEGAL.match(found.topic):
                raise MessageMissing('not a name in ROS')
            kind = installed_class(found.datatype, found.md5sum)
        except MessageMissing as error:
            left_out[found.topic] = str(error)
            del bag._connections[number]
            continue
        found.msg_def = found.header['message_definition'] = kind._full_text
        rosbag.bag._message_types[found.md5sum] = kind
    return left_out


def _check_rosbag():
    """Check that ``rosbag`` uses its table of types before it compiles a definition.

    :raises ImportError: this version does not
    """
    table, probe = rosbag.bag._message_types, SimpleNamespace(
        md5sum='mhri', datatype='mhri/Probe', msg_def='not a definition')
    table[probe.md5sum] = probe
    try:
        if rosbag.bag._get_message_type(probe) is not probe:
            raise ImportError('this version of rosbag compiles what is in a bag')
    finally:
        del table[probe.md5sum]


_check_rosbag()


def _left_out(reasons):
    """Return a sentence about omitted topics."""
    return 'topics that cannot be read here: ' + listed((
        '{} ({})'.format(tidy_text(topic, 80), reason)
        for topic, reason in sorted(reasons.items())), MAX_NAMED)


def _reason(error):
    return str(getattr(error, 'strerror', None) or error) or type(error).__name__


def _connection(found):
    """Return the :class:`Connection` for a connection of ``rosbag``."""
    latched = found.header.get('latching', b'0')
    # "rosbag record bot1/odom" writes the name as it was typed.
    topic = '/' + '/'.join(filter(None, found.topic.split('/')))
    return Connection(topic, found.datatype, found.md5sum, found.msg_def,
                      latched in (b'1', '1'))


class OpenSession(NamedTuple):
    """A session to replay: bags, events, robots, and the prefix of each topic."""

    name: str
    bags: BagSet
    events: tuple
    robots: dict
    prefix: str


def open_session(path, foreign):
    """Open a session's folder, a folder of bags, or a bag of any program (blocking).

    :param foreign: function of ({topic: type}, the file's name) that returns
        (robots, prefix) if there is no ``session.yaml``
    :returns: :class:`OpenSession`
    :raises NotASession: the path cannot be replayed; the text names it and the reason
    """
    path = os.path.abspath(os.path.expanduser(path))
    try:
        return _open_folder(path, foreign) if os.path.isdir(path) else _open_file(path, foreign)
    except (NotASession, OSError, UnicodeDecodeError) as error:
        raise NotASession('{}: {}'.format(
            path, error.strerror if isinstance(error, OSError) else error))


def bags_in(path):
    """Return the :class:`BagSet` of a folder, folded (blocking).

    :raises NotASession: no bag in it can be read
    :raises OSError: it is no folder
    """
    names = sorted(os.listdir(path))
    bags = bags_of(names) or [name for name in names if name.endswith('.bag')]
    return BagSet([os.path.join(path, name) for name in bags], folds=True)


def _open_folder(path, foreign):
    opened = bags_in(path)
    name = os.path.basename(path)
    info = os.path.join(path, SESSION_YAML)
    if not os.path.exists(info):
        return _open_foreign(name, opened, foreign)
    events = tuple(map(opened.folded, read_events(text_in(os.path.join(path, EVENTS_JSONL)))))
    return OpenSession(name, opened, events, robots_of(read_info(text_in(info)), events), '')


def _open_file(path, foreign):
    if not os.path.exists(path):
        raise NotASession('there is no such file or folder')
    name = os.path.splitext(os.path.basename(path))[0]
    return _open_foreign(name, BagSet([path], folds=True), foreign)


def _open_foreign(name, bags, foreign):
    try:
        robots, prefix = foreign({connection.topic: connection.kind
                                  for connection in bags.connections()}, name)
    except NotASession as error:
        raise NotASession('; '.join([str(error)] + bags.problems))
    return OpenSession(name, bags, (), robots, prefix)
