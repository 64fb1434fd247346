# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Everything that a session hears, as bytes: into the ring, or into the bags.

One thread reads all connections; what it does for a message is to append it to a list.
"""
import struct
import threading
import time

from sensor_msgs.msg import CompressedImage

from mhri.recording.folder import BAG_S
from mhri.recording.ros.bag_file import Publisher
from mhri.recording.ros.raw_reader import RawReader
from mhri.recording.ros.tap_node import TapNode
from mhri.session.ring import Chunk, Latched, Ring
from mhri.session.ros.session_writer import NewBag
from mhri.session.topics import PICTURES

_LENGTH = struct.Struct('<I')
_NS = 10 ** 9
# There are hundreds of topics with a dozen robots [s].
RENEWAL_S = 5.0
# Of two screens that pass on the same camera, the second counts once the first was silent so long.
_PASSES_ON_NS = 2 * _NS


class Source:
    """One publisher of one topic: how it stands in a bag, and what came last.

    ``frame`` is the newest message (its length and bytes), None before the first, ``at_ns`` when it
    came, ``kept_ns`` when one was kept; ``watch`` is told of each.
    """

    __slots__ = ('publisher', 'frame', 'at_ns', 'kept_ns', 'is_picture', 'watch')

    def __init__(self, fields, is_picture=False, watch=None):
        self.publisher = Publisher(fields)
        self.frame = None
        self.at_ns = self.kept_ns = 0
        self.is_picture = is_picture
        self.watch = watch

    @property
    def fields(self):
        """What the publisher says of itself."""
        return self.publisher.fields


class SessionTap:
    """Reads the topics of a session; keeps the ring, and writes while there is a writer.

    :param name: of the node on the graph
    :param limits: :class:`mhri.recording.recording.RecordingLimits`
    :param ring_s: how much to keep before a recording [s]
    :param ring_bytes: ... and at most so many bytes
    :param watched: {topic: function of (fields, time [ns], frame)}, called on the reading thread
    :param clock_ns: function that returns the receipt time [ns]
    :param bag_s: the longest that a bag lasts [s]
    """

    def __init__(self, name, limits, ring_s, ring_bytes, watched, clock_ns,
                 bag_s=BAG_S):
        self._limits = limits
        self._watched = watched
        self._clock_ns = clock_ns
        self._bag_ns = round(bag_s * _NS)
        self._lock = threading.Lock()
        self._latched = Latched()
        self._ring = Ring(ring_s, ring_bytes, self._latched)
        self._sources = {}
        self._pictures = {}
        self._passed_by = {}
        self._cameras = frozenset()
        self._pictures_ns = 0
        self._keep_pictures = True
        self._chunk, self._size, self._due_s = [], 0, None
        self._writer = None
        self._bag_begun_ns = 0
        self._wanted = ()
        self._ended = threading.Event()
        self._reader = RawReader(name, self._on_frame, self._on_turn, self._ended.set)
        self._node = TapNode(name, (), self._reader.want, RENEWAL_S)

    def start(self):
        """Join the graph.

        :raises OSError: no address is available
        """
        self._node.start()
        self._reader.start()

    def want(self, topics, cameras=()):
        """Hear exactly these topics; ``cameras`` are those of them that carry pictures."""
        topics = tuple(dict.fromkeys((*topics, *cameras)))
        if (topics, frozenset(cameras)) == (self._wanted, self._cameras):
            return
        gone = set(self._wanted) - set(topics)
        self._wanted, self._cameras = topics, frozenset(cameras)
        self._node.want(topics)
        if gone:
            self._reader.leave(gone)
            with self._lock:
                for topic in gone:
                    for source in self._sources.pop(topic, {}).values():
                        self._latched.forget(source.publisher)

    def keep_pictures(self, hz):
        """Keep so many pictures a second of each camera; None: all, 0: the newest alone."""
        self._pictures_ns = round(_NS / hz) if hz else 0
        self._keep_pictures = hz != 0

    def newest(self, topic):
        """Return the :class:`Source` of the newest message of a topic, None without any."""
        with self._lock:
            found = list(self._sources.get(topic, {}).values())
        return max((source for source in found if source.frame is not None),
                   key=lambda source: source.at_ns, default=None)

    def pictures(self, within_s):
        """Return {topic: :class:`Source`} of the pictures that came within so many seconds."""
        after_ns = self._clock_ns() - round(within_s * _NS)
        with self._lock:
            found = dict(self._pictures)
        return {topic: source for topic, source in found.items() if source.at_ns >= after_ns}

    @property
    def ring_bytes(self):
        """How much the ring keeps now [bytes]."""
        return self._ring.size

    def record_to(self, writer):
        """Write the ring, and from now on everything, with a started :class:`SessionWriter`."""
        with self._lock:
            self._flush()
            self._bag_begun_ns = 0
            for chunk in self._ring.take():
                self._write(writer, chunk)
            self._writer = writer

    def stop_recording(self):
        """Give what has come by now to the writer, and keep a ring again; return the writer."""
        with self._lock:
            self._flush()
            writer, self._writer = self._writer, None
        return writer

    def close(self, timeout_s=3.0):
        """Leave the graph."""
        self._node.stop()
        self._reader.stop()
        self._ended.wait(timeout_s)

    def _on_frame(self, link, frame):
        now_ns = self._clock_ns()
        source = link.publisher or self._meet(link)
        if link.key[0] == PICTURES:
            source, frame = self._unpack(link, frame, now_ns)
            if source is None:
                return
        if source.watch is not None:
            source.watch(source.fields, now_ns, frame)
        source.frame, source.at_ns = frame, now_ns
        if source.is_picture:
            if not self._keep_pictures or now_ns - source.kept_ns < self._pictures_ns:
                return
            source.kept_ns = now_ns
        with self._lock:
            self._chunk.append((source.publisher, now_ns, frame))
            self._size += len(frame)
            if self._due_s is None:
                self._due_s = time.monotonic() + self._limits.chunk_s
            if self._size >= self._limits.chunk_bytes:
                self._flush()

    def _meet(self, link):
        """Return the source of a new connection; a returning publisher is the same."""
        topic, fields = link.key[0], link.fields
        source = self._source(topic, fields, topic in self._cameras)
        if topic != PICTURES:
            link.publisher = source
        return source

    def _source(self, topic, fields, is_picture):
        with self._lock:
            of_topic = self._sources.setdefault(topic, {})
            key = tuple(sorted(fields.items()))
            if key not in of_topic:
                of_topic[key] = Source(fields, is_picture, self._watched.get(topic))
            if is_picture:
                self._pictures[topic] = of_topic[key]
            return of_topic[key]

    def _unpack(self, link, frame, now_ns):
        """Return the source and the frame of a camera's picture that a screen has passed on.

        The source is None where another screen passes on the same camera.
        """
        end = 8 + _LENGTH.unpack_from(frame, 4)[0]
        topic = frame[8:end].decode()
        source = self._pictures.get(topic) or self._source(topic, {
            'topic': topic, 'type': CompressedImage._type, 'md5sum': CompressedImage._md5sum,
            'message_definition': CompressedImage._full_text,
            'callerid': link.fields['callerid']}, True)
        if self._passed_by.get(topic) != link.key and now_ns - source.at_ns < _PASSES_ON_NS:
            return None, b''
        self._passed_by[topic] = link.key
        return source, frame[end:]

    def _flush(self):
        """Pass the chunk on (under the lock)."""
        if self._chunk:
            chunk = Chunk(self._chunk, self._size)
            self._chunk, self._size = [], 0
            if self._writer is None:
                self._ring.put(chunk)
            else:
                self._write(self._writer, chunk)
                self._latched.see(chunk)
        self._due_s = None

    def _write(self, writer, chunk):
        """Write a chunk, in a new bag where this one lasts long enough (under the lock)."""
        if not self._bag_begun_ns or chunk.ended_ns - self._bag_begun_ns > self._bag_ns:
            self._bag_begun_ns = chunk.begun_ns
            head = NewBag(self._latched.at(chunk.begun_ns))
            writer.put(head, sum(len(frame) for _, _, frame in head))
        writer.put(chunk.messages, chunk.size)

    def _on_turn(self):
        """Return in how many seconds the chunk must go on."""
        due_s = self._due_s
        if due_s is None:
            return None
        left_s = due_s - time.monotonic()
        if left_s > 0.0:
            return left_s
        with self._lock:
            self._flush()
        return None
