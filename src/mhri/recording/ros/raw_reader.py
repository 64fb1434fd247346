# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Reads every publisher of some topics on one thread, as bytes, in order of arrival."""
import logging
import os
import select
import threading

from mhri.recording.ros.raw_link import LinkError, RawLink

_LOG = logging.getLogger(__name__)


class RawReader:
    """The connections of a recording.

    Separate threads make the connections, so that an address that does not answer blocks nothing;
    a broken connection is renewed as long as its publisher is on the graph.

    :param caller_id: the name under which to connect
    :param on_frame: called on the reading thread with (link, frame) for each message, in order
    :param on_turn: called after each turn of reading; returns the time until its next call [s],
        None for "with the next message"
    :param on_end: called on the reading thread when everything received is read
    """

    def __init__(self, caller_id, on_frame, on_turn, on_end):
        self._caller_id = caller_id
        self._on_frame = on_frame
        self._on_turn = on_turn
        self._on_end = on_end
        self._lock = threading.Lock()
        self._wanted = {}
        self._tried = set()
        self._fresh = []
        self._links = {}
        self._left = set()
        self._stopping = False
        self._poll = select.epoll()
        self._wake_read, self._wake_write = os.pipe2(os.O_NONBLOCK | os.O_CLOEXEC)
        self._poll.register(self._wake_read, select.EPOLLIN)

    def start(self):
        """Start reading."""
        threading.Thread(target=self._run, name='raw_reader', daemon=True).start()

    def connect(self, topic, uris):
        """Connect to the publishers of a topic that are not connected yet; return at once.

        Connections to publishers that are gone are not closed: their last messages may still be on
        the way, and the publishers close them.
        """
        with self._lock:
            if self._stopping:
                return
            self._wanted[topic] = frozenset(uris)
            fresh = [(topic, uri) for uri in uris if (topic, uri) not in self._tried]
            self._tried.update(fresh)
        for key in fresh:
            threading.Thread(target=self._connect, args=key, name='raw_connect',
                             daemon=True).start()

    def leave(self, topics):
        """Close the connections to all publishers of some topics; return at once."""
        with self._lock:
            for topic in topics:
                self._wanted.pop(topic, None)
            self._left.update(topics)
            if not self._stopping:
                os.write(self._wake_write, b'x')

    def stop(self):
        """Stop after reading the pending messages; return at once."""
        with self._lock:
            if self._stopping:
                return
            self._stopping = True
            os.write(self._wake_write, b'x')

    def _connect(self, topic, uri):
        try:
            link = RawLink(topic, uri, self._caller_id)
        except LinkError as error:
            _LOG.debug('not connected: %s', error)
            with self._lock:
                self._tried.discard((topic, uri))
            return
        with self._lock:
            if not self._stopping:
                self._fresh.append(link)
                os.write(self._wake_write, b'x')
                return
        link.close()

    def _run(self):
        try:
            self._read_until_stopped()
        except Exception:  # the guard of this thread: the recording ends with the messages so far
            _LOG.exception('the reading of %s ends', self._caller_id)
        with self._lock:
            self._stopping = True
            fresh, self._fresh = self._fresh, []
        for link in list(self._links.values()) + fresh:
            link.close()
        self._poll.close()
        os.close(self._wake_read)
        os.close(self._wake_write)
        self._on_end()

    def _read_until_stopped(self):
        poll, links, on_frame = self._poll.poll, self._links, self._on_frame
        wait_s = None
        while True:
            for number, _ in poll(wait_s):
                link = links.get(number)
                if link is None:
                    if self._woken():
                        return
                    continue
                try:
                    for frame in link.read():
                        on_frame(link, frame)
                except LinkError as error:
                    self._drop(number, link, error)
            wait_s = self._on_turn()

    def _woken(self):
        """Handle new connections; return whether to stop."""
        os.read(self._wake_read, 4096)
        with self._lock:
            fresh, self._fresh = self._fresh, []
            left, self._left = self._left, set()
            stopping = self._stopping
        for number, link in list(self._links.items()) if left else ():
            if link.key[0] in left:
                self._drop(number, link, 'left')
        for link in fresh:
            self._links[link.fileno()] = link
            self._read_all(link)
            self._poll.register(link.fileno(), select.EPOLLIN)
        if stopping:
            for link in self._links.values():
                self._read_all(link)
        return stopping

    def _read_all(self, link):
        for frame in link.read_all():
            self._on_frame(link, frame)

    def _drop(self, number, link, error):
        _LOG.debug('%s', error)
        self._poll.unregister(number)
        del self._links[number]
        link.close()
        topic, uri = link.key
        with self._lock:
            self._tried.discard(link.key)
            again = self._wanted.get(topic, ())
        if uri in again:
            self.connect(topic, again)
