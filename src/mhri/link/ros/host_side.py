# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The host's side of the link: the robot appears on the host's master like any other."""
import math
import time

import rospy
from std_msgs.msg import String

from mhri.base.text import tidy_text
from mhri.base.wire import Wire
from mhri.graph.ros.master_api import MasterError
from mhri.graph.ros.messages import bytes_of, message_class, MessageMissing
from mhri.link.carried import (
    COMMAND, DOWN, full_topic, GUARD_COMMAND, GUARD_ECHO, GUARD_HEARD, PICTURE, STATE, TF_STATIC)
from mhri.link.control import unpack_control_status
from mhri.link.frames import About, FrameError, Thinned, unpack_about
from mhri.link.peer import held_s
from mhri.link.records import IN_SESSIONS
from mhri.link.robot_claims import (
    accepted_claims, fits, is_offer, MAX_TOPICS, OwnFrames, PARAMETERS, PICTURE_TYPES)
from mhri.link.ros.host_control import HostControl
from mhri.link.ros.host_record import HostRecord
from mhri.link.ros.side import ABOUT, CONTROL, Side
from mhri.robots.figures import FIGURES, figures_words, RadioFigures
from mhri.robots.owners import called

QUEUE = 5
# Period of the figures of the link [s].
PUBLISH_S = 1.0
# Minimum time between updates of a robot's description [s].
NEWS_S = 1.0
LATCHED = (TF_STATIC, 'mhri_guard/state')
# The mux announces its shutdown once: repeated for this long, since the radio may lose it [s].
PARTING_S, PARTING = 1.5, bytes(4)


