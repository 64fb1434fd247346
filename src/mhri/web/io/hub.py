# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What all pages share: the newest of everything, the viewers, the stick.

Values come in by :meth:`Hub.put`, :meth:`Hub.tell` and :meth:`Hub.show_picture` from any thread;
everything else runs on the server's loop.
"""
import asyncio
from collections import deque
from dataclasses import dataclass
import itertools
import threading
import time

from aiohttp import web

from mhri.web.frames import BadFrame, MAX_BYTES, TOO_BIG, VIOLATION
from mhri.web.io.viewer import CLOSE_S, Viewer
from mhri.web.links import DRIVE, LinkError
from mhri.web.pacing import RATE_HZ
from mhri.web.said import frame, NO_PLACES, NO_STATE, picture_frame, placed, PROTOCOL
from mhri.web.seat import CENTRE, Seat

# How often the stick and silent pages are looked after [s]; the least interval of texts of a kind
# and of the node's own state, and the greatest.
TICK_S, OFTEN_S, SELDOM_S = 0.05, 0.2, 1.0
# Events that a new page gets, pictures that are kept, and the age after which one is gone [s].
EVENTS, MAX_PICTURES, PICTURE_S = 50, 64, 10.0
# The longest way there and back to a page that drives [s].
MAX_LAG_S = 1.0
_AGED = {'state': NO_STATE, 'places': NO_PLACES}


class Outputs:
    """What the server asks for; each is called on its loop and must not block."""

    def stick(self, turn, ahead, sideways):
        """Publish the stick."""

    def stop(self, who):
        """Engage stop-all."""

    def head(self, robot, pan, tilt):
        """Turn the head of a robot [rad]."""

    def show(self, links, viewers, pictures_hz, looked_at):
        """Publish the links and viewers, and which pictures are wanted."""

    def keep(self, rows):
        """Keep the links in a file."""

    def log(self, text):
        """Log a line."""


@dataclass(frozen=True)
class Picture:
    """The newest picture of a topic; ``at_s`` is when it came, monotonic."""

    number: int
    robot: str
    topic: str
    kind: str
    data: bytes
    at_s: float


class Hub:
    """The shared state.

    :param book: :class:`mhri.web.links.LinkBook`
    :param outputs: :class:`Outputs`
    :param loop: the server's loop
    """

    def __init__(self, book, outputs, loop):
        self._book, self._outputs, self._loop = book, outputs, loop
        self._lock = threading.Lock()
        self._inbox = {}
        self._counter = itertools.count(1)
        self._values, self._heard_at, self._said_at = {}, {}, {}
        self._events = deque(maxlen=EVENTS)
        self._pictures, self._topics = {}, {}
        self._seat = Seat(time.monotonic)
        self._inactive = 'The drive is not heard.'
        self._shown, self._shown_at, self._drive = None, 0.0, None
        self.viewers = {}
        #: the map as PNG, None without one
        self.map_picture = None

    # From any thread.

    def put(self, key, value):
        """Set a value: ``state``, ``places`` or ``map`` of the protocol."""
        self._hand_over(key, self._set, key, value)

    def put_map(self, value, picture):
        """Set the map's description and its picture (PNG); both None: there is none."""
        self._hand_over('map', self._set_map, value, picture)

    def tell(self, event):
        """Add an event (a dict of the protocol)."""
        self._hand_over('event {}'.format(next(self._counter)), self._add_event, event)

    def show_picture(self, topic, kind, data):
        """Offer a picture to the viewers (kind and bytes of :func:`mhri.web.said.picture_of`)."""
        self._hand_over('picture ' + topic, self._offer, topic, kind, data, time.monotonic())

    def allow(self, problem):
        """Let the page drive, or say why it may not; '' if it may."""
        self._hand_over('allow', self._allow, problem)

    def do(self, job, *args, limit_s=2.0):
        """Run a method of this object on the loop and return its result (blocking).

        :raises TimeoutError: the loop has ended or is busy
        """
        async def run():
            return job(*args)
        return asyncio.run_coroutine_threadsafe(run(), self._loop).result(limit_s)

    def _hand_over(self, key, job, *args):
        with self._lock:
            idle = not self._inbox
            if len(self._inbox) < 1000:
                self._inbox[key] = job, args
        if idle:
            try:
                self._loop.call_soon_threadsafe(self._drain)
            except RuntimeError:  # the server has ended
                return

    # On the loop.

    def _drain(self):
        with self._lock:
            jobs, self._inbox = self._inbox, {}
        for job, args in jobs.values():
            job(*args)

    def _set(self, key, value):
        self._values[key] = value
        self._heard_at[key] = time.monotonic()
        if key == 'state':
            self._topics = {robot['picture']: robot['name'] for robot in value['robots']}
        for one in _AGED:
            if time.monotonic() - self._said_at.get(one, 0.0) >= 0.9 * OFTEN_S:
                self._say(one)

    def _set_map(self, value, picture):
        self.map_picture = picture
        self._values['map'] = value
        self._say('map')

    def _text(self, key):
        if key not in _AGED:
            return frame(key, self._values.get(key))
        heard_at, more = self._heard_at.get(key), {}
        if key == 'places':
            more = {'robots': placed(self._values.get('state', NO_STATE)['robots'])}
        return frame(key, self._values.get(key, _AGED[key]), age_s=None if heard_at is None
                     else time.monotonic() - heard_at, **more)

    def _say(self, key):
        self._said_at[key] = time.monotonic()
        if self.viewers:
            text = self._text(key)
            for viewer in self.viewers.values():
                viewer.say(key, text)

    def _add_event(self, event):
        text = frame('event', event)
        self._events.append(text)
        for viewer in self.viewers.values():
            viewer.tell(text)

    def _robot_of(self, topic):
        """Return the robot whose picture this is, '' of none that the screen lists."""
        first = topic.strip('/').partition('/')[0]
        return self._topics.get(topic) or (first if first in self._topics.values() else '')

    def _offer(self, topic, kind, data, at_s):
        robot = self._robot_of(topic)
        if not robot or len(self._pictures) >= MAX_PICTURES and topic not in self._pictures:
            return
        picture = Picture(next(self._counter), robot, topic, kind, data, at_s)
        self._pictures[topic] = picture
        for viewer in self.viewers.values():
            if viewer.visible:
                viewer.pacing.offer(topic, picture.number, len(data), viewer.look == robot)
                viewer.wake()

    def _frame_of(self, number):
        for picture in self._pictures.values():
            if picture.number == number:
                return picture_frame(number, picture.robot, picture.topic,
                                     time.monotonic() - picture.at_s, picture.kind, picture.data)
        return None

    # Links.

    def link_of(self, token):
        """Return the valid link of a token, None if there is none."""
        return self._book.find(token, time.time())

    def left_s(self, link):
        """Return how long a link is still valid [s]."""
        return max(0.0, link.expires_s - time.time())

    def give(self, label, role, may_stop, head, hours):
        """Return (link, token) of a new link.

        :raises LinkError: see :meth:`mhri.web.links.LinkBook.give`
        """
        found = self._book.give(label, role, may_stop, head, hours, time.time())
        self._outputs.keep(self._book.rows())
        self._show(True)
        return found

    def take(self, name):
        """Take back a link with its viewers, or send one viewer away; by id.

        :raises LinkError: there is neither
        """
        gone = [viewer for viewer in self.viewers.values() if name in (viewer.name, viewer.link.id)]
        if not self._book.take(name) and not gone:
            raise LinkError('there is no link or viewer {!r}'.format(name[:40]))
        for viewer in gone:
            self._send_away(viewer, VIOLATION, 'The operator has taken this link back.')
        self._outputs.keep(self._book.rows())
        self._show(True)

    def viewers_of(self, link):
        """Return how many pages are open by a link."""
        return len([viewer for viewer in self.viewers.values() if viewer.link.id == link.id])

    # Viewers.

    async def serve(self, request):
        """Serve the socket of a page that has a valid link until it is closed."""
        socket = web.WebSocketResponse(autoping=False, timeout=CLOSE_S, max_msg_size=MAX_BYTES,
                                       compress=False)
        await socket.prepare(request)
        viewer = Viewer('v{}'.format(next(self._counter)), request['link'], request.remote or '',
                        socket, request.transport, self._frame_of)
        self.viewers[viewer.name] = viewer
        self._greet(viewer)
        try:
            await viewer.run(self._on_frame)
        except BadFrame as error:
            self._outputs.log('{} ({}) was closed: {}'.format(
                viewer.address, viewer.link.label, error))
            code = socket.close_code if socket.closed else VIOLATION
            self._let_go(viewer, 'a broken frame')
            viewer.end(code or TOO_BIG, str(error))
        finally:
            del self.viewers[viewer.name]
            self._let_go(viewer, '')
            self._show(True)
        await viewer.closed()
        return socket

    def _greet(self, viewer):
        link = viewer.link
        viewer.say('hello', frame('hello', {
            'protocol': PROTOCOL, 'role': link.role, 'may_stop': link.may_stop,
            'head': link.head, 'label': link.label}))
        for key in ('state', 'map', 'places'):
            viewer.say(key, self._text(key))
        for text in self._events:
            viewer.tell(text)
        self._say_drive(viewer)
        for picture in self._pictures.values():
            if time.monotonic() - picture.at_s < PICTURE_S:
                viewer.pacing.offer(picture.topic, picture.number, len(picture.data), False)
        self._show(True)

    def _send_away(self, viewer, code, why):
        self._let_go(viewer, why)
        viewer.end(code, why)

    def _on_frame(self, viewer, key, value):
        getattr(self, '_on_' + key)(viewer, value)

    def _on_ack(self, viewer, number):
        viewer.pacing.ack(number)
        viewer.wake()

    def _on_look(self, viewer, robot):
        viewer.look = robot
        self._show(True)

    def _on_visible(self, viewer, visible):
        viewer.visible = visible
        if not visible:
            viewer.pacing.clear()
            self._let_go(viewer, '')
        self._show(True)

    def _on_stop(self, viewer, _):
        if not viewer.link.may_stop:
            raise BadFrame('this link may not stop')
        self._outputs.log('stop-all by {} ({})'.format(viewer.address, viewer.link.label))
        self._outputs.stop(viewer.link.label)

    def _on_head(self, viewer, value):
        if not viewer.link.head:
            raise BadFrame('this link may not turn a head')
        if viewer.look and viewer.look in self._topics.values():
            self._outputs.head(viewer.look, *value)

    # The stick.

    def _on_hold(self, viewer, hold):
        if viewer.link.role != DRIVE:
            raise BadFrame('this link may not drive')
        if hold:
            self._seat.take(viewer.name, self._problem(viewer))
        else:
            self._let_go(viewer, '')
        self._say_drive(viewer)
        self._tell_drive()

    def _on_stick(self, viewer, values):
        if viewer.link.role != DRIVE:
            raise BadFrame('this link may not drive')
        found = self._seat.stick(viewer.name, values)
        if found is not None:
            self._outputs.stick(*found)

    def _problem(self, viewer):
        """Return why a viewer may not hold the stick now, '' if it may."""
        if viewer.ended or not viewer.visible or viewer.lag_s() > MAX_LAG_S:
            return 'The network is too slow.'
        return self._inactive

    def _let_go(self, viewer, why):
        """End the hold of a viewer, or of whoever holds (None); publish zero at once."""
        if self._seat.leave(viewer and viewer.name, why):
            self._outputs.stick(*CENTRE)
            self._tell_drive()

    def _allow(self, problem):
        self._inactive = problem
        if problem:
            self._let_go(None, problem)
        self._tell_drive()

    def _tell_drive(self):
        shown = self._seat.holder, self._seat.why, self._inactive
        if shown != self._drive:
            self._drive = shown
            for viewer in self.viewers.values():
                self._say_drive(viewer)
            self._show(True)

    def _say_drive(self, viewer):
        holder = self.viewers.get(self._seat.holder or '')
        other = holder is not None and holder is not viewer
        viewer.say('drive', frame('drive', {
            'active': not self._inactive, 'holder': holder.link.label if holder else '',
            'you': holder is viewer,
            'why': self._inactive or ('{} has the stick.'.format(
                holder.link.label or 'Somebody else') if other else self._seat.why)}))

    # Time.

    async def tick(self):
        """Check the stick and the pages periodically; never returns."""
        while True:
            now = time.monotonic()
            holder = self.viewers.get(self._seat.holder or '')
            if self._seat.silent():
                self._let_go(None, 'The stick was not heard.')
            elif holder is not None and holder.lag_s() > MAX_LAG_S:
                self._let_go(holder, 'The network is too slow.')
            for viewer in list(self.viewers.values()):
                viewer.tick(viewer is holder)
                if self.left_s(viewer.link) <= 0.0 and not viewer.ended:
                    self._send_away(viewer, VIOLATION, 'This link has expired.')
            for key in _AGED:
                if now - self._said_at.get(key, 0.0) >= SELDOM_S:
                    self._say(key)
            self._pictures = {topic: one for topic, one in self._pictures.items()
                              if now - one.at_s < PICTURE_S}
            self._show(False)
            await asyncio.sleep(TICK_S)

    def _show(self, changed):
        """Publish what there is: soon after a change, else once a second."""
        now = time.monotonic()
        if changed:
            self._shown = None
        if now - self._shown_at < (OFTEN_S if self._shown is None else SELDOM_S):
            return
        self._shown_at, self._shown = now, True
        viewers = [viewer for viewer in self.viewers.values() if not viewer.ended]
        seen = [viewer for viewer in viewers if viewer.visible]
        looked_at = sorted({viewer.look for viewer in seen} & set(self._topics.values()))
        self._outputs.show(self._book.alive(time.time()), [
            (viewer, viewer.name == self._seat.holder) for viewer in viewers],
            RATE_HZ if seen else 0.0, looked_at)

    async def close(self, code, why):
        """Let go of the stick and close every page."""
        self._let_go(None, why)
        for viewer in list(self.viewers.values()):
            viewer.end(code, why)
        for _ in range(20):
            if not self.viewers:
                return
            await asyncio.sleep(0.05)
