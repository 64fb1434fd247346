# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A slow network in one process: a TCP relay that delays every byte.

A node behind it is registered at the master under the relay's address; the relay also rewrites the
answer to ``requestTopic``, so that the streams come through it, too.
"""
import heapq
import re
import socket
import threading
import time

import rosgraph

from support.ros_system import wait_for


class Relay:
    """Relays connections to one address.

    :param target: (host, port)
    :param rewrite: function from (bytes, this relay) to bytes, for what comes from the target
    :param delays: the :class:`Delay` of the network
    """

    def __init__(self, target, delays, rewrite=lambda data, relay: data):
        self._target = target
        self._delays = delays
        self._rewrite = rewrite
        self._listener = socket.create_server(('127.0.0.1', 0))
        self.port = self._listener.getsockname()[1]
        threading.Thread(target=self._accept, daemon=True).start()

    def _accept(self):
        while True:
            try:
                near, _ = self._listener.accept()
                far = socket.create_connection(self._target)
            except OSError:
                return
            for source, sink, rewrite in ((near, far, None), (far, near, self._rewrite)):
                for one in (source, sink):
                    one.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
                threading.Thread(target=self._pump, args=(source, sink, rewrite),
                                 daemon=True).start()

    def _pump(self, source, sink, rewrite):
        """Carry bytes one way until either end is closed."""
        line = self._delays.line(sink)
        while True:
            try:
                data = source.recv(65536)
            except OSError:
                data = b''
            if data and rewrite is not None:
                data = rewrite(data, self)
            line.put(data)
            if not data:
                return


class Delay:
    """One clock for all lines of a network.

    :param one_way_s: how long a byte is on its way; may be changed at any time
    """

    def __init__(self, one_way_s=0.0):
        self.one_way_s = one_way_s

    def line(self, sink):
        """Return a line to a socket."""
        return _Line(self, sink)


class _Line:
    """Bytes on their way to one socket, in order."""

    def __init__(self, delay, sink):
        self._delay = delay
        self._sink = sink
        self._queue = []
        self._count = 0
        self._changed = threading.Condition()
        threading.Thread(target=self._run, daemon=True).start()

    def put(self, data):
        """Send; nothing at all closes the other end."""
        with self._changed:
            self._count += 1
            heapq.heappush(self._queue, (time.monotonic() + self._delay.one_way_s, self._count,
                                         data))
            self._changed.notify()

    def _run(self):
        while True:
            with self._changed:
                while not self._queue:
                    self._changed.wait()
                due, _, data = self._queue[0]
                left = due - time.monotonic()
                if left > 0.0:
                    self._changed.wait(left)
                    continue
                heapq.heappop(self._queue)
            try:
                if not data:
                    self._sink.shutdown(socket.SHUT_WR)
                    return
                self._sink.sendall(data)
            except OSError:
                return


class SlowNode:
    """Puts a network in front of a node that runs already: calls and streams come through it.

    :param uri: the node's own XML-RPC address
    """

    def __init__(self, uri, delay):
        self._delay = delay
        self._streams = {}
        host, port = re.match(r'http://([^:/]+):(\d+)', uri).groups()
        self._relay = Relay((host, int(port)), delay, self._rewrite)
        self.uri = 'http://127.0.0.1:{}/'.format(self._relay.port)

    def _rewrite(self, data, _):
        """Lead the streams through the network, too: replace the port in requestTopic's answer."""
        match = re.search(rb'TCPROS</string></value>\s*<value><string>([^<]+)</string></value>\s*'
                          rb'<value><int>(\d+)</int>', data)
        if match is None:
            return data
        port = int(match.group(2))
        if port not in self._streams:
            self._streams[port] = Relay((match.group(1).decode(), port), self._delay)
        new = str(self._streams[port].port).encode()
        if len(new) != len(match.group(2)):
            raise RuntimeError('a port with another number of digits: the length would be wrong')
        return data[:match.start(2)] + new + data[match.end(2):]


def move_away(delay, topic, kind, caller, patience_s=60.0):
    """Put the node that publishes a topic behind a network, once it is there."""
    master = rosgraph.Master(caller)
    wait_for(lambda: topic in dict(master.getSystemState()[0]), patience_s, 'the robot')
    node = dict(master.getSystemState()[0])[topic][0]
    uri = master.lookupNode(node)
    slow = SlowNode(uri, delay)
    rosgraph.Master(node).unregisterPublisher(topic, uri)
    rosgraph.Master('/slow' + topic.replace('/', '_')).registerPublisher(topic, kind, slow.uri)
