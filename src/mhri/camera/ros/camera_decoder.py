# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Decodes the newest picture of one stream, between the network and the screen."""
import math
import threading

import rospy

from mhri.base.text import tidy_text
from mhri.camera.budget import AS_IT_COMES
from mhri.camera.depth_colour import DepthColour
from mhri.camera.images import DEPTH, FrameError, OLD_AFTER_S, StreamStatus
from mhri.camera.ros.pictures import read_picture
from mhri.camera.shades import Shades
from mhri.camera.stream_meter import StreamMeter, WINDOW_S

SILENT_S = 2.0
# A thinned stream is late once this many pictures are missing.
_MISSED = 2.5


class Decoder:
    """Decodes the newest message of one stream on a thread of its own, and keeps the figures.

    It lives from the opening of a feed to its closing.

    :param name: the owner of the pictures, for the log
    :param kind: 'rgb' or 'depth'
    :param wanted: function that returns ((width, height) [pixels] or None, maximum rate [Hz] or
        None); called on the decoder's thread
    :param clock: function that returns seconds, monotonic
    """

    def __init__(self, name, kind, wanted, clock):
        self._name = name
        self._kind = kind
        self._wanted = wanted
        self._clock = clock
        self._colour = DepthColour() if kind == DEPTH else Shades()
        self._changed = threading.Condition()
        self._ended = False
        self._message = self._last = None
        self._frame = None
        self._meter = StreamMeter()
        self._transport = ''
        self._good_at = self._bad_at = None
        self._shown = self._bad = 0
        self._problem = self._hint = self._detail = ''
        #: the received topic, and the better ones that are silent
        self.source = ''
        self._grant = AS_IT_COMES
        self._period_s = 0.0
        threading.Thread(target=self._run, daemon=True, name='camera ' + name).start()

    def receive(self, message_type, data):
        """Store the newest message (rospy's thread)."""
        now = self._clock()
        with self._changed:
            if not self._ended:
                self._message = (message_type, data, now)
                self._meter.add(now, len(data))
                self._changed.notify_all()

    def wake(self):
        """Decode the last message once more, e.g. at another size: the next one may be late."""
        with self._changed:
            self._message = self._message or self._last
            self._changed.notify_all()

    def expect(self, grant):
        """Set the :class:`mhri.camera.budget.Grant` of the stream."""
        with self._changed:
            self._grant = grant
            self._period_s = 1.0 / grant.rate_hz if grant.rate_hz else 0.0
            self._meter.set_window(max(WINDOW_S, _MISSED * self._period_s))
            self._changed.notify_all()

    def explain(self, hint, detail=''):
        """Set why nothing is received, in plain words and in terms of ROS; '' if it should be."""
        with self._changed:
            self._hint, self._detail = tidy_text(hint), tidy_text(detail)

    def is_receiving(self, now, since=-math.inf):
        """Return whether pictures are being received, with one received after ``since``."""
        with self._changed:
            return self._good_at is not None and self._good_at >= since and (
                now - self._good_at < max(SILENT_S, _MISSED * self._period_s))

    def end(self):
        """Stop the decoder, and drop its messages and frame."""
        with self._changed:
            self._ended = True
            self._message = self._last = self._frame = None
            self._changed.notify_all()

    def take(self):
        """Return the newest frame, each frame once."""
        with self._changed:
            frame, self._frame = self._frame, None
            self._shown += frame is not None
            return frame

    def status(self, now):
        """Return the :class:`StreamStatus`."""
        with self._changed:
            rate_hz, bits_per_s = self._meter.read(now)
            age = None if self._good_at is None else now - self._good_at
            bad_since = self._bad_at is not None and (
                self._good_at is None or self._bad_at > self._good_at)
            old_after_s = max(OLD_AFTER_S, _MISSED * self._period_s)
            return StreamStatus(
                self._transport, rate_hz, age, bits_per_s, self._shown, self._bad,
                self._grant.words if self._grant.rate_hz == 0.0 else self._hint or self._problem,
                age is not None and (bad_since or age > old_after_s),
                self._grant.words, old_after_s, self._detail, self.source)

    def _run(self):
        """Decode the newest message whenever one is due (the decoder's thread)."""
        last = self._clock() - 1.0
        while True:
            message, view, last = self._next(last)
            if message is None:
                return
            self._decode(message, view)
            del message  # release its memory while waiting for the next

    def _decode(self, message, view):
        """Decode one message; if that fails, count it and store the reason."""
        message_type, data, received_s = message
        try:
            frame, transport = self.read(message_type, data, view, received_s)
        except FrameError as error:
            self._note_bad(str(error), received_s)
        except Exception as error:  # the guard of this thread
            rospy.logerr_throttle(1.0, '{}: a picture could not be decoded: {!r}'.format(
                self._name, error))
            self._note_bad('cannot be decoded: {!r}'.format(error), received_s)
        else:
            self._note_good(frame, transport)

    def read(self, message_type, data, view, received_s):
        """Return (the content of a message, its transport in words).

        :raises FrameError: it cannot be decoded
        """
        return read_picture(self._kind, message_type, data, view, self._colour, received_s)

    def _next(self, last):
        """Wait for a message and until it is due.

        :param last: due time of the previous one [s]
        :returns: (message, None at the end; view; its due time [s])
        """
        with self._changed:
            while not self._ended:
                view, max_hz = self._wanted()
                now = self._clock()
                due = last + 1.0 / max_hz if max_hz else now
                if self._message is not None and now >= due:
                    message, self._message = self._message, None
                    self._last = message
                    # Count from its due time, not from now: otherwise small delays would add up
                    # and reduce the rate.
                    return message, view, max(due, now - (due - last))
                self._changed.wait(None if self._message is None else due - now)
            return None, None, last

    def _note_bad(self, problem, received_s):
        with self._changed:
            self._bad += 1
            self._bad_at = received_s
            # The problem quotes the message, which may contain any text.
            self._problem = tidy_text(problem)
            self._hint = ''

    def _note_good(self, frame, transport):
        with self._changed:
            if not self._ended:
                self._frame, self._transport = frame, transport
                self._good_at = frame.received_s
                self._hint = ''
