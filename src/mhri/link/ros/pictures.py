# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Sends pictures over a slow radio: only the newest, reduced in size, and in pieces."""
import threading
import time

import rospy

from mhri.link.pieces import split
from mhri.link.shares import Flow, Share
from mhri.link.picture_shrinker import KIND, PictureShrinker

# Period of checking for due pictures [s].
IDLE_S = 0.2


class Pictures:
    """Sends the newest picture of each stream in turn, on its own thread.

    Pieces are sent at the pace of the share, so that other messages do not wait behind a picture.

    :param send: called with (stream, piece); returns whether to continue the stream
    :param rename: called with (bytes, number of names in it); returns the bytes to send
    """

    def __init__(self, clock, send, rename):
        self._clock = clock
        self._send = send
        self._rename = rename
        self._lock = threading.Lock()
        self._news = threading.Event()
        self._waiting = {}
        self._shares = {}
        self._due = {}
        self._smaller = {}
        self._flows = {}
        self._number = 0
        self._ended = False
        threading.Thread(target=self._run, name='pictures', daemon=True).start()

    def share(self, shares):
        """Set the shares, {topic: :class:`mhri.link.shares.Share`}."""
        with self._lock:
            self._shares = shares

    def offer(self, stream, kind, data, names):
        """Queue a picture; it replaces a waiting one of the same stream."""
        with self._lock:
            self._waiting[stream.topic] = (stream, kind, data, names, self._clock())
        self._news.set()

    def waits(self):
        """Return whether a picture is waiting."""
        with self._lock:
            return bool(self._waiting)

    def close(self):
        """Stop sending."""
        self._ended = True

    def forget(self):
        """Drop the waiting pictures."""
        with self._lock:
            self._waiting.clear()

    def _take(self, now):
        """Return (picture, its share) of the first due picture, or None."""
        with self._lock:
            due = [topic for topic in self._waiting if self._due.get(topic, 0.0) <= now
                   and self._share(topic).hz]
            if not due:
                return None
            topic = min(due, key=lambda topic: self._due.get(topic, 0.0))
            return self._waiting.pop(topic), self._share(topic)

    def _share(self, topic):
        return self._shares.get(topic, Share(1.0))

    def _run(self):
        while not (self._ended or rospy.is_shutdown()):
            found = self._take(self._clock())
            if found is None:
                self._news.wait(IDLE_S)
                self._news.clear()
                # A waiting picture may not be due yet.
                time.sleep(0.01)
                continue
            try:
                self._go(*found)
            except Exception as error:  # this thread must not end: it sends all pictures
                rospy.logwarn_throttle(10.0, 'a picture is not sent: {!r}'.format(error))

    def _go(self, picture, share):
        stream, kind, data, names, taken_at = picture
        if kind == KIND:
            smaller = self._smaller.setdefault(stream.topic, PictureShrinker())
            data = smaller.fit(data, share.size)
        self._number += 1
        pieces = split(self._number, taken_at, self._rename(data, names, self._number),
                       share.group)
        begun, sent = self._clock(), 0
        self._count(stream, begun)
        for piece in pieces:
            if not self._send(stream, piece):
                return
            sent += len(piece)
            time.sleep(max(0.0, begun + sent / share.pace - self._clock()))
        with self._lock:
            least_s = 1.0 / stream.rate_hz if stream.rate_hz else 0.0
            self._due[stream.topic] = begun + max(sent / share.bytes_per_s, least_s)

    def _count(self, stream, now):
        with self._lock:
            self._flows.setdefault(stream.topic, Flow(stream)).came(now)

    def most_hz(self):
        """Return the highest rate of pictures of a stream [Hz]."""
        with self._lock:
            return max((flow.hz(self._clock()) for flow in self._flows.values()), default=0.0)
