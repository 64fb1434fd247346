# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What both sides of the link do: beat, measure the other side, pack and unpack."""
import collections
from dataclasses import replace
import os
import threading

import rospy

from mhri.base.text import tidy_text
from mhri.link.bearing import Meter
from mhri.link.carried import COMMAND, STATE
from mhri.link.frames import (
    Beat, FrameError, Newest, pack, pack_beat, PIECE, PLAIN, Thinned, unpack, unpack_beat)
from mhri.link.peer import BEAT_S, Peer
from mhri.link.pieces import Gathered
from mhri.link.robot_claims import MAX_TOPICS
from mhri.link.ros.clock import boot_clock

# Streams of the link itself; no topic begins with an underscore.
BEAT, ABOUT, CONTROL = '_beat', '_about', '_control'
# Of streams that the link has itself there are no more.
_OWN_TOPICS = 20
# So many ages of each class are kept for the diagnostics.
_AGES = 2000
# Over so long they are told [s].
_TOLD_S = 10.0


def per_s(rows, now):
    """Return the thousands of bytes a second in (when [s], bytes), of the last while."""
    rows = [row for row in rows if now - row[0] < _TOLD_S]
    # As many as are kept may be less than the while.
    took_s = now - rows[0][0] if len(rows) > _AGES // 2 else _TOLD_S
    return 1e-3 * sum(size for _, size in rows) / max(took_s, 0.1)


