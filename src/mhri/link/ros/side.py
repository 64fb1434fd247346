# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The common part of both sides of the link: beats, measurements, packing and unpacking."""
import collections
from dataclasses import replace
import math
import os
import threading

import rospy

from mhri.base.text import tidy_text
from mhri.link.carried import COMMAND
from mhri.link.frames import (
    Beat, FrameError, pack, pack_beat, PIECE, PLAIN, Thinned, unpack, unpack_beat)
from mhri.link.peer import BEAT_S, GONE_S, Peer
from mhri.link.pieces import PieceAssembler
from mhri.link.rate_estimator import Meter
from mhri.link.robot_claims import MAX_TOPICS
from mhri.link.ros.clock import boot_clock

# Streams of the link itself; no topic begins with an underscore.
BEAT, ABOUT, CONTROL = '_beat', '_about', '_control'
# Maximum number of streams of the link itself.
_OWN_TOPICS = 20
# Number of ages of each class kept for the diagnostics.
_AGES = 2000
# Window of the diagnostics [s].
_WINDOW_S = 10.0


def per_s(rows, now):
    """Return the recent rate [kB/s] of rows (time [s], bytes)."""
    rows = [row for row in rows if now - row[0] < _WINDOW_S]
    # A full list may cover less than the window.
    took_s = now - rows[0][0] if len(rows) > _AGES // 2 else _WINDOW_S
    return 1e-3 * sum(size for _, size in rows) / max(took_s, 0.1)


