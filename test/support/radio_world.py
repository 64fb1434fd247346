# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Linked robots that share a bad radio, in simulated time: nothing here depends on the computer.

The radio is that of ``radio.py``; what each robot sends is decided by ``link/``, as in
``link/ros``. Sizes and rates are those of ``bench_radio`` with simulated robots.
"""
import collections
import math
import random

from mhri.link.carried import COMMAND, GUARD_ECHO, Pace, PICTURE, STATE, Stream
from mhri.link.frames import Frame
from mhri.link.pieces import PieceAssembler, split
from mhri.link.rate_estimator import AROUND_BYTES, RateEstimator, Meter
from mhri.link.shares import Flow, Share, shares
from support.radio import Channel, read_table, Table

STEP_S, BEAT_S, STICK_S, SHOW_S = 0.002, 0.15, 0.05, 1.0 / 30.0
HEAD_BYTES, BEAT_BYTES, COMMAND_BYTES, PACKET_BYTES = 24, 170, 240, 1460
# Clocks of robots are not those of the host [s].
ELSEWHEN_S = 77.0
# Stream, how often it comes [Hz], and bytes of a message as it is and packed.
ODOMETRY, CAMERA = 'odom', 'camera'
STREAMS = ((Stream(GUARD_ECHO, COMMAND), 20.0, 115, 115),
           (Stream(ODOMETRY, STATE, 50.0, min_hz=8.0), 50.0, 740, 185),
           (Stream('imu', STATE, 100.0, weight=0.7), 100.0, 345, 166),
           (Stream('scan', STATE, 10.0, weight=0.2), 10.0, 5800, 1420),
           (Stream(CAMERA, PICTURE, 30.0), 30.0, 26000, 26000))


class Packet(bytes):
    """What goes over the radio; only its length is really there."""

    said = None


def packet(size, said):
    """Return a packet of so many bytes."""
    found = Packet(size)
    found.said = said
    return found


class Sender:
    """The robot's side."""

    def __init__(self, radio, dice):
        self.estimator = RateEstimator()
        self._radio, self._dice = radio, dice
        self._flows = {row[0].topic: Flow(row[0]) for row in STREAMS}
        self._paces = {row[0].topic: Pace(row[0].rate_hz) for row in STREAMS}
        self._due = {row[0].topic: dice.random() / row[1] for row in STREAMS}
        self._beat_due = BEAT_S * dice.random()
        self._numbers = collections.Counter()
        self._shares = {}
        self._waiting, self._pieces, self._next = None, [], (0.0, 0.0)

    def _send(self, topic, size, now, body=None):
        """Send a message, in as many packets as it needs; return of how many bytes it was."""
        self._numbers[topic] += 1
        said = topic, self._numbers[topic], now, size + HEAD_BYTES, body
        left, first = size + HEAD_BYTES + AROUND_BYTES, True
        while left > 0:
            part = min(PACKET_BYTES, left)
            left -= part
            self._radio.put(now, packet(part, (self, said, first and not left)))
            first = False
        return size + HEAD_BYTES

    def tick(self, now):
        """Send what there is to send."""
        if now >= self._beat_due:
            self._beat_due += BEAT_S
            self._send('_beat', BEAT_BYTES, now)
        for stream, hz, size, packed in STREAMS:
            if now >= self._due[stream.topic]:
                self._due[stream.topic] += self._dice.uniform(0.8, 1.2) / hz
                self._come(stream, size, packed, now)
        self._go_on(now)

    def _come(self, stream, size, packed, now):
        flow, bound = self._flows[stream.topic], self.estimator.bound
        flow.came(now)
        if bound and stream.urgency == PICTURE:
            flow.sized(size + HEAD_BYTES)
            self._waiting = now
        elif self._paces[stream.topic].lets(now):
            flow.sized(self._send(stream.topic, packed if bound else size, now, b''))

    def _go_on(self, now):
        """Send the pieces of a picture, as ``link/ros/pictures.py``."""
        due, piece_due = self._next
        share = self._shares.get(CAMERA)
        if not self._pieces and self._waiting is not None and now >= due and share and share.hz:
            # A picture made smaller is seldom as large as it may be.
            body = bytes(int(min(STREAMS[-1][2], 0.8 * share.size)))
            self._numbers['picture'] += 1
            self._pieces = split(self._numbers['picture'], self._waiting, body, share.group)
            sent = sum(map(len, self._pieces))
            self._waiting = None
            due, piece_due = now + max(sent / share.bytes_per_s, 1.0 / STREAMS[-1][1]), now
        while self._pieces and now >= piece_due:
            piece = self._pieces.pop(0)
            self._send(CAMERA, len(piece), now, piece)
            piece_due += len(piece) / (share or Share(1.0)).pace
        self._next = due, piece_due

    def on_stats(self, stats, now):
        """Handle the host's report, as ``link/ros/robot_side.py``."""
        flows, estimator = list(self._flows.values()), self.estimator
        was_bound = estimator.bound
        estimator.on_stats(stats, sum(flow.demand(now) for flow in flows), now)
        if estimator.bound and not was_bound:
            for flow in flows:
                flow.packed()
        self._shares = shares(flows, estimator.bytes_per_s, estimator.loss, now, estimator.quiet) \
            if estimator.bound else {}
        for stream, _, _, _ in STREAMS[:-1]:
            share, rate_hz = self._shares.get(stream.topic), stream.rate_hz
            if share is not None:
                rate_hz = min(share.hz, rate_hz) if rate_hz else share.hz
            self._paces[stream.topic].change(rate_hz)


