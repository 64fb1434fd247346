# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""All messages of a session, as bytes: into the ring, or into the bags.

One thread reads all connections; per message it only appends to a list.
"""
import struct
import threading

from sensor_msgs.msg import CompressedImage

from mhri.camera.transports import PICTURES
from mhri.recording.folder import BAG_S
from mhri.recording.ros.bag_file import Publisher
from mhri.recording.ros.gathering import Gathering
from mhri.recording.ros.raw_reader import RawReader
from mhri.recording.ros.tap_node import TapNode
from mhri.session.ring import Chunk, Latched, Ring
from mhri.session.ros.session_writer import NewBag

_LENGTH = struct.Struct('<I')
_NS = 10 ** 9
# Long, because a dozen robots have hundreds of topics [s].
RENEWAL_S = 5.0
# If two screens relay the same camera, the second is used once the first is silent this long.
_PASSES_ON_NS = 2 * _NS


class Source:
    """One publisher of one topic: its connection in a bag, and its newest message.

    ``frame`` is the newest message (its length and bytes), None before the first; ``at_ns`` is its
    receipt time, ``kept_ns`` that of the last one kept; ``watch`` is called with each message.
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
        """The header of the publisher's connection."""
        return self.publisher.fields


class SessionTap:
    """Reads the topics of a session into the ring, or into a writer while recording.

    :param name: name of the node on the graph
    :param limits: :class:`mhri.recording.recording.RecordingLimits`
    :param ring_s: duration to keep before a recording [s]
    :param ring_bytes: maximum size of the ring [bytes]
    :param watched: {topic: function of (fields, time [ns], frame)}, called on the reading thread
    :param clock_ns: function that returns the receipt time [ns]
    :param bag_s: maximum duration of a bag [s]
    """

    def __init__(self, name, limits, ring_s, ring_bytes, watched, clock_ns,
                 bag_s=BAG_S):
        self._watched = watched
        self._clock_ns = clock_ns
        self._bag_ns = round(bag_s * _NS)
        self._gathering = Gathering(limits, self._hand_on)
        self._lock = self._gathering.lock
        self._latched = Latched()
        self._ring = Ring(ring_s, ring_bytes, self._latched)
        self._sources = {}
        self._pictures = {}
        self._passed_by = {}
        self._cameras = frozenset()
        self._pictures_ns = 0
        self._keep_pictures = True
        self._writer = None
        self._bag_begun_ns = 0
        self._wanted = ()
        self._ended = threading.Event()
        self._reader = RawReader(name, self._on_frame, self._gathering.on_turn,
                                 self._ended.set)
        self._node = TapNode(name, (), self._reader.connect, RENEWAL_S)

    def start(self):
        """Join the graph.

        :raises OSError: no address is available
        """
        self._node.start()
        self._reader.start()

    def subscribe(self, topics, cameras=()):
        """Subscribe exactly ``topics`` and ``cameras``, the topics that carry pictures."""
        topics = tuple(dict.fromkeys((*topics, *cameras)))
        if (topics, frozenset(cameras)) == (self._wanted, self._cameras):
            return
        gone = set(self._wanted) - set(topics)
        self._wanted, self._cameras = topics, frozenset(cameras)
        self._node.set_topics(topics)
        if gone:
            self._reader.leave(gone)
            with self._lock:
                for topic in gone:
                    for source in self._sources.pop(topic, {}).values():
                        self._latched.forget(source.publisher)

    def keep_pictures(self, hz):
        """Set the pictures to keep per second and camera; None: all, 0: only the newest."""
        # A little early counts: neither a camera nor a screen is synchronised with this clock.
        self._pictures_ns = round(0.9 * _NS / hz) if hz else 0
        self._keep_pictures = hz != 0

    def newest(self, topic):
        """Return the :class:`Source` of a topic's newest message, None before the first."""
        with self._lock:
            found = list(self._sources.get(topic, {}).values())
        return max((source for source in found if source.frame is not None),
                   key=lambda source: source.at_ns, default=None)

    def pictures(self, within_s):
        """Return {topic: :class:`Source`} of the pictures received within the last seconds."""
        after_ns = self._clock_ns() - round(within_s * _NS)
        with self._lock:
            found = dict(self._pictures)
        return {topic: source for topic, source in found.items() if source.at_ns >= after_ns}

    @property
    def ring_bytes(self):
        """The current size of the ring [bytes]."""
        return self._ring.size

    def record_to(self, writer):
        """Write the ring, then all new messages, to a started :class:`SessionWriter`."""
        with self._lock:
            self._gathering.flush()
            self._bag_begun_ns = 0
            for chunk in self._ring.take():
                self._write(writer, chunk)
            self._writer = writer

    def stop_recording(self):
        """Flush to the writer and return it; from now on fill the ring again."""
        with self._lock:
            self._gathering.flush()
            writer, self._writer = self._writer, None
        return writer

    def close(self, timeout_s=3.0):
        """Leave the graph."""
        self._node.stop()
        self._reader.stop()
        self._ended.wait(timeout_s)

    def _on_frame(self, link, frame):
        now_ns = self._clock_ns()
        source = link.publisher or self._source_of(link)
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
            self._gathering.add(source.publisher, now_ns, frame)

    def _source_of(self, link):
        """Return the source of a new connection; a reconnecting publisher keeps its source."""
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
        """Return the source and the frame of a camera's picture relayed by a screen.

        The source is None if another screen already relays this camera.
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

    def _hand_on(self, messages, size):
        """Pass a chunk on (under the lock)."""
        chunk = Chunk(messages, size)
        if self._writer is None:
            self._ring.put(chunk)
        else:
            self._write(self._writer, chunk)
            self._latched.update(chunk)

    def _write(self, writer, chunk):
        """Write a chunk, into a new bag if the current one is long enough (under the lock)."""
        if not self._bag_begun_ns or chunk.ended_ns - self._bag_begun_ns > self._bag_ns:
            self._bag_begun_ns = chunk.begun_ns
            head = NewBag(self._latched.at(chunk.begun_ns))
            writer.put(head, sum(len(frame) for _, _, frame in head))
        writer.put(chunk.messages, chunk.size)