class Side:
    """One side of a robot's link.

    :param name: the robot
    :param carrier: :class:`mhri.link.ros.carrier.Between`
    :param way: the way that this side sends, ``up`` or ``down``
    """

    def __init__(self, name, carrier, way, clock=boot_clock):
        self.name = name
        self.clock = clock
        self.peer = Peer()
        self.lock = threading.RLock()
        # Set to beat at once, or to work at once.
        self.to_say, self.to_do = threading.Event(), threading.Event()
        self.refused = 0
        # Said in each beat: what this side sends less of.
        self.thinned = Thinned()
        self._carrier = carrier
        self._way = way
        self._session = int.from_bytes(os.urandom(4), 'big')
        self._senders = {}
        self._numbers = collections.Counter()
        self._newest = collections.defaultdict(Newest)
        self._gathered = collections.defaultdict(Gathered)
        self.meter = Meter()
        self._ages = {}
        # {class: (when, bytes) of what was sent}
        self._sent = collections.defaultdict(lambda: collections.deque(maxlen=_AGES))
        self._was_heard = False
        self._ended = threading.Event()

    def start(self):
        """Begin to listen and to beat; returns at once."""
        self._carrier.listen('up' if self._way == 'down' else 'down', self._hear)
        # Not in one thread: a master that hangs holds up the work, and must not hold up the beats.
        for tick, asked in ((self._beat, self.to_say), (self.work, self.to_do)):
            threading.Thread(target=self._run, args=(tick, asked), name='link',
                             daemon=True).start()
        return self

    def send(self, topic, urgency, body, make=None, held_s=0.0, kind=PLAIN):
        """Send a message of a stream now, or drop it.

        :param held_s: how old it is already [s]
        :param make: called with the number of the message, returns what is sent instead of ``body``
        :param kind: how it is packed, see :mod:`mhri.link.frames`
        :returns: of how many bytes it was
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

    def _hear(self, topic, data):
        """Take in a message (on zenoh's thread)."""
        now = self.clock()
        try:
            frame = unpack(data)
            with self.lock:
                if not self._newest_of(topic).takes(frame):
                    return
                self.meter.note(topic, frame, len(data), now)
                if frame.kind == PIECE:
                    whole = self._gathered[topic].add(frame.body)
                    if whole is None:
                        return
                    frame = replace(frame, stamp_s=whole.stamp_s, body=whole.body)
                if topic == BEAT:
                    self._on_beat(frame, now)
                else:
                    self.on_frame(topic, frame, now)
        except ValueError as error:
            self.refused += 1
            rospy.logwarn_throttle(1.0, '{}: refused a message of {}: {}'.format(
                self.name, tidy_text(topic, 60), tidy_text(str(error))))
        except rospy.ROSException:
            # The topics are closed while the node is being ended.
            if not self.ended():
                raise

    def _newest_of(self, topic):
        if topic not in self._newest and len(self._newest) >= MAX_TOPICS + _OWN_TOPICS:
            raise FrameError('too many topics')
        return self._newest[topic]

    def _on_beat(self, frame, now):
        beat = unpack_beat(frame.body)
        self.peer.on_beat(frame, beat, now)
        self.on_peer(beat, now)

    def note_age(self, urgency, frame, now):
        """Return the age of a message [s], None if unknown, and keep it for the diagnostics."""
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
            status.summary(*((status.OK, 'linked') if self.peer.heard(now) else
                             (status.WARN, self.unheard(silence_s))))
            heard = self.meter.read(now)
            status.add('round trip [ms]', '{:.1f}'.format(1000.0 * self.peer.round_trip_s()))
            status.add('beats lost [%]', '{:.0f}'.format(100.0 * self.peer.loss()))
            status.add('lost on the way here [%]', '{:.0f}'.format(100.0 * heard.loss))
            status.add('waits on the way here [ms]', '{:.0f}'.format(1000.0 * heard.queue_s))
            status.add('the radio bears [kB/s]', '{:.1f}'.format(1e-3 * less.bytes_per_s)
                       if less.bytes_per_s else 'everything')
            status.add('refused', self.refused)
            for urgency, sent in sorted(self._sent.items()):
                status.add('{} sent [kB/s]'.format(urgency), '{:.1f}'.format(per_s(sent, now)))
            for urgency, came in sorted(self._ages.items()):
                status.add('{} came [kB/s]'.format(urgency), '{:.1f}'.format(
                    per_s([(at, size) for at, _, size in came], now)))
        for urgency, ages in sorted(self.ages().items()):
            if ages:
                status.add('age of {} [ms]'.format(urgency), '{:.1f} median, {:.1f} most'.format(
                    1000.0 * ages[len(ages) // 2], 1000.0 * ages[-1]))
        return status

    def ages(self):
        """Return {class: sorted ages [s] of the last 10 s} of what came in."""
        with self.lock:
            now = self.clock()
            return {urgency: sorted(age_s for at, age_s, _ in ages if now - at < _TOLD_S)
                    for urgency, ages in self._ages.items()}

    def ended(self):
        """Tell whether this side, or the node, is over."""
        return self._ended.is_set() or rospy.is_shutdown()

    def _run(self, tick, asked):
        while not self.ended():
            asked.wait(0.75 * BEAT_S)
            asked.clear()
            try:
                tick(self.clock())
            except Exception as error:  # without this thread the link would be dead
                if not self.ended():
                    rospy.logerr_throttle(1.0, '{}: the link failed: {!r}'.format(self.name, error))

    def _beat(self, now):
        with self.lock:
            heard = self.peer.heard(now)
            if heard != self._was_heard:
                self._was_heard = heard
                (rospy.loginfo if heard else rospy.logwarn)(
                    '%s: the other side of the link is %s', self.name,
                    'there' if heard else 'not heard any more')
            self.send(BEAT, COMMAND, pack_beat(
                Beat(self.peer.echo(now), *self.said(), self.meter.read(now), self.thinned)))

    def send_about(self, body):
        """Send what the robot says of itself."""
        self.send(ABOUT, STATE, body)

    def on_peer(self, beat, now):
        """Take in what the other side's beat says; under the lock."""
        raise NotImplementedError

    def on_frame(self, topic, frame, now):
        """Take in a message of a stream; under the lock."""
        raise NotImplementedError

    def less(self):
        """Return what the robot's side sends less of; under the lock."""
        return self.thinned

    def unheard(self, silence_s):
        """Return in words that the other side is not heard, for so long [s]."""
        raise NotImplementedError

    def said(self):
        """Return (about, wanted) of the next beat; under the lock."""
        raise NotImplementedError

    def work(self, now):
        """Do what takes a while: without the lock, and on a thread of its own."""
        raise NotImplementedError