class Receiver:
    """The host's side: what is shown of a robot, as (when, age) [s]."""

    def __init__(self):
        self.meter = Meter()
        self.poses, self.pictures = [], []
        self._assemblers = PieceAssembler()
        self._newest = collections.Counter()
        self._parts = collections.Counter()
        self._pose_s = -math.inf

    def hear(self, said, whole, now):
        """Handle a packet; a message counts when all of it came."""
        topic, number, sent_s, size, body = said
        if not whole:
            self._parts[said[:2]] += PACKET_BYTES
            if self._parts[said[:2]] < size + AROUND_BYTES:
                return
        if number <= self._newest[topic]:
            return
        self._newest[topic] = number
        self.meter.note(topic, Frame(1, number, sent_s + ELSEWHEN_S, b''), size, now)
        if topic == ODOMETRY:
            self._pose_s = sent_s
        elif topic == CAMERA and body:
            found = self._assemblers.add(body)
            sent_s = found.stamp_s if found else None
        if topic == CAMERA and sent_s is not None:
            self.pictures.append((now, now - sent_s))

    def show(self, now):
        """Note the age of the pose, as a screen that is drawn now."""
        self.poses.append((now, now - self._pose_s))


class RadioWorld:
    """All of it.

    :param rows: what the radio does, see ``radio.py``
    :param robots: how many
    :param seed: of everything that is left to chance
    """

    def __init__(self, rows, robots, seed):
        dice = random.Random(seed)
        table = Table(read_table(rows), 0.0)
        self.up, self._down = (Channel(table, random.Random(dice.random())) for _ in range(2))
        self.senders = [Sender(self.up, dice) for _ in range(robots)]
        self.receivers = {sender: Receiver() for sender in self.senders}
        self._steps = 0
        self._every = [(BEAT_S, self._answer), (STICK_S, self._command), (SHOW_S, self._show)]
        self._due = [row[0] * dice.random() for row in self._every]

    def run(self, until_s):
        """Go on until then."""
        while self._steps * STEP_S < until_s:
            now = self._steps * STEP_S
            self._steps += 1
            for sender in self.senders:
                sender.tick(now)
            for came in self.up.take(now):
                sender, said, whole = came.said
                self.receivers[sender].hear(said, whole, now)
            for place, (period_s, call) in enumerate(self._every):
                if now >= self._due[place]:
                    self._due[place] += period_s
                    call(now)
            for came in self._down.take(now):
                if came.said is not None:
                    came.said[0].on_stats(came.said[1], now)

    def _answer(self, now):
        for sender, receiver in self.receivers.items():
            heard = receiver.meter.read(now)
            self._down.put(now, packet(BEAT_BYTES + HEAD_BYTES + AROUND_BYTES, (sender, heard)))

    def _command(self, now):
        for _ in self.senders:
            self._down.put(now, packet(COMMAND_BYTES + AROUND_BYTES, None))

    def _show(self, now):
        for receiver in self.receivers.values():
            receiver.show(now)

    def figures(self, since_s, until_s):
        """Return (sorted ages of poses, those of pictures, longest time without one) [s]."""
        poses, pictures, gap_s = [], [], 0.0
        for receiver in self.receivers.values():
            poses += [age for when, age in receiver.poses if since_s <= when < until_s]
            shown = [row for row in receiver.pictures if since_s <= row[0] < until_s]
            pictures += [age for _, age in shown]
            times = [since_s] + [when for when, _ in shown] + [until_s]
            gap_s = max([gap_s] + [after - before for before, after in zip(times, times[1:])])
        return sorted(poses), sorted(pictures), gap_s
