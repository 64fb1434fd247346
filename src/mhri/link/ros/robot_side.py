# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The robot's side of the link, on the robot's own master."""
import math

import rospy

from mhri.base.robot_types import resolve_robot_type
from mhri.driving.guard_link import parse_id
from mhri.graph.ros.master_api import MasterApi, MasterError
from mhri.graph.ros.messages import bytes_of, message_class
from mhri.graph.ros.prompt import PromptPublisher
from mhri.graph.ros.subscription import Subscription
from mhri.link.bearing import Bearing
from mhri.link.carried import (
    DOWN, FRAME_NAMES, full_topic, GUARD_COMMAND, Pace, PICTURE, TF, TF_STATIC, up_streams,
    worth_carrying)
from mhri.link.control import moves
from mhri.link.frames import About, DEFLATED, pack_about, PIECE, PLAIN, Thinned
from mhri.link.peer import may_pass
from mhri.link.records import ASK
from mhri.link.renaming import first_text, renamer, rewritten, Transforms
from mhri.link.robot_claims import PARAMETERS
from mhri.link.ros.note import versions
from mhri.link.ros.pictures import Pictures
from mhri.link.ros.recall import Recall
from mhri.link.ros.robot_record import RobotRecord
from mhri.link.ros.side import CONTROL, Side
from mhri.link.shares import Flow, shares

LOOK_S = 1.0
# What nobody on the host listens to any more stays subscribed for a while [s].
LINGER_S = 5.0
LATCHED_S = 1.0
# On a busy computer the radio may seem full twice a minute: one line of that in so long [s].
TOLD_S = 60.0
# Smaller messages are not worth packing [bytes].
PACKED_BYTES = 200


class Carried:
    """One stream while somebody on the host listens to it.

    :param stream: :class:`mhri.link.carried.Stream`
    :param send: called with (stream, type, bytes, number of names in it); returns of how many bytes
        the message was, 0 if it was not sent
    """

    def __init__(self, namespace, stream, rename, send, clock):
        self.wanted_at = clock()
        self.stream = stream
        self._send = send
        self._clock = clock
        self._pace = Pace(stream.rate_hz)
        self.flow = Flow(stream)
        self._whole = False
        self._newest = None
        self._sent_at = clock()
        self._transforms = None
        if stream.topic in (TF, TF_STATIC):
            self._transforms = Transforms(rename, stream.latched)
        self._subscription = Subscription(full_topic(namespace, stream.topic), self._hear)

    def _hear(self, kind, data):
        """Send a message on, or keep it for the next time (on rospy's thread)."""
        if self._transforms is not None:
            try:
                self._transforms.add(bytes(data))
            except ValueError as error:
                rospy.logwarn_throttle(10.0, '{}: {}'.format(self.stream.topic, error))
                return
        elif self.stream.latched:
            self._newest = bytes(data)
        now = self._clock()
        self.flow.came(now)
        if self._whole or self._pace.lets(now):
            self._go(kind, bytes(data), now)

    def _go(self, kind, data, now):
        if self._transforms is not None:
            data = self._transforms.take()
        if data is not None:
            self._sent_at = now
            size = self._send(self.stream, kind, data, FRAME_NAMES.get(kind, 0))
            if size:
                self.flow.sized(size)

    def thin(self, share):
        """Go over to a share; None to send all. Pictures are thinned by :class:`Pictures`."""
        self._whole = share is not None and self.stream.urgency == PICTURE
        rate_hz = self.stream.rate_hz
        if share is not None:
            rate_hz = min(share.hz, rate_hz) if rate_hz else share.hz
        self._pace.change(rate_hz)

    def again(self, now):
        """Send what is latched once more: the radio may have lost it, or somebody came later."""
        if self.stream.latched and now - self._sent_at >= LATCHED_S:
            self._go('', self._newest, now)

    def close(self):
        """Stop listening (blocking: it asks the master)."""
        self._subscription.close()