class Side:
    """One side of a robot's link.

    :param name: the robot
    :param carrier: :class:`mhri.link.ros.carrier.Between`
    :param way: direction of sending, ``up`` or ``down``
    """

    def __init__(self, name, carrier, way, clock=boot_clock):
        self.name = name
        self.clock = clock
        self.peer = Peer()
        self.lock = threading.RLock()
        # Set to trigger a beat, or the work, at once.
        self.to_say, self.to_do = threading.Event(), threading.Event()
        self.refused = 0
        # The reductions by this side, sent in each beat.
        self.thinned = Thinned()
        self._carrier = carrier
        self._way = way
        self._session = int.from_bytes(os.urandom(4), 'big')
        self._senders = {}
        self._numbers = collections.Counter()
        # Number of the newest message of each stream of the other side's session.
        self._newest = {}
        # When beats of a second program of a name began to come, and when the last one came.
        self._second_since = self._second_at = -math.inf
        self._assemblers = collections.defaultdict(PieceAssembler)
        self.meter = Meter()
        self._ages = {}
        # {class: (time, bytes) of sent messages}
        self._sent = collections.defaultdict(lambda: collections.deque(maxlen=_AGES))
        self._was_live = self._had_second = False
        self._ended = threading.Event()

    def start(self):
        """Start listening and sending beats, on threads."""
        self._carrier.listen('up' if self._way == 'down' else 'down', self._on_data)
        # Two threads, since a hanging master blocks the work, but must not block the beats.
        for tick, asked in ((self._beat, self.to_say), (self.work, self.to_do)):
            threading.Thread(target=self._run, args=(tick, asked), name='link',
                             daemon=True).start()
        return self

    def send(self, topic, urgency, body, make=None, held_s=0.0, kind=PLAIN):
        """Send a message of a stream at once, or drop it.

        :param held_s: its present age [s]
        :param make: called with the number of the message, returns the body to send instead
        :param kind: packing, see :mod:`mhri.link.frames`
        :returns: its size [bytes]
        """
        with self.lock:
            now = self.clock()
            sender = self._senders.get(topic)
            if sender is None:
                sender = self._senders[topic] = self._carrier.sender(self._way, topic, urgency)
            self._numbers[topic] += 1
            number = self._numbers[topic]
            data = pack(self._session, number, now - held_s, make(number) if make else body, kind)
            sender(data)
            self._sent[urgency].append((now, len(data)))
            return len(data)

    def _on_data(self, topic, data):
        """Handle a message (on zenoh's thread)."""
        now = self.clock()
        try:
            frame = unpack(data)
            with self.lock:
                beat = unpack_beat(frame.body) if topic == BEAT else None
                if not self._takes(topic, frame, beat, now):
                    return
                self.meter.note(topic, frame, len(data), now)
                if beat is not None:
                    self.peer.on_beat(frame, beat, now)
                    self.on_peer(beat, now)
                    return
                if frame.kind == PIECE:
                    whole = self._assemblers[topic].add(frame.body)
                    if whole is None:
                        return
                    frame = replace(frame, stamp_s=whole.stamp_s, body=whole.body)
                self.on_frame(topic, frame, now)
        except ValueError as error:
            self.refused += 1
            rospy.logwarn_throttle(1.0, '{}: refused a message of {}: {}'.format(
                self.name, tidy_text(topic, 60), tidy_text(str(error))))
        except rospy.ROSException:
            # Topics are closed during the shutdown of the node.
            if not self.ended():
                raise

    def _takes(self, topic, frame, beat, now):
        """Return whether a message is newer, and of the program that this side is linked with."""
        if beat is not None and not (beat.to in (None, self._session)
                                     and self.peer.admits(frame.session, now)):
            if now - self._second_at > GONE_S:
                self._second_since = now
            self._second_at = now
            return False
        if frame.session != self.peer.session:
            if beat is None:
                return False
            self._newest.clear()
            self._assemblers.clear()
        if topic not in self._newest and len(self._newest) >= MAX_TOPICS + _OWN_TOPICS:
            raise FrameError('too many topics')
        if frame.number <= self._newest.get(topic, -1):
            return False
        self._newest[topic] = frame.number
        return True

    def has_second(self, now):
        """Return whether a second program has the name of one that is linked; under the lock.

        One that replaces the first is refused for as long as that may only be silent.
        """
        return now - self._second_at <= GONE_S and now - self._second_since > 1.5 * GONE_S

    def note_age(self, urgency, frame, now):
        """Return the age of a message [s], None if unknown; record it for the diagnostics."""
        age_s = self.peer.age_s(frame, now)
        if age_s is not None:
            self._ages.setdefault(urgency, collections.deque(maxlen=_AGES)).append(
                (now, age_s, len(frame.body)))
        return age_s

    def fill(self, status):
        """Fill a ``DiagnosticStatusWrapper`` with the figures of the link."""
        with self.lock:
            now, less = self.clock(), self.less()
            silence_s = self.peer.silence_s(now)
            status.summary(*(
                (status.WARN, self.second_text()) if self.has_second(now) else
                (status.OK, 'linked') if self.peer.is_live(now) else
                (status.WARN, self.silence_text(silence_s))))
            stats = self.meter.read(now)
            status.add('round trip [ms]', '{:.1f}'.format(1000.0 * self.peer.round_trip_s()))
            status.add('beats lost [%]', '{:.0f}'.format(100.0 * self.peer.loss()))
            status.add('lost on the way here [%]', '{:.0f}'.format(100.0 * stats.loss))
            status.add('queuing on the way here [ms]', '{:.0f}'.format(1000.0 * stats.queue_s))
            status.add('the radio carries [kB/s]', '{:.1f}'.format(1e-3 * less.bytes_per_s)
                       if less.bytes_per_s else 'everything')
            status.add('refused', self.refused)
            for urgency, sent in sorted(self._sent.items()):
                status.add('{} sent [kB/s]'.format(urgency), '{:.1f}'.format(per_s(sent, now)))
            for urgency, came in sorted(self._ages.items()):
                status.add('{} came [kB/s]'.format(urgency), '{:.1f}'.format(
                    per_s([(at, size) for at, _, size in came], now)))
        for urgency, ages in sorted(self.ages().items()):
            if ages:
                status.add('age of {} [ms]'.format(urgency), '{:.1f} median, {:.1f} maximum'.format(
                    1000.0 * ages[len(ages) // 2], 1000.0 * ages[-1]))
        return status

    def ages(self):
        """Return {class: sorted ages [s] of messages received in the last 10 s}."""
        with self.lock:
            now = self.clock()
            return {urgency: sorted(age_s for at, age_s, _ in ages if now - at < _WINDOW_S)
                    for urgency, ages in self._ages.items()}

    def ended(self):
        """Return whether this side, or the node, has ended."""
        return self._ended.is_set() or rospy.is_shutdown()

    def _run(self, tick, asked):
        while not self.ended():
            asked.wait(0.75 * BEAT_S)
            asked.clear()
            try:
                tick(self.clock())
            except Exception as error:  # this thread must not end: it is the link
                if not self.ended():
                    rospy.logerr_throttle(1.0, '{}: the link failed: {!r}'.format(self.name, error))

    def _beat(self, now):
        with self.lock:
            live = self.peer.is_live(now)
            if live != self._was_live:
                self._was_live = live
                (rospy.loginfo if live else rospy.logwarn)(
                    '%s: the other side of the link is %s', self.name,
                    'connected' if live else 'silent')
            self.send(BEAT, COMMAND, pack_beat(
                Beat(self.peer.echo(now), *self.said(), self.meter.read(now), self.thinned,
                     self.peer.session)))
            second = self.has_second(now)
            if second and not self._had_second:
                rospy.logwarn('%s: %s', self.name, self.second_text())
            self._had_second = second

    def on_peer(self, beat, now):
        """Handle a beat of the other side; under the lock."""
        raise NotImplementedError

    def on_frame(self, topic, frame, now):
        """Handle a message of a stream; under the lock."""
        raise NotImplementedError

    def less(self):
        """Return the reductions of the robot side; under the lock."""
        return self.thinned

    def silence_text(self, silence_s):
        """Describe the silence of the other side [s]."""
        raise NotImplementedError

    def second_text(self):
        """Describe that a second program has the name of one that is linked."""
        raise NotImplementedError

    def said(self):
        """Return (about, requested) of the next beat; under the lock."""
        raise NotImplementedError

    def work(self, now):
        """Do blocking work: without the lock, and on its own thread."""
        raise NotImplementedError
