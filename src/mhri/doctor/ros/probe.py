# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Queries all nodes in parallel, each on its own thread, and subscribes to their topics.

Nothing is registered at the master. A topic is requested as by a subscriber, and closed soon after;
pictures and point clouds are skipped, since a driver may start its sensor for them.
"""
import re
import socket
import threading
import time
from urllib.parse import urlsplit
import xmlrpc.client

from mhri.base.wire import Wire
from mhri.doctor.facts import (
    ANSWERS, Connection, is_ipv4, LISTENED_S, Node, REFUSED, SILENT, STRANGER, Stream, UNRESOLVED)
from mhri.doctor.ros.host import resolve
from mhri.graph.ros.master_api import ERRORS, TimedTransport
from mhri.graph.ros.messages import installed_class, MessageMissing
from mhri.recording.ros.raw_link import LinkError, RawLink

# Never subscribed: that would start a camera, or transfer megabytes.
HEAVY = ('sensor_msgs/Image', 'sensor_msgs/CompressedImage', 'sensor_msgs/CameraInfo',
         'sensor_msgs/PointCloud2', 'sensor_msgs/PointCloud', 'stereo_msgs/DisparityImage',
         'theora_image_transport/Packet', 'nav_msgs/OccupancyGrid')
DRIVE_STATE = 'mhri/DriveState'
# Messages that begin with a std_msgs/Header; the stamp is read from the bytes.
STAMPED = ('nav_msgs/Odometry', 'sensor_msgs/Imu', DRIVE_STATE)
LISTEN_S = 0.6
# Time before the deadline in which the messages received are recorded [s].
NOTE_S = 0.05
ENOUGH_SAMPLES = 25
_QUESTIONS = ('getPid', 'getPublications', 'getSubscriptions', 'getBusInfo')
# The format of rospy and roscpp, also parsed by rosnode: "... to [192.0.2.7:40623 on socket 6]".
_OTHER_END = re.compile(r' to \[([0-9.]+):\d+ on socket ')


def state_of(error):
    """Return the state of an address by the error of a call to it."""
    if isinstance(error, ConnectionRefusedError):
        return REFUSED
    # A program that hangs up at once is not a node.
    hangs_up = isinstance(error, ConnectionError) or not isinstance(error, OSError)
    return STRANGER if hangs_up else SILENT


class Probe:
    """Queries nodes, each on a thread of its own, until a deadline.

    :param caller_id: the caller id of the queries
    :param deadline: end of all queries [s, monotonic]
    :param no_return: {topic of a scan: see :class:`mhri.base.robot_types.RobotType`}
    ``unheard`` are, after :meth:`result`, the topics of responding nodes for which there was no
    time to listen.
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
        """Start the query of a node; return at once.

        :param topics: [(topic, type, listen)] to request once it has responded
        """
        host = _host_of(uri)
        with self._lock:
            self._nodes[name] = Node(name, uri, host, SILENT, 'no answer in time')
            self._asked.setdefault(host, threading.Event())
        self._start(self._run, name, uri, host, topics)

    def result(self):
        """Wait for all responses, up to the deadline.

        :returns: ({name: :class:`Node`}, [:class:`Stream`], {host name: addresses or None})
        """
        # Threads that query start further ones that listen.
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
        # Listening takes time: start it first, in parallel with the requests of the others.
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
        """Resolve a host once, on the first call; return whether its name is known."""
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
        """Query a node, and return the :class:`Node`."""
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
        except (*ERRORS, ValueError, TypeError) as error:
            said = getattr(error, 'strerror', None) or '{}: {}'.format(type(error).__name__, error)
            return Node(name, uri, host, state_of(error),
                        'no answer in time' if isinstance(error, socket.timeout) else said)
        if answers[0] is None:
            return Node(name, uri, host, STRANGER, 'it does not know getPid')
        return Node(name, uri, host, ANSWERS, '', time.monotonic() - begun, _topics(answers[1]),
                    _topics(answers[2]), _connections(answers[3]))

    def _stream(self, topic, kind, node, listen):
        """Connect to a topic, listen for a moment if requested, and disconnect."""
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
        """Listen; return (number of messages, [(received, stamp)], newest frame)."""
        messages, samples, newest = 0, [], b''
        end = min(time.monotonic() + LISTEN_S, self._deadline - NOTE_S)
        while len(samples) < ENOUGH_SAMPLES and not (messages and not stamped):
            try:
                frames = link.wait(end - time.monotonic())
            except LinkError:
                break
            received = time.time()
            if not frames and time.monotonic() >= end:
                break
            messages += len(frames)
            newest = frames[-1] if frames else newest
            # Of messages received together, only the newest was not delayed.
            if stamped and frames and len(frames[-1]) >= 16:
                _, stamp_s = Wire('header', frames[-1][4:]).header()
                if stamp_s >= 1.0:
                    samples.append((received, stamp_s))
        return messages, samples, newest


def _message(fields, frame, kind):
    """Return the message of a frame, None if it is of another type, or of another version."""
    if fields['type'] != kind or not frame:
        return None
    # Imported late since it is slow: only if there is such a topic.
    import genpy
    try:
        return installed_class(kind, fields['md5sum'])().deserialize(frame[4:])
    except (MessageMissing, genpy.DeserializationError):
        return None


def _refused(fields, frame):
    """Return the refusals in a frame of the mux's state, () for any other topic."""
    state = _message(fields, frame, DRIVE_STATE)
    # The operator was only refused before it took control.
    return () if state is None else tuple(
        line for line in state.refused if line.partition(':')[0] != state.operator)


def _frames(fields, frame):
    """Return the frame ids in a message of odometry, () for any other topic."""
    message = _message(fields, frame, 'nav_msgs/Odometry')
    return () if message is None else tuple(
        text[:100].lstrip('/') for text in (message.header.frame_id, message.child_frame_id))


def _beams(fields, frame, no_return):
    """Return the number of (all, measured, free, ambiguous) beams of a scan, () for others."""
    scan = _message(fields, frame, 'sensor_msgs/LaserScan')
    if scan is None:
        return ()
    # Imported late since it is slow: only if there are lasers.
    import numpy
    from mhri.sensors.readings import no_return_of, read_ranges
    readings = read_ranges(scan.ranges, scan.range_min, scan.range_max,
                           no_return_of(no_return, scan.range_max))
    return (len(scan.ranges),) + tuple(int(beams.sum()) for beams in (
        numpy.isfinite(readings.ranges), readings.free, readings.unsure))


def _host_of(uri):
    """Return the host of a URI, '' without one."""
    try:
        return urlsplit(uri).hostname or ''
    except ValueError:
        return ''


def _value(item):
    """Return the value in one response of a multicall, None without success."""
    if not isinstance(item, list) or not isinstance(item[0], (list, tuple)):
        return None
    answer = item[0]
    return answer[2] if len(answer) == 3 and answer[0] == 1 else None


def _topics(pairs):
    """Return {topic: type} of a node's own list, None if it is malformed."""
    try:
        return {str(name): str(kind) for name, kind in pairs}
    except (TypeError, ValueError):
        return None


def _address(text):
    """Return the IPv4 address in a node's text about a connection, '' without one."""
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