class HostSide(Side):
    """Publishes the robot's messages below its name, and sends the commands of the mux to it.

    Publishes the topics offered by the robot's side, with their types, and ``/tf``, ``/tf_static``
    (``tf2_msgs/TFMessage``); subscribes to ``/<robot>/mhri_guard/command``
    (``geometry_msgs/TwistStamped``) and ``/<robot>/mhri_guard/heard`` (``std_msgs/String``) once
    the robot has a guard. Sets ``/<robot>/robot_type``, ``robot_model`` and ``mhri``, as far as
    accepted by :mod:`mhri.link.robot_claims`.

    :param types: {name: RobotType} of the installed types
    :param shared: frames shared by all robots
    :param set_parameter: called with (name, value), blocking
    :param host: name of this computer on the link
    :param secret: whether the link has keys
    :param keep: when the robot records outages, see :mod:`mhri.link.records`
    """

    def __init__(self, name, carrier, set_parameter, host, secret, types, shared,
                 keep=IN_SESSIONS, **options):
        super().__init__(name, carrier, 'down', **options)
        self._control = HostControl(
            name, host, secret, lambda body: self.send(CONTROL, COMMAND, body))
        self._host, self._set_parameter = host, set_parameter
        self._types, self._frames = types, OwnFrames(name, shared)
        self._about = About({}, ())
        self._accepted = {}
        self._news, self._news_at = None, -math.inf
        self._less = Thinned()
        self._published_at = 0.0
        self._figures = rospy.Publisher('/{}/{}'.format(name, FIGURES), String, queue_size=1,
                                        tcp_nodelay=True)
        self._publishers = {}
        self._unusable = set()
        self._down = []
        self._parting_until = 0.0
        self._record = HostRecord(self, lambda: [row[0] for row in self._about.topics
                                                 if is_offer(*row)], keep)

    def start(self):
        """Start, and fetch recordings of outages."""
        self._record.start()
        return super().start()

    def said(self):
        """Return the name of the robot's description, and the topics subscribed here."""
        requested = [place for place, (topic, _) in enumerate(self._about.topics)
                     if topic.lstrip('/') in self._publishers
                     and self._publishers[topic.lstrip('/')].get_num_connections()]
        return (self._about.name if self._about.topics else ''), tuple(requested)

    def on_peer(self, beat, now):
        """Handle the reductions of the robot side."""
        self._less = beat.thinned

    def on_frame(self, topic, frame, now):
        """Publish a message, or store the robot's description of itself."""
        if topic == ABOUT:
            self._news = unpack_about(frame.body)
            self.to_do.set()
            return
        if self._record.on_frame(topic, frame.body):
            return
        if topic == CONTROL:
            self._control.on_control_status(unpack_control_status(frame.body))
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
        """Publish the figures; advertise new topics."""
        with self.lock:
            live, second = self.peer.is_live(now), self.has_second(now)
        self._control.tick(live, '' if live or not second else self.second_text())
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
        """Set the accepted parameters of a robot at the master.

        :raises MasterError: the master is unavailable
        """
        found, left_out = accepted_claims(self.name, said, self._types)
        for key in PARAMETERS:
            if key in found and found[key] != self._accepted.get(key):
                self._set_parameter('/{}/{}'.format(self.name, key), found[key])
        if left_out and found != self._accepted:
            rospy.logwarn('%s: not accepted: %s', self.name, tidy_text(left_out, 300))
        self._accepted = found

    def _advertise(self, topic, kind):
        """Advertise a topic of the robot, if it is allowed and its type is installed."""
        key = topic.lstrip('/')
        if key in self._publishers or topic in self._unusable \
                or len(self._publishers) + len(self._unusable) >= MAX_TOPICS:
            return
        try:
            if not is_offer(topic, kind):
                raise MessageMissing('a robot may not publish it as ' + tidy_text(kind, 60))
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
        # No queue_size: a stop among waiting commands must not be dropped.
        return rospy.Subscriber(
            full_topic('/' + self.name, stream.topic), bytes_of(message_class(kind)),
            lambda message: self._on_command(stream, message._buff), tcp_nodelay=True)

    def _on_command(self, stream, data):
        """Send a command of the mux with its true age: this node may have been suspended."""
        held = held_s(Wire('command', data).header()[1], time.time()) \
            if stream.topic == GUARD_COMMAND else 0.0
        self.send(stream.topic, stream.urgency, data, held_s=held)
        if stream.topic == GUARD_HEARD:
            self._parting_until = self.clock() + PARTING_S if data == PARTING else 0.0

    def is_live(self):
        """Return whether the robot is linked now."""
        with self.lock:
            return self.peer.is_live(self.clock())

    def versions(self):
        """Return the versions of the robot side, see :mod:`mhri.link.ros.note`."""
        said = self._about.parameters.get('link')
        return {key: tidy_text(str(said.get(key, '')), 40) for key in ('mhri', 'zenoh')} \
            if isinstance(said, dict) else {}

    def fill(self, status):
        """Fill a ``DiagnosticStatusWrapper`` with the figures of the link."""
        super().fill(status)
        status.add('keys', 'TLS both ways' if self._control.state.keys else
                   'none: anyone who reaches the robot can drive it')
        status.add('control', called(self._control.state.holder) or 'nobody')
        status.add('recording', self._record.text or 'nothing was missed')
        return status

    def less(self):
        """Return the reductions of the robot side; under the lock."""
        return self._less

    def silence_text(self, silence_s):
        """Describe the silence of the robot [s]."""
        return 'the robot is silent' if silence_s < 1e9 else (
            'the robot has never answered: is mhri_link running on it, and is --connect right?')

    def second_text(self):
        """Describe that another program has the name of this host, or of the robot."""
        return '{} is linked with another computer that is called {}: give this one another name ' \
            '(mhri_link --host NAME)'.format(self.name, called(self._host)) \
            if not self.peer.is_live(self.clock()) else \
            'a second robot is called {}, and is not linked: give it another name'.format(self.name)

    def _tell(self, now):
        """Publish the figures of the link, for the robot's row."""
        with self.lock:
            live, less = self.peer.is_live(now), self._less
            loss = self.meter.read(now).loss
            trip_s = self.peer.round_trip_s()
        if live and now - self._published_at >= PUBLISH_S:
            self._published_at = now
            self._figures.publish(figures_words(RadioFigures(
                trip_s, loss, less.bytes_per_s or math.inf,
                less.picture_hz if less.bytes_per_s and less.looked_at else math.nan)))

    def close(self):
        """Give up control; the guard on the robot stops it."""
        self._control.leave()


class Listener(rospy.SubscribeListener):
    """Calls a function when a subscriber connects or disconnects."""

    def __init__(self, call):
        super().__init__()
        self._call = call

    def peer_subscribe(self, *_):
        """Handle a new subscriber."""
        self._call()

    def peer_unsubscribe(self, *_):
        """Handle the disconnection of a subscriber."""
        self._call()
