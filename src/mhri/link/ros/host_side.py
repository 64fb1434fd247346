# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The host's side of the link: on the host's master the robot looks like any other."""
import math
import time

import rospy
from std_msgs.msg import String

from mhri.base.text import tidy_text
from mhri.graph.ros.master_api import MasterError
from mhri.graph.ros.messages import bytes_of, message_class, MessageMissing
from mhri.link.carried import (
    COMMAND, DOWN, full_topic, GUARD_COMMAND, GUARD_ECHO, GUARD_HEARD, PICTURE, STATE, TF_STATIC)
from mhri.link.control import unpack_standing
from mhri.link.frames import About, FrameError, Thinned, unpack_about
from mhri.link.peer import held_s
from mhri.link.records import IN_SESSIONS
from mhri.link.renaming import stamp_of
from mhri.link.robot_claims import (
    believed, fits, is_offer, MAX_TOPICS, OwnFrames, PARAMETERS, PICTURE_TYPES)
from mhri.link.ros.host_control import HostControl
from mhri.link.ros.host_record import HostRecord
from mhri.link.ros.side import ABOUT, CONTROL, Side
from mhri.robots.figures import FIGURES, figures_words, RadioFigures
from mhri.robots.owners import called

QUEUE = 5
# The figures of the link are told so often [s].
TELL_S = 1.0
# What a robot says of itself is taken in not more often [s].
NEWS_S = 1.0
LATCHED = (TF_STATIC, 'mhri_guard/state')
# That the gates end on purpose is said once: a radio may lose it. So long it is said again [s].
PARTING_S, PARTING = 1.5, bytes(4)


