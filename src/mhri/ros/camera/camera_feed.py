# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""One camera of one robot: found, subscribed, decoded at the size shown, newest picture only.

While it is open it has two threads: one finds the topic and holds the subscription, the other
decodes. Closed, it has none, and nothing arrives from the network.
"""
import threading
import time

import rospy

from mhri.core.camera.images import StreamStatus
from mhri.core.robots.names import topic_of
from mhri.core.camera.transports import AUTO, choose_offer, find_offers, may_carry
from mhri.ros.camera.camera_decoder import Decoder
from mhri.ros.graph.master_api import MasterApi, MasterError
from mhri.ros.graph.subscription import Subscription, reachable

LOOK_S = 1.0           # between looks at the master while nothing comes
LOOK_AGAIN_S = 5.0     # ... and while pictures come: a better transport may turn up


class CameraFeed:
    """A camera's pictures, for a widget that asks for them on a timer.

    Subscribes ``/<robot>/<topic>/compressed`` (depth: ``.../compressedDepth``), type
    ``sensor_msgs/CompressedImage``, or ``/<robot>/<topic>``, type ``sensor_msgs/Image``: the first
    that is published. No method but :meth:`close` with a wait blocks; all may be called from any
    thread.

    :param robot: namespace of the robot
    :param topics: camera topics relative to it, in order of preference, without transport
    :param kind: 'rgb' or 'depth'
    :param transport: 'auto', or a name of :meth:`transports`
    :param depth_range_m: (near, far) of the colours [m]; None: as the scene has it
    """

    @classmethod
    def of(cls, robot, kind, key):
        """Return the feed of a camera (``key``: 'rgb' or 'depth'), None for a type without it."""
        topics = getattr(kind, key)
        return cls(robot, topics, key) if topics else None

    def __init__(self, robot, topics, kind, transport=AUTO, clock=time.monotonic,
                 depth_range_m=None):
        self.robot = robot
        self.kind = kind
        self._topics = [topic_of(robot, topic) for topic in topics]
        self._transport = transport
        self._clock = clock
        self._depth_range = depth_range_m
        self._changed = threading.Condition()
        self._finder = None
        self._session = None
        self._wanted = (None, None)
        self._offers = []

    def open(self):
        """Begin to look for the camera and to decode; returns at once."""
        with self._changed:
            if self._session is not None:
                return
            self._session = self.new_session(lambda: self._wanted)
            if self._finder is None:
                # One that is still giving a topic back to the master goes on with this instead.
                self._finder = threading.Thread(target=self._find, daemon=True,
                                                name='camera finder ' + self.robot)
                self._finder.start()
            self._changed.notify_all()

    def new_session(self, wanted):
        """Return the :class:`Decoder` of one opening; ``wanted`` is for it."""
        return Decoder(self.robot, self.kind, wanted, self._clock, self._depth_range)

    def find_offers(self, published):
        """Return the offers, best first, among {topic: type} of what is published."""
        return find_offers(self.kind, self._topics, published)

    def subscribe(self, session, offer):
        """Return a subscription to an offer, for a session (blocking)."""
        return Subscription(offer.topic, session.hear)

    def close(self, wait_s=0.0):
        """Decode nothing more and give the topic back; the latter on the feed's own thread.

        :param wait_s: wait at most so long for it [s]
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
        """Say how large [pixels] and how often [Hz] pictures are wanted; None: as they come."""
        wanted = ((width, height) if width and height else None, max_hz)
        changed, self._wanted = wanted != self._wanted, wanted
        session = self._session
        if session is not None and changed:
            session.wake()

    def take(self):
        """Return the newest :class:`Frame`, None where there is no new one since the last call."""
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
        """Return the names of the transports on offer now, best first; [] while not open."""
        with self._changed:
            return list(dict.fromkeys(offer.transport for offer in self._offers))

    def choose(self, transport):
        """Listen to another transport from now on: 'auto' or a name of :meth:`transports`."""
        with self._changed:
            self._transport = transport
            self._changed.notify_all()

    def _find(self):
        """Hold the subscription that is wanted; the thread ends when none is."""
        subscription = served = None
        while True:
            with self._changed:
                session, transport = self._session, self._transport
                if session is None and subscription is None:
                    self._finder = None
                    return
            if subscription is not None and session is not served:
                subscription = _give_back(subscription)
                continue
            served = session
            try:
                subscription = self._look(session, subscription, transport)
            except MasterError as error:
                session.explain(str(error))
            except Exception as error:  # the guard of this thread
                rospy.logerr_throttle(5.0, '{}: looking for its camera: {!r}'.format(
                    self.robot, error))
                session.explain('cannot look for the camera: {}'.format(error))
            self._rest(session, transport)

    def _rest(self, session, transport):
        """Wait until it is time for another look, or something is to be done."""
        look_s = LOOK_AGAIN_S if session.hears(self._clock()) else LOOK_S
        with self._changed:
            if self._session is session and self._transport == transport:
                self._changed.wait(look_s)

    def _look(self, session, subscription, transport):
        """Look at the master; return the subscription that is right now, or None.

        :raises MasterError: the master cannot be reached
        """
        published = dict(MasterApi(rospy.get_name()).call('getPublishedTopics', '/' + self.robot))
        offers = self.find_offers(published)
        with self._changed:
            self._offers = offers if self._session is session else []
        offer = choose_offer(offers, transport)
        if offer is None:
            session.explain(self._nothing(transport, offers))
            if subscription and not may_carry(self.kind, transport, subscription.topic):
                return _give_back(subscription)
        elif subscription is None or subscription.topic != offer.topic:
            return self._subscribe(session, subscription, offer)
        return subscription

    def _subscribe(self, session, subscription, offer):
        """Change over to an offer where its sender answers; return the subscription in force."""
        if not reachable(rospy.get_name(), offer.topic):
            session.explain('{} is registered, but its sender does not answer'.format(offer.topic))
            return subscription
        if subscription is not None:
            _give_back(subscription)
        session.explain('nothing has come on {} yet'.format(offer.topic))
        return self.subscribe(session, offer)

    def _nothing(self, transport, offers):
        """Say why there is nothing to subscribe."""
        if offers:
            return '{} offers {}, not {}'.format(
                self.robot, ', '.join(offer.transport for offer in offers), transport)
        return 'nobody publishes {}'.format(' or '.join(self._topics) or 'a picture')


def _give_back(subscription):
    """Unsubscribe; return None, the subscription there is then."""
    try:
        subscription.close()
    except Exception as error:  # rospy raises all sorts while it shuts down
        rospy.logwarn('%s: unsubscribing: %r', subscription.topic, error)
    return None
