# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The robot's side of the link, on the robot's own master."""
import math

import rospy

from mhri.base.robot_types import resolve_robot_type
from mhri.camera.image_message import has_content
from mhri.camera.transports import FIRST_S
from mhri.driving.guard_link import parse_id
from mhri.graph.ros.master_api import MasterApi, MasterError
from mhri.graph.ros.messages import bytes_of, message_class
from mhri.graph.ros.non_blocking import NonBlockingPublisher
from mhri.graph.ros.subscription import Subscription
from mhri.link.carried import (
    DOWN, FRAME_NAMES, full_topic, GUARD_COMMAND, Pace, PICTURE, STATE, TF, TF_STATIC, up_streams,
    worth_carrying)
from mhri.link.control import LEAVE, moves
from mhri.link.frames import About, DEFLATED, pack_about, PIECE, PLAIN, Thinned
from mhri.link.peer import may_pass
from mhri.link.rate_estimator import RateEstimator
from mhri.link.records import ASK
from mhri.link.renaming import first_text, renamer, rewritten, Transforms
from mhri.link.robot_claims import PARAMETERS
from mhri.link.ros.note import versions
from mhri.link.ros.pictures import Pictures
from mhri.link.ros.reregister import Reregistration
from mhri.link.ros.robot_record import RobotRecord
from mhri.link.ros.side import ABOUT, CONTROL, Side
from mhri.link.shares import Flow, shares
from mhri.robots.found_streams import FoundStreams
from mhri.robots.owners import called

LOOK_S = 1.0
# Topics without subscribers on the host stay subscribed for this long [s].
LINGER_S = 5.0
LATCHED_S = 1.0
# Period of the log lines about a full radio, which a busy computer may fake twice a minute [s].
LOG_S = 60.0
# Smaller messages are not worth compressing [bytes].
PACKED_BYTES = 200


class CarriedStream:
    """One stream while it has subscribers on the host.

    :param stream: :class:`mhri.link.carried.Stream`
    :param send: called with (stream, type, bytes, number of names in it); returns the size of the
        sent message, 0 if it was not sent
    """

    def __init__(self, namespace, stream, rename, send, clock):
        self.requested_at = self._opened_at = clock()
        self.stream = stream
        self._send = send
        self._clock = clock
        self._pace = Pace(stream.rate_hz)
        self.flow = Flow(stream)
        self._whole = self._spoke = False
        self._newest = None
        self._sent_at = clock()
        self._transforms = None
        if stream.topic in (TF, TF_STATIC):
            self._transforms = Transforms(rename, stream.latched)
        self._subscription = Subscription(full_topic(namespace, stream.topic), self._hear)

    def _hear(self, kind, data):
        """Forward a message if due; store transforms and latched ones (on rospy's thread)."""
        if self._transforms is not None:
            try:
                self._transforms.add(bytes(data))
            except ValueError as error:
                rospy.logwarn_throttle(10.0, '{}: {}'.format(self.stream.topic, error))
                return
        elif self.stream.latched:
            self._newest = bytes(data)
        now = self._clock()
        self._spoke = self._spoke or has_content(kind, data)
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
        """Apply a share, None: no reduction. Pictures are thinned out by :class:`Pictures`."""
        self._whole = share is not None and self.stream.urgency == PICTURE
        rate_hz = self.stream.rate_hz
        if share is not None:
            rate_hz = min(share.hz, rate_hz) if rate_hz else share.hz
        self._pace.change(rate_hz)

    def again(self, now):
        """Send a latched message again, since it may be lost, or for later subscribers."""
        if self.stream.latched and now - self._sent_at >= LATCHED_S:
            self._go('', self._newest, now)

    def is_silent(self):
        """Return whether nothing has come although it was requested for a while."""
        return not self._spoke and self._clock() - self._opened_at > FIRST_S

    def close(self):
        """Unsubscribe (blocking: calls the master)."""
        self._subscription.close()