class HostSide(Side):
    """Publishes what comes up, below the robot's name, and sends down what the gates command.

    Publishes the topics that the robot's side offers, with their types, and ``/tf``, ``/tf_static``
    (``tf2_msgs/TFMessage``); subscribes ``/<robot>/mhri_guard/command``
    (``geometry_msgs/TwistStamped``) and ``/<robot>/mhri_guard/heard`` (``std_msgs/String``) once
    the robot has a guard. Sets ``/<robot>/robot_type``, ``robot_model`` and ``mhri``, as far as
    :mod:`mhri.link.robot_claims` lets a robot say so.

    :param types: {name: RobotType} that are installed here
    :param shared: frames that are everybody's
    :param set_parameter: called with (name, value), blocking
    :param host: what this computer is called on the link
    :param secret: with keys
    :param keep: what the robot keeps of what is missed here, see :mod:`mhri.link.records`
    """

    def __init__(self, name, carrier, set_parameter, host, secret, types, shared,
                 keep=IN_SESSIONS, **options):
        super().__init__(name, carrier, 'down', **options)
        self._control = HostControl(
            name, host, secret, lambda body: self.send(CONTROL, COMMAND, body))
        self._set_parameter = set_parameter
        self._types, self._frames = types, OwnFrames(name, shared)
        self._about = About({}, ())
        self._believed = {}
        self._news, self._news_at = None, -math.inf
        self._less = Thinned()
        self._told_at = 0.0
        self._figures = rospy.Publisher('/{}/{}'.format(name, FIGURES), String, queue_size=1,
                                        tcp_nodelay=True)
        self._publishers = {}
        self._unusable = set()
        self._down = []
        self._parting_until = 0.0
        self._record = HostRecord(self, lambda: [row[0] for row in self._about.topics
                                                 if is_offer(*row)], keep)

    def start(self):
        """Begin, and fetch what was missed."""
        self._record.start()
        return super().start()

    def said(self):
        """Name what is known of the robot, and which of its topics somebody here listens to."""
        wanted = [place for place, (topic, _) in enumerate(self._about.topics)
                  if topic.lstrip('/') in self._publishers
                  and self._publishers[topic.lstrip('/')].get_num_connections()]
        return (self._about.name if self._about.topics else ''), tuple(wanted)

    def on_peer(self, beat, now):
        """Take in what the robot's side sends less of."""
        self._less = beat.thinned

    def on_frame(self, topic, frame, now):
        """Publish a message, or note what the robot says of itself."""
        if topic == ABOUT:
            self._news = unpack_about(frame.body)
            self.to_do.set()
            return
        if self._record.on_frame(topic, frame.body):
            return
        if topic == CONTROL:
            self._control.on_standing(unpack_standing(frame.body))
            return
        publisher = self._publishers.get(topic)
        if publisher is not None:
            kind = publisher.type
            self.note_age(COMMAND if topic == GUARD_ECHO else
                          PICTURE if kind in PICTURE_TYPES else STATE, frame, now)
            if not fits(kind, frame.body):
                raise FrameError('{} bytes are too many for {}'.format(len(frame.body), kind))
            message = publisher.data_class()
            message._buff = self._frames.of(publisher.resolved_name, kind, frame.body)
            publisher.publish(message)

    def work(self, now):
        """Tell the figures; open the topics that are new."""
        self._control.tick(self.peer.heard(now))
        self._tell(now)
        if now < self._parting_until:
            self.send(GUARD_HEARD, COMMAND, PARTING)
        news = self._news
        if news is None or news == self._about or now - self._news_at < NEWS_S:
            return
        self._news_at = now
        try:
            self._set_parameters(news.parameters)
        except MasterError as error:
            rospy.logwarn_throttle(10.0, '{}: {}'.format(self.name, error))
            return
        for topic, kind in news.topics:
            self._advertise(topic, kind)
        if not self._down and GUARD_ECHO in self._publishers:
            self._down = [self._subscribe(*row) for row in DOWN]
        with self.lock:
            self._about = news

    def _set_parameters(self, said):
        """Set at the master what is believed of a robot's parameters.

        :raises MasterError: it cannot be reached
        """
        found, left_out = believed(self.name, said, self._types)
        for key in PARAMETERS:
            if key in found and found[key] != self._believed.get(key):
                self._set_parameter('/{}/{}'.format(self.name, key), found[key])
        if left_out and found != self._believed:
            rospy.logwarn('%s: of what it says of itself: %s', self.name, tidy_text(left_out, 300))
        self._believed = found

    def _advertise(self, topic, kind):
        """Publish one of the robot's topics, if it may have that, and its type is known here."""
        key = topic.lstrip('/')
        if key in self._publishers or topic in self._unusable \
                or len(self._publishers) + len(self._unusable) >= MAX_TOPICS:
            return
        try:
            if not is_offer(topic, kind):
                raise MessageMissing('a robot has no such topic of type ' + tidy_text(kind, 60))
            found = bytes_of(message_class(kind))
        except MessageMissing as error:
            self._unusable.add(topic)
            rospy.logwarn('%s: %s is not carried: %s', self.name, tidy_text(topic, 60), error)
            return
        publisher = rospy.Publisher(
            full_topic('/' + self.name, topic), found, queue_size=QUEUE, tcp_nodelay=True,
            latch=topic in LATCHED, subscriber_listener=Listener(self.to_say.set))
        with self.lock:
            self._publishers[key] = publisher

    def _subscribe(self, stream, kind):
        # No queue: of what waited, the stop among the commands must not be lost.
        return rospy.Subscriber(
            full_topic('/' + self.name, stream.topic), bytes_of(message_class(kind)),
            lambda message: self._on_command(stream, message._buff), tcp_nodelay=True)

    def _on_command(self, stream, data):
        """Send down what the gates said, as old as it is: this node may have hung meanwhile."""
        held = held_s(stamp_of(data), time.time()) if stream.topic == GUARD_COMMAND else 0.0
        self.send(stream.topic, stream.urgency, data, held_s=held)
        if stream.topic == GUARD_HEARD:
            self._parting_until = self.clock() + PARTING_S if data == PARTING else 0.0

    def heard(self):
        """Tell whether the robot is heard now."""
        with self.lock:
            return self.peer.heard(self.clock())

    def versions(self):
        """Return the versions that the robot tells of its side, see :mod:`mhri.link.ros.note`."""
        said = self._about.parameters.get('link')
        return {key: tidy_text(str(said.get(key, '')), 40) for key in ('mhri', 'zenoh')} \
            if isinstance(said, dict) else {}

    def fill(self, status):
        """Fill a ``DiagnosticStatusWrapper`` with the figures of the link."""
        super().fill(status)
        status.add('keys', 'TLS both ways' if self._control.state.keys else
                   'none: whoever reaches the robot can drive it')
        status.add('control', called(self._control.state.holder) or 'nobody')
        status.add('recording', self._record.text or 'nothing was missed')
        return status

    def less(self):
        """Return what the robot's side sends less of; under the lock."""
        return self._less

    def unheard(self, silence_s):
        """Return in words that the robot is not heard, for so long [s]."""
        return 'the robot is not heard' if silence_s < 1e9 else (
            'the robot was never heard: is mhri_link running on it, and is --connect right?')

    def _tell(self, now):
        """Publish the figures of the link, for the robot's row."""
        with self.lock:
            heard, less = self.peer.heard(now), self._less
            loss = self.meter.read(now).loss
            trip_s = self.peer.round_trip_s()
        if heard and now - self._told_at >= TELL_S:
            self._told_at = now
            self._figures.publish(figures_words(RadioFigures(
                trip_s, loss, less.bytes_per_s or math.inf,
                less.picture_hz if less.bytes_per_s and less.looked_at else math.nan)))

    def close(self):
        """Give up control; the guard on the robot ends what is being driven."""
        self._control.leave()


class Listener(rospy.SubscribeListener):
    """Calls a function when somebody begins or ends to listen."""

    def __init__(self, call):
        super().__init__()
        self._call = call

    def peer_subscribe(self, *_):
        """Somebody listens."""
        self._call()

    def peer_unsubscribe(self, *_):
        """Somebody has ended to."""
        self._call()
