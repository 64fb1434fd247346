# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""One camera of one robot: found, subscribed and decoded at the displayed size, newest only.

An open feed has two threads: one finds the topic and holds the subscription, the other decodes;
while it is thinned on the network, it has a third. It receives nothing while closed or paused;
while closed, it has no threads.
"""
import threading
import time

import rospy

from mhri.base.names import topic_of
from mhri.camera.budget import AS_IT_COMES, Figures
from mhri.camera.image_message import RAW_TYPE
from mhri.camera.images import StreamStatus
from mhri.camera.ros.camera_decoder import Decoder
from mhri.camera.ros.picture_relay import PICTURE_RELAY
from mhri.camera.ros.samples import no_answer, Samples
from mhri.camera.stream_meter import WINDOW_S
from mhri.camera.transports import AUTO, find_offers, may_carry, RAW, Speakers
from mhri.graph.ros.master_api import MasterApi, MasterError
from mhri.graph.ros.subscription import reachable, Subscription
from mhri.robots.found_streams import choice_words, likely_topics, own_topics

LOOK_S = 1.0           # period of master queries while nothing is received
LOOK_AGAIN_S = 5.0     # ... and while pictures are: a better transport may appear
# Minimum age of a subscription for measuring the rate of the camera [s].
SETTLED_S = WINDOW_S + 0.5
# The words for the kinds of pictures.
_WORDS = {'rgb': 'picture', 'depth': 'depth picture'}


class CameraFeed:
    """A camera's pictures, for a widget that polls them on a timer.

    Subscribes ``/<robot>/<topic>/compressed`` (depth: ``.../compressedDepth``), type
    ``sensor_msgs/CompressedImage``, or ``/<robot>/<topic>``, type ``sensor_msgs/Image``: the first
    one that sends pictures, and those before it, in case they begin to. No method blocks, except
    :meth:`close` with a wait; call them on any thread.

    :param robot: namespace of the robot
    :param topics: camera topics relative to it, in order of preference, without transport
    :param kind: 'rgb' or 'depth'
    :param transport: 'auto', or a name of :meth:`transports`
    """

    @classmethod
    def of(cls, robot, kind, key):
        """Return the feed of a camera (``key``: 'rgb' or 'depth'), None for a type without it."""
        topics = getattr(kind, key)
        return cls(robot, topics, key) if topics else None

    def __init__(self, robot, topics, kind, transport=AUTO, clock=time.monotonic):
        self.robot = robot
        self.kind = kind
        self.word = _WORDS[kind]
        self._topics = [topic_of(robot, topic) for topic in topics]
        # A robot without a namespace has its topics anywhere.
        self._below = '/{}/'.format(robot)
        if any(not topic.startswith(self._below) for topic in self._topics):
            self._below = ''
        self._transport = transport
        self._clock = clock
        self._changed = threading.Condition()
        self._finder = None
        self._session = None
        self._view_limits = (None, None)
        self._grant = AS_IT_COMES
        self._offers = []
        # The subscription, or its stand-in; the time of its last change; the last topic.
        self._line = None
        self._changed_at = clock()
        self._topic = ''
        self._known = {}
        self._speakers = Speakers()
        # {topic: (its session, its subscription)} of silent topics that would be better.
        self._watched = {}

    def open(self):
        """Start looking for the camera and decoding; return at once."""
        with self._changed:
            if self._session is not None:
                return
            self._session = self.new_session(self._decoder_limits)
            self._session.expect(self._grant)
            self._changed_at = self._clock()
            if self._finder is None:
                # Otherwise a thread that is still unsubscribing the previous topic continues with
                # this opening.
                self._finder = threading.Thread(target=self._find, daemon=True,
                                                name='camera finder ' + self.robot)
                self._finder.start()
            self._changed.notify_all()

    def new_session(self, wanted):
        """Return the :class:`Decoder` of one opening; ``wanted`` is its argument."""
        return Decoder(self.robot, self.kind, wanted, self._clock)

    def find_offers(self, published):
        """Return the offers, best first, among the published {topic: type}."""
        return find_offers(self.kind, self._topics, published)

    def line_of(self, session, offer, receive):
        """Return (class, arguments) of the subscription to an offer.

        :param receive: function of (type, bytes)
        """
        return Subscription, offer.topic, receive

    def samples_of(self, session, offer, receive, grant, native_hz):
        """Return the same for single pictures of an offer."""
        return (Samples, offer.topic, receive, session.explain, grant.rate_hz, native_hz,
                self._clock)

    def _relaying(self, session, offer):
        return PICTURE_RELAY.relaying(offer.topic, session.receive, self.kind)

    def close(self, wait_s=0.0):
        """Stop decoding and unregister the topic, the latter on the feed's own thread.

        :param wait_s: maximum time to wait for that [s]
        """
        with self._changed:
            session, self._session = self._session, None
            self._offers = []
            finder = self._finder
            self._changed.notify_all()
        if session is not None:
            session.end()
        if finder is not None and wait_s > 0.0:
            finder.join(wait_s)

    def set_view(self, width=None, height=None, max_hz=None):
        """Set the size [pixels] and maximum rate [Hz] of the pictures; None: as published."""
        wanted = ((width, height) if width and height else None, max_hz)
        changed, self._view_limits = wanted != self._view_limits, wanted
        session = self._session
        if session is not None and changed:
            session.wake()

    def grant(self, grant):
        """Apply a :class:`mhri.camera.budget.Grant` from now on.

        At a rate of 0 the feed unsubscribes and keeps its last picture.
        """
        with self._changed:
            changed, self._grant = grant != self._grant, grant
            session = self._session
            self._changed.notify_all()
        if session is not None and changed:
            session.expect(grant)

    def _decoder_limits(self):
        """Return the limits of the decoder: (size or None, maximum rate [Hz] or None)."""
        (view, max_hz), grant = self._view_limits, self._grant
        rates = [rate for rate in (max_hz, None if grant.sampled else grant.rate_hz) if rate]
        return view, min(rates, default=None)

    def figures(self):
        """Return the :class:`mhri.camera.budget.Figures` of its load on the network."""
        now = self._clock()
        with self._changed:
            session, line, topic, grant = self._session, self._line, self._topic, self._grant
            lasts_s = now - self._changed_at
            bits, native_hz = self._known.get(topic, (None, None))
            heavy = (self._transport == RAW and not grant.lighter
                     and any(offer.transport != RAW for offer in self._offers))
        if session is None or grant.rate_hz == 0.0:
            return Figures(bits, native_hz, heavy)
        status = session.status(now)
        if line is None or isinstance(line, Subscription) and not status.rate_hz:
            # Nothing is received: either not yet, or the camera is silent.
            return Figures(bits, native_hz, heavy) if lasts_s < SETTLED_S else Figures(0.0, 0.0)
        if status.rate_hz:
            bits = status.bits_per_s / status.rate_hz
        if isinstance(line, Samples):
            native_hz = line.native_hz or native_hz
        elif lasts_s >= SETTLED_S:
            native_hz = status.rate_hz
        self._known[topic] = (bits, native_hz)
        return Figures(bits, native_hz, heavy)

    @property
    def topic(self):
        """The topic that is received, or was last; '' before the first."""
        with self._changed:
            return self._topic

    def take(self):
        """Return the newest :class:`Frame` since the last call, or None."""
        session = self._session
        return session.take() if session is not None else None

    def status(self):
        """Return the :class:`StreamStatus` of this moment."""
        session = self._session
        return session.status(self._clock()) if session is not None else StreamStatus()

    def age_s(self):
        """Return the age of the newest good picture [s], None before the first."""
        return self.status().age_s

    def transports(self):
        """Return the names of the available transports, best first; [] while closed."""
        with self._changed:
            return list(dict.fromkeys(offer.transport for offer in self._offers))

    def choose(self, transport):
        """Switch to a transport: 'auto' or a name of :meth:`transports`."""
        with self._changed:
            self._transport = transport
            self._changed.notify_all()

    def _find(self):
        """Hold the required subscription (the thread); return once none is required."""
        served = None
        while True:
            with self._changed:
                depends = session, transport, grant = self._dependencies()
                if session is None and self._line is None and not self._watched:
                    self._finder = None
                    return
            if (self._line or self._watched) and (session is not served or grant.rate_hz == 0.0):
                self._watch(())
                self._hold(None)
                continue
            if session is not served:
                served, self._speakers = session, Speakers()
            if grant.rate_hz != 0.0:
                self._look_guarded(session, AUTO if grant.lighter else transport, grant)
            self._rest(depends)

    def _dependencies(self):
        """Return the values that determine the subscription."""
        return self._session, self._transport, self._grant

    def _look_guarded(self, session, transport, grant):
        try:
            self._look(session, transport, grant)
        except MasterError as error:
            session.explain(str(error))
        except Exception as error:  # the guard of this thread
            rospy.logerr_throttle(5.0, '{}: looking for its camera: {!r}'.format(
                self.robot, error))
            session.explain('cannot look for the camera: {}'.format(error))

    def _rest(self, depends):
        """Wait until the next query is due, or the required subscription has changed."""
        look_s = LOOK_AGAIN_S if depends[0].is_receiving(self._clock()) and not self._watched \
            else LOOK_S
        with self._changed:
            if self._dependencies() == depends:
                self._changed.wait(look_s)

    def _hold(self, make, *args):
        """Close the present subscription, and make another unless ``make`` is None."""
        with self._changed:
            line, self._line = self._line, None
            self._changed_at = self._clock()
        if line is not None:
            _unsubscribe(line)
        line = make(*args) if make else None
        with self._changed:
            self._line, self._changed_at = line, self._clock()
            self._topic = line.topic if line else self._topic
        if line is not None:
            self._speakers.hold(line.topic, self._changed_at)

    def _watch(self, offers):
        """Subscribe these offers beside the one that is received, and no others any more."""
        wanted = {offer.topic: offer for offer in offers}
        for topic in [topic for topic in self._watched if topic not in wanted]:
            session, line = self._watched.pop(topic)
            session.end()
            _unsubscribe(line)
        for topic, offer in wanted.items():
            if topic not in self._watched and reachable(rospy.get_name(), topic):
                session = self.new_session(lambda: (None, 1.0 / LOOK_S))
                make, *args = self.line_of(session, offer, session.receive)
                self._watched[topic] = session, make(*args)

    def _look(self, session, transport, grant):
        """Query the master; hold the matching subscription, or none.

        :raises MasterError: the master cannot be reached
        """
        published = dict(MasterApi(rospy.get_name()).call('getPublishedTopics', self._below))
        offers = self.find_offers(published)
        with self._changed:
            self._offers = offers if self._session is session else []
        now, line = self._clock(), self._line
        heard = [topic for topic, (one, _) in self._watched.items() if one.is_receiving(now)]
        if line and session.is_receiving(now, self._changed_at):
            heard.append(line.topic)
        for topic in heard:
            self._speakers.heard(topic, now)
        offer, silent = self._speakers.choose(offers, transport, now)
        if offer is None:
            session.explain(*self._why_nothing(transport, offers, published))
            if line and not may_carry(self.kind, transport, line.topic):
                self._hold(None)
        elif grant.sampled:
            if not (line and line.topic == offer.topic
                    and getattr(line, 'rate_hz', None) == grant.rate_hz):
                native_hz = self._known.get(offer.topic, (None, None))[1]
                self._hold(*self.samples_of(
                    session, offer, self._relaying(session, offer), grant, native_hz))
        elif not (isinstance(line, Subscription) and line.topic == offer.topic):
            self._subscribe(session, offer)
        self._watch(silent)
        session.source = '\n'.join([offer.topic if offer else ''] + [
            '{} sends no picture'.format(one.topic) for one in silent])

    def _subscribe(self, session, offer):
        """Switch to an offer if its publisher answers."""
        if not reachable(rospy.get_name(), offer.topic):
            session.explain(*no_answer(offer.topic))
            self._speakers.skip(offer.topic)
            return
        session.explain('no {} has come yet'.format(self.word), 'waiting for ' + offer.topic)
        self._hold(*self.line_of(session, offer, self._relaying(session, offer)))

    def _why_nothing(self, transport, offers, published):
        """Return why there is nothing to subscribe to, also in terms of ROS."""
        if offers:
            return '{} offers {}, not {}'.format(
                self.robot, ', '.join(offer.transport for offer in offers), transport), ''
        others = [topic for topic in likely_topics(
            self.kind, RAW_TYPE, own_topics(self.robot, published))
                  if self._below + topic not in self._topics]
        if self._below and others:
            return 'no {} under its name'.format(self.word), '; to use one: '.join(
                choice_words(self.robot, self.kind, others))
        return 'no {}; is its driver running?'.format(self.word), \
            'nobody publishes ' + (' or '.join(self._topics) or 'a picture')


def _unsubscribe(subscription):
    """Unsubscribe."""
    try:
        subscription.close()
    except Exception as error:  # rospy raises various types while it shuts down
        rospy.logwarn('%s: unsubscribing: %r', subscription.topic, error)