class RobotSide(Side):
    """The link to one host: sends its subscribed topics to it, and its commands to the guard.

    Subscribes to the topics of the robot's type, ``mhri_guard/echo``, ``mhri_guard/state``,
    ``mhri_guard/dropped``, ``/tf`` and ``/tf_static`` while they have subscribers on the host.
    Publishes ``mhri_guard/command`` (``geometry_msgs/TwistStamped``; not older than 0.3 s, except
    stops) and ``mhri_guard/heard`` (``std_msgs/String``), both for the guard.

    :param namespace: of the robot on its own master, such as ``/bot1``, or '' without one
    :param types: {name: RobotType}
    :param shared: frames that keep their names
    :param peer_control: :class:`mhri.link.ros.link_server.PeerControl` of that host
    """

    def __init__(self, name, carrier, namespace, types, shared, peer_control, **options):
        super().__init__(name, carrier, 'up', **options)
        self._peer_control = peer_control
        self.dropped = 0
        self._namespace = namespace
        self._types = types
        self._rename = renamer(name, shared)
        self._reregistration = Reregistration()
        self._record = RobotRecord(self, self._recorded)
        self._about = About({'link': versions()}, ())
        self._told_at = self._looked_at = 0.0
        self._requested = ()
        self._estimator, self._bound = RateEstimator(), False
        self._pictures = Pictures(self.clock, self._up_piece, lambda data, names, number: rewritten(
            data, number, names, self._rename))
        self._found = FoundStreams()
        self._streams = {}
        self._open = {}
        self._publishers = {
            stream.topic: NonBlockingPublisher(full_topic(namespace, stream.topic),
                                               bytes_of(message_class(kind)), queue_size=10)
            for stream, kind in DOWN}

    def start(self):
        """Start, and record on request of the host."""
        self._record.start()
        return super().start()

    def _recorded(self, pictures):
        """Return the absolute names of the topics to record."""
        topics = [stream.topic for stream in list(self._streams.values())
                  if pictures or stream.urgency != PICTURE]
        return sorted(full_topic(self._namespace, topic) for topic in topics + [GUARD_COMMAND]) \
            if topics else []

    def said(self):
        """Return the name of this robot's description."""
        return self._about.name, ()

    def on_peer(self, beat, now):
        """Handle the list of topics with subscribers on the host."""
        self._peer_control.on_heard(now)
        requested = ()
        if beat.about == self._about.name:
            requested = tuple(self._about.topics[place][0] for place in beat.requested
                              if 0 <= place < len(self._about.topics))
        elif now - self._told_at >= 0.5 and self._about.topics:
            self._told_at = now
            self.send(ABOUT, STATE, pack_about(self._about))
        if requested != self._requested:
            self._requested = requested
            self.to_do.set()
        self._thin(beat.stats, now)

    def _thin(self, stats, now):
        """Adapt the rates to the capacity of the radio, according to the reports of the hosts."""
        opened = [carried for topic, carried in list(self._open.items())
                  if topic in self._requested]
        flows, estimator = [carried.flow for carried in opened], self._estimator
        was_bound = self._bound
        if stats is not None:
            estimator.on_stats(stats, sum(flow.demand(now) for flow in flows), now)
        bytes_per_s = self._peer_control.share(estimator.bytes_per_s, stats is not None, now)
        self._bound = math.isfinite(bytes_per_s)
        if not (was_bound or self._bound):
            return
        if not was_bound:
            for flow in flows:
                flow.packed()
        found = shares(flows, bytes_per_s, estimator.loss, now, estimator.quiet) \
            if self._bound else {}
        for carried in opened:
            carried.thin(found.get(carried.stream.topic))
        self._pictures.share(found)
        looked_at = any(flow.stream.urgency == PICTURE for flow in flows)
        self.thinned = Thinned(bytes_per_s, self._pictures.most_hz(), looked_at) \
            if found else Thinned()
        if not self._bound:
            self._pictures.forget()
            rospy.loginfo_throttle(LOG_S, '{}: the radio carries everything'.format(self.name))
        elif not was_bound:
            rospy.loginfo_throttle(LOG_S, '{}: limited to {:.0f} kB/s by the radio'.format(
                self.name, 1e-3 * bytes_per_s))

    def on_frame(self, topic, frame, now):
        """Pass a command to the guard, unless it is late or another host has control."""
        if topic == ASK:
            self._record.on_ask(frame.body)
            return
        if topic == CONTROL:
            self._peer_control.on_asked(frame.body, now)
            if frame.body == LEAVE:
                # Its successor need not wait until it counts as silent.
                self.peer.on_gone()
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
            return self._peer_control.holds()
        frame_id = first_text(body)
        return may_pass(frame_id, age_s) and self._peer_control.passes(
            parse_id(frame_id)[3], moves(body), now)

    def work(self, now):
        """Query the master periodically; open and close streams."""
        if now - self._looked_at >= LOOK_S:
            self._looked_at = now
            try:
                self._reregistration.look()
                self._look()
            except MasterError as error:
                rospy.logdebug('%s', error)
        with self.lock:
            requested = self._requested if self.peer.is_live(now) else ()
        for topic in requested:
            if topic in self._open:
                self._open[topic].requested_at = now
            elif topic in self._streams:
                self._open[topic] = CarriedStream(self._namespace, self._streams[topic],
                                                  self._rename, self._up, self.clock)
        for topic, carried in list(self._open.items()):
            if now - carried.requested_at > LINGER_S:
                del self._open[topic]
                carried.close()
            elif topic in requested:
                carried.again(now)

    def _goes(self, stream):
        """Return whether a stream has receivers."""
        return stream.topic in self._requested and self.peer.is_live(self.clock())

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
        """Update the robot's type and topics; known ones remain even if the master loses them.

        :raises MasterError: the master is unavailable
        """
        api = MasterApi(rospy.get_name(), timeout_s=1.0)
        state, types, *found = api.call_many(
            [('getSystemState',), ('getTopicTypes',)]
            + [('getParam', full_topic(self._namespace, key)) for key in PARAMETERS])
        parameters = dict(self._about.parameters)
        parameters.update((key, value) for key, value in zip(PARAMETERS, found)
                          if value is not None)
        kind, errors = resolve_robot_type(self._types, self.name, parameters)
        own, kinds = rospy.get_name(), dict(map(tuple, types))
        start = self._namespace + '/'
        kind = self._found.update(
            kind, {topic[len(start):]: kinds.get(topic, '') for topic, nodes in state[0]
                   if topic.startswith(start) and set(nodes) != {own}}, parameters)
        for error in errors:
            rospy.logwarn_throttle(60.0, '{}'.format(error))
        streams = {full_topic(self._namespace, stream.topic): stream
                   for stream in up_streams(kind)}
        # A compressed picture that is only advertised is in nobody's place.
        silent = {topic for topic, carried in list(self._open.items()) if carried.is_silent()}
        there = {streams[topic].topic for topic, nodes in state[0]
                 if topic in streams and any(node != own for node in nodes)} - silent
        topics = dict(self._about.topics)
        for stream in worth_carrying(list(streams.values()), there):
            kind = kinds.get(full_topic(self._namespace, stream.topic), '')
            if kind not in ('', '*'):
                topics[stream.topic] = kind
                self._streams[stream.topic] = stream
        with self.lock:
            self._about = About(parameters, tuple(sorted(topics.items())))

    def keeps(self):
        """Return whether to record for the host."""
        return self._record.keeps()

    def leave(self):
        """Close only this side (blocking: calls the master)."""
        self._ended.set()
        self._carrier.close()
        self._pictures.close()
        for carried in list(self._open.values()):
            carried.close()
        for publisher in self._publishers.values():
            publisher.unregister()

    def silence_text(self, silence_s):
        """Describe the silence of the host [s]."""
        return 'the host is silent' if silence_s < 1e9 else 'the host has never connected'

    def second_text(self):
        """Describe that a second computer has the name of the host."""
        return 'a second computer is called {}, and is not linked: give it another name ' \
            '(mhri_link --host NAME)'.format(called(self._peer_control.host))

    def close(self):
        """Log statistics at the end; the guard stops the robot."""
        rospy.loginfo('%s: %d commands not passed to the guard', self.name, self.dropped)