class RobotSide(Side):
    """The link with one host: sends up what it listens to, and gives the guard what it commands.

    Subscribes the topics of the robot's type, ``mhri_guard/echo``, ``mhri_guard/state``,
    ``mhri_guard/dropped``, ``/tf`` and ``/tf_static`` while a node on the host listens to them.
    Publishes ``mhri_guard/command`` (``geometry_msgs/TwistStamped``; nothing older than 0.3 s but
    stops) and ``mhri_guard/heard`` (``std_msgs/String``), both for the guard.

    :param namespace: of the robot on its own master, such as ``/bot1``, or '' for none
    :param types: {name: RobotType}
    :param shared: frames that keep their names
    :param desk: :class:`mhri.link.ros.reception.Desk`, which knows whether that host has control
    """

    def __init__(self, name, carrier, namespace, types, shared, desk, **options):
        super().__init__(name, carrier, 'up', **options)
        self._desk = desk
        self.dropped = 0
        self._namespace = namespace
        self._types = types
        self._rename = renamer(name, shared)
        self._recall = Recall()
        self._record = RobotRecord(self, self._recorded)
        self._about = About({'link': versions()}, ())
        self._told_at = self._looked_at = 0.0
        self._wanted = ()
        self._bearing, self._bound = Bearing(), False
        self._pictures = Pictures(self.clock, self._up_piece, lambda data, names, number: rewritten(
            data, number, names, self._rename))
        self._streams = {}
        self._open = {}
        self._publishers = {
            stream.topic: PromptPublisher(full_topic(namespace, stream.topic),
                                          bytes_of(message_class(kind)), queue_size=10)
            for stream, kind in DOWN}

    def start(self):
        """Begin, and record what the host asks for."""
        self._record.start()
        return super().start()

    def _recorded(self, pictures):
        """Return what is recorded."""
        topics = [stream.topic for stream in list(self._streams.values())
                  if pictures or stream.urgency != PICTURE]
        return sorted(full_topic(self._namespace, topic) for topic in topics + [GUARD_COMMAND]) \
            if topics else []

    def said(self):
        """Name what this robot says of itself."""
        return self._about.name, ()

    def on_peer(self, beat, now):
        """Take in which topics somebody on the host listens to."""
        self._desk.on_heard(now)
        wanted = ()
        if beat.about == self._about.name:
            wanted = tuple(self._about.topics[place][0] for place in beat.wanted
                           if 0 <= place < len(self._about.topics))
        elif now - self._told_at >= 0.5 and self._about.topics:
            self._told_at = now
            self.send_about(pack_about(self._about))
        if wanted != self._wanted:
            self._wanted = wanted
            self.to_do.set()
        self._thin(beat.heard, now)

    def _thin(self, heard, now):
        """Send as much as the radio bears, by what the host's side says that came, and others'."""
        opened = [carried for topic, carried in list(self._open.items())
                  if topic in self._wanted]
        flows, bearing = [carried.flow for carried in opened], self._bearing
        was_bound = self._bound
        if heard is not None:
            bearing.on_heard(heard, sum(flow.demand(now) for flow in flows), now)
        bytes_per_s = self._desk.share(bearing.bytes_per_s if bearing.bound else math.inf,
                                       heard is not None, now)
        self._bound = math.isfinite(bytes_per_s)
        if not (was_bound or self._bound):
            return
        if not was_bound:
            for flow in flows:
                flow.packed()
        found = shares(flows, bytes_per_s, bearing.loss, now, bearing.quiet) \
            if self._bound else {}
        for carried in opened:
            carried.thin(found.get(carried.stream.topic))
        self._pictures.share(found)
        looked_at = any(flow.stream.urgency == PICTURE for flow in flows)
        self.thinned = Thinned(bytes_per_s, self._pictures.most_hz(), looked_at) \
            if found else Thinned()
        if not self._bound:
            self._pictures.forget()
            rospy.loginfo_throttle(TOLD_S, '{}: the radio bears everything'.format(self.name))
        elif not was_bound:
            rospy.loginfo_throttle(TOLD_S, '{}: the radio bears {:.0f} kB/s: less is sent'.format(
                self.name, 1e-3 * bytes_per_s))

    def on_frame(self, topic, frame, now):
        """Give the guard a command, unless it is late, or another host has control."""
        if topic == ASK:
            self._record.on_ask(frame.body)
            return
        if topic == CONTROL:
            self._desk.on_asked(frame.body, now)
            return
        publisher = self._publishers.get(topic)
        if publisher is None:
            return
        age_s = self.note_age('command', frame, now)
        if not self._passes(topic, frame.body, age_s, now):
            self.dropped += 1
            return
        message = publisher.data_class()
        message._buff = frame.body
        publisher.publish(message)

    def _passes(self, topic, body, age_s, now):
        if topic != GUARD_COMMAND:
            return self._desk.holds()
        frame_id = first_text(body)
        return may_pass(frame_id, age_s) and self._desk.passes(
            parse_id(frame_id)[3], moves(body), now)

    def work(self, now):
        """Look at the master now and then; open and close what is listened to."""
        if now - self._looked_at >= LOOK_S:
            self._looked_at = now
            try:
                self._recall.look()
                self._look()
            except MasterError as error:
                rospy.logdebug('%s', error)
        with self.lock:
            wanted = self._wanted if self.peer.heard(now) else ()
        for topic in wanted:
            if topic in self._open:
                self._open[topic].wanted_at = now
            elif topic in self._streams:
                self._open[topic] = Carried(self._namespace, self._streams[topic], self._rename,
                                            self._up, self.clock)
        for topic, carried in list(self._open.items()):
            if now - carried.wanted_at > LINGER_S:
                del self._open[topic]
                carried.close()
            elif topic in wanted:
                carried.again(now)

    def _goes(self, stream):
        """Tell whether anybody would hear a stream."""
        return stream.topic in self._wanted and self.peer.heard(self.clock())

    def _up(self, stream, kind, data, names):
        with self.lock:
            if not self._goes(stream):
                return 0
            bound = self._bound
            if bound and stream.urgency == PICTURE:
                self._pictures.offer(stream, kind, data, names)
                return len(data)
            packed = bound and len(data) >= PACKED_BYTES
            try:
                return self.send(stream.topic, stream.urgency, data,
                                 lambda number: rewritten(data, number, names, self._rename),
                                 kind=DEFLATED if packed else PLAIN)
            except ValueError as error:
                rospy.logwarn_throttle(10.0, '{}: {}'.format(stream.topic, error))
                return 0

    def _up_piece(self, stream, piece):
        with self.lock:
            goes = self._goes(stream) and self._bound
            if goes:
                self.send(stream.topic, stream.urgency, piece, kind=PIECE)
            return goes

    def _look(self):
        """Learn the robot's type and topics; what was there once stays, whatever a master forgets.

        :raises MasterError: it cannot be asked now
        """
        api = MasterApi(rospy.get_name(), timeout_s=1.0)
        state, types, *found = api.call_many(
            [('getSystemState',), ('getTopicTypes',)]
            + [('getParam', full_topic(self._namespace, key)) for key in PARAMETERS])
        parameters = dict(self._about.parameters)
        parameters.update((key, value) for key, value in zip(PARAMETERS, found)
                          if value is not None)
        kind, errors = resolve_robot_type(self._types, self.name, parameters)
        for error in errors:
            rospy.logwarn_throttle(60.0, '{}'.format(error))
        streams = {full_topic(self._namespace, stream.topic): stream
                   for stream in up_streams(kind)}
        own = rospy.get_name()
        there = {streams[topic].topic for topic, nodes in state[0]
                 if topic in streams and any(node != own for node in nodes)}
        topics = dict(self._about.topics)
        kinds = dict(map(tuple, types))
        for stream in worth_carrying(list(streams.values()), there):
            kind = kinds.get(full_topic(self._namespace, stream.topic), '')
            if kind not in ('', '*'):
                topics[stream.topic] = kind
                self._streams[stream.topic] = stream
        with self.lock:
            self._about = About(parameters, tuple(sorted(topics.items())))

    def keeps(self):
        """Tell whether the host wants what it misses."""
        return self._record.keeps()

    def leave(self):
        """Forget this host (blocking: it asks the master); :meth:`close` ends all of them."""
        self._ended.set()
        self._carrier.close()
        self._pictures.close()
        for carried in list(self._open.values()):
            carried.close()
        for publisher in self._publishers.values():
            publisher.unregister()

    def unheard(self, silence_s):
        """Return in words that the host is not heard, for so long [s]."""
        return 'the host is not heard' if silence_s < 1e9 else 'the host was never heard'

    def close(self):
        """Say nothing more; the guard ends what is being driven."""
        rospy.loginfo('%s: %d commands kept from the guard', self.name, self.dropped)
