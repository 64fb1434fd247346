# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The doctor asks all nodes at once, each on its own thread, and listens to what they publish.

It registers nothing at the master. It asks for a topic as a subscriber does, and hangs up at once;
it leaves pictures and point clouds alone, since a driver may start its sensor for them.
"""
import http.client
import re
import select
import socket
import struct
import threading
import time
from urllib.parse import urlsplit
import xmlrpc.client

from mhri.doctor.facts import (
    ANSWERS, Connection, is_ipv4, LISTENED_S, Node, REFUSED, SILENT, STRANGER, Stream, UNRESOLVED)
from mhri.doctor.ros.host import resolve
from mhri.graph.ros.master_api import TimedTransport
from mhri.graph.ros.messages import installed_class, MessageMissing
from mhri.recording.ros.raw_link import LinkError, RawLink

# Not asked for: subscribing to them starts a camera, or brings megabytes.
HEAVY = ('sensor_msgs/Image', 'sensor_msgs/CompressedImage', 'sensor_msgs/CameraInfo',
         'sensor_msgs/PointCloud2', 'sensor_msgs/PointCloud', 'stereo_msgs/DisparityImage',
         'theora_image_transport/Packet', 'nav_msgs/OccupancyGrid')
GATES_STATE = 'mhri/GatesState'
# These begin with a std_msgs/Header; the stamp is read from the bytes.
STAMPED = ('nav_msgs/Odometry', 'sensor_msgs/Imu', GATES_STATE)
LISTEN_S = 0.6
# Before the deadline, for what was heard to be noted [s].
NOTE_S = 0.05
ENOUGH_SAMPLES = 25
_QUESTIONS = ('getPid', 'getPublications', 'getSubscriptions', 'getBusInfo')
_STAMP, _LENGTH = struct.Struct('<II'), struct.Struct('<I')
# The number and the stamp of a header.
_BEFORE_FRAME = 12
# As rospy and roscpp write it, and rosnode reads it: "... to [192.0.2.7:40623 on socket 6]".
_OTHER_END = re.compile(r' to \[([0-9.]+):\d+ on socket ')


class Probe:
    """Asks nodes, each on a thread of its own, until a deadline.

    :param caller_id: the name under which to ask
    :param deadline: when to be done [s, monotonic]
    :param no_return: {topic of a scan: see :class:`mhri.base.robot_types.RobotType`}
    ``unheard`` are, once there is a result, the topics to listen to for which no time was left, of
    nodes that answer.
    """

    def __init__(self, caller_id, deadline, no_return=None):
        self._caller_id = caller_id
        self._deadline = deadline
        self._no_return = no_return or {}
        self._lock = threading.Lock()
        self._threads = []
        self._nodes = {}
        self._streams = []
        self._ahead = set()
        self.unheard = ()
        self._resolved = {}
        self._asked = {}

    def ask(self, name, uri, topics=()):
        """Begin to ask a node; returns at once.

        :param topics: [(topic, type, listen)] to ask it for once it answers
        """
        host = _host_of(uri)
        with self._lock:
            self._nodes[name] = Node(name, uri, host, SILENT, 'no answer in time')
            self._asked.setdefault(host, threading.Event())
        self._start(self._run, name, uri, host, topics)

    def result(self):
        """Wait for all answers, up to the deadline.

        :returns: ({name: :class:`Node`}, [:class:`Stream`], {host name: addresses or None})
        """
        # Those that listen are begun by those that ask.
        for thread in self._threads:
            thread.join(max(0.0, self._deadline - time.monotonic()))
        with self._lock:
            self.unheard = tuple(sorted({topic for topic, _ in self._ahead}))
            return dict(self._nodes), list(self._streams), dict(self._resolved)

    def _start(self, call, *words):
        thread = threading.Thread(target=call, args=words, daemon=True)
        self._threads.append(thread)
        thread.start()

    def _left(self, least_s=0.05):
        return max(least_s, self._deadline - time.monotonic())

    def _run(self, name, uri, host, topics):
        if not self._find(host):
            self._note(Node(name, uri, host, UNRESOLVED, 'unknown name'))
            return
        node = self._question(name, uri, host)
        if node.state != ANSWERS:
            self._note(node)
            return
        with self._lock:
            self._nodes[name] = node
            self._ahead.update((topic, name) for topic, _, listen in topics if listen)
        # Listening takes time: all at once, while the others are asked for.
        for topic, kind, listen in sorted(topics, key=lambda item: not item[2]):
            if listen:
                self._start(self._take, topic, kind, node, True)
            else:
                self._take(topic, kind, node, False)

    def _note(self, node):
        with self._lock:
            self._nodes[node.name] = node

    def _take(self, topic, kind, node, listen):
        stream = self._stream(topic, kind, node, listen)
        late = time.monotonic() >= self._deadline - NOTE_S
        with self._lock:
            self._streams.append(stream)
            if not late or stream.messages or stream.listened_s > LISTENED_S:
                self._ahead.discard((topic, node.name))

    def _find(self, host):
        """Look a host up once, whoever asks first; tell whether it is known."""
        if is_ipv4(host):
            return True
        with self._lock:
            first = host not in self._resolved
            if first:
                self._resolved[host] = None
        if first:
            addresses = resolve(host)
            with self._lock:
                self._resolved[host] = addresses
            self._asked[host].set()
        else:
            self._asked[host].wait(self._left())
        with self._lock:
            return bool(self._resolved[host])

    def _question(self, name, uri, host):
        """Ask a node about itself and return the :class:`Node`."""
        begun = time.monotonic()
        proxy = xmlrpc.client.ServerProxy(uri, transport=TimedTransport(self._left()))
        batch = xmlrpc.client.MultiCall(proxy)
        try:
            for question in _QUESTIONS:
                getattr(batch, question)(self._caller_id)
            try:
                answers = [_value(item) for item in batch().results]
            except xmlrpc.client.Fault:
                # A node of another library, without system.multicall.
                answers = [_value([proxy.getPid(self._caller_id)]), None, None, None]
        except ConnectionRefusedError:
            return Node(name, uri, host, REFUSED, 'refused')
        except socket.timeout:
            return Node(name, uri, host, SILENT, 'no answer in time')
        except (xmlrpc.client.Error, http.client.HTTPException, ValueError, TypeError) as error:
            return Node(name, uri, host, STRANGER, '{}: {}'.format(type(error).__name__, error))
        except OSError as error:
            # Something at the port hangs up at once: the computer is there, but no node.
            state = STRANGER if isinstance(error, ConnectionError) else SILENT
            return Node(name, uri, host, state, error.strerror or str(error))
        if answers[0] is None:
            return Node(name, uri, host, STRANGER, 'it does not know getPid')
        return Node(name, uri, host, ANSWERS, '', time.monotonic() - begun, _topics(answers[1]),
                    _topics(answers[2]), _connections(answers[3]))

    def _stream(self, topic, kind, node, listen):
        """Connect to a topic, listen for a moment if wanted, and hang up."""
        if kind in HEAVY:
            return Stream(topic, node.name, kind)
        try:
            link = RawLink(topic, node.uri, self._caller_id, self._left())
        except LinkError as error:
            return Stream(topic, node.name, kind, problem=str(error))
        try:
            fields = link.fields
            known = (topic, node.name, fields['type'], fields['md5sum'], fields['callerid'])
            if not listen:
                return Stream(*known)
            begun = time.monotonic()
            messages, samples, newest = self._listen(link, fields['type'] in STAMPED)
            return Stream(*known, listened_s=time.monotonic() - begun, messages=messages,
                          samples=tuple(samples), refused=_refused(fields, newest),
                          frames=_frames(fields, newest),
                          beams=_beams(fields, newest, self._no_return.get(topic, {})))
        finally:
            link.close()

    def _listen(self, link, stamped):
        """Return (number of messages, [(received, stamp)], newest frame) of the next moment."""
        messages, samples, newest = 0, [], b''
        end = min(time.monotonic() + LISTEN_S, self._deadline - NOTE_S)
        while len(samples) < ENOUGH_SAMPLES and not (messages and not stamped):
            ready = select.select([link], [], [], max(0.0, end - time.monotonic()))[0]
            received = time.time()
            if not ready:
                break
            try:
                frames = link.read()
            except LinkError:
                break
            messages += len(frames)
            newest = frames[-1] if frames else newest
            # Of messages that came together, only the newest was not kept waiting.
            if stamped and frames and len(frames[-1]) >= 16:
                seconds, nanoseconds = _STAMP.unpack_from(frames[-1], 8)
                if seconds:
                    samples.append((received, seconds + nanoseconds * 1e-9))
        return messages, samples, newest


def _refused(fields, frame):
    """Return what the gates refused, from a frame of their state, () for any other topic."""
    if fields['type'] != GATES_STATE or not frame:
        return ()
    # Slow to import: only if there are gates.
    import genpy
    from mhri.msg import GatesState
    if fields['md5sum'] != GatesState._md5sum:
        return ()
    try:
        state = GatesState().deserialize(frame[4:])
    except genpy.DeserializationError:
        return ()
    # Senders believed by now were refused only while still unknown.
    return tuple(line for line in state.refused
                 if line.partition(':')[0] not in (state.mux, state.operator))


def _frames(fields, frame):
    """Return the frames that a frame of odometry names, () for any other topic."""
    texts, at = [], _LENGTH.size + _BEFORE_FRAME
    for _ in range(2 if fields['type'] == 'nav_msgs/Odometry' else 0):
        if at + _LENGTH.size > len(frame):
            return ()
        begin = at + _LENGTH.size
        at = begin + _LENGTH.unpack_from(frame, at)[0]
        texts.append(frame[begin:at][:100].decode('utf-8', 'replace').lstrip('/'))
    return tuple(texts)


def _beams(fields, frame, no_return):
    """Return (beams, measured, nothing there, perhaps nothing there) of a scan, () for others."""
    if fields['type'] != 'sensor_msgs/LaserScan' or not frame:
        return ()
    # Slow to import: only if there are lasers.
    import genpy
    import numpy
    from mhri.sensors.readings import no_return_of, read_ranges
    try:
        scan = installed_class(fields['type'], fields['md5sum'])().deserialize(frame[_LENGTH.size:])
    except (MessageMissing, genpy.DeserializationError):
        return ()
    readings = read_ranges(scan.ranges, scan.range_min, scan.range_max,
                           no_return_of(no_return, scan.range_max))
    return (len(scan.ranges),) + tuple(int(beams.sum()) for beams in (
        numpy.isfinite(readings.ranges), readings.free, readings.unsure))


def _host_of(uri):
    """Return the host of a URI, '' if there is none."""
    try:
        return urlsplit(uri).hostname or ''
    except ValueError:
        return ''


def _value(item):
    """Return the value in one answer of a multicall, None if it is not "success"."""
    if not isinstance(item, list) or not isinstance(item[0], (list, tuple)):
        return None
    answer = item[0]
    return answer[2] if len(answer) == 3 and answer[0] == 1 else None


def _topics(pairs):
    """Return {topic: type} of a node's own list, None if it is not such a list."""
    try:
        return {str(name): str(kind) for name, kind in pairs}
    except (TypeError, ValueError):
        return None


def _address(text):
    """Return the IPv4 address in a node's text about a connection, '' if there is none."""
    found = _OTHER_END.search(str(text))
    return found.group(1) if found and is_ipv4(found.group(1)) else ''


def _connections(entries):
    """Return the :class:`Connection` tuple of ``getBusInfo``, None if it is unreadable."""
    try:
        return tuple(Connection(entry[2] == 'o', str(entry[4]), str(entry[1]),
                                _address(entry[6] if len(entry) > 6 else ''))
                     for entry in entries if len(entry) < 6 or entry[5])
    except (TypeError, IndexError, KeyError):
        return None
