# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""On the robot: serves the recordings of outages to one host."""
import threading
import time

import rospy

from mhri.link.records import (
    MAX_STEPS, OFFER, pack_offer, pack_part, PART, RECORD, STEP_BYTES, unpack_ask)
from mhri.link.ros.keeper import keeper_of

TICK_S = 0.5
# Fraction of the rate of a limited radio for recordings.
SHARE = 0.15
# Maximum pause after a part on a limited radio [s].
PAUSE_S = 2.0


class RobotRecord:
    """Answers requests, and updates the keeper, on its own thread, since the disk may block.

    :param side: side of the link to the host
    :param topics: returns the absolute names of the topics to record; with pictures if it is
        called with True
    """

    def __init__(self, side, topics):
        self._side = side
        self._topics = topics
        self._keeper = keeper_of(side.name)
        self._ask = None
        self._keep = self._pictures = False
        self._asked = threading.Event()

    def start(self):
        """Start the thread."""
        threading.Thread(target=self._run, name='record', daemon=True).start()

    def on_ask(self, body):
        """Handle a request; only the newest counts.

        :raises FrameError: it is malformed
        """
        self._ask = unpack_ask(body)
        self._asked.set()

    def _run(self):
        ticked_at = 0.0
        while not self._side.ended():
            self._asked.wait(TICK_S)
            self._asked.clear()
            try:
                self._answer()
                now = self._side.clock()
                if now - ticked_at >= TICK_S:
                    ticked_at = now
                    self._keeper.request(self, self._keep, self._side.peer.is_live(now),
                                         self._pictures)
                    self._keeper.tick(self._topics(self._keeper.pictures_too()))
            except Exception as error:  # a full disk, a missing master: the link continues
                if not self._side.ended():
                    rospy.logwarn_throttle(10.0, '{}: cannot record: {!r}'.format(
                        self._side.name, error))

        self._keeper.forget(self)

    def keeps(self):
        """Return whether to record for this host."""
        return self._keep

    def _answer(self):
        ask, self._ask = self._ask, None
        if ask is None:
            return
        self._keep, self._pictures = ask.keep, ask.pictures
        self._keeper.drop(ask.have)
        pieces = self._keeper.pieces()
        if ask.number < 0 or ask.have or all(piece.number != ask.number for piece in pieces):
            self._side.send(OFFER, RECORD, pack_offer(pieces))
        bytes_per_s = SHARE * self._side.thinned.bytes_per_s
        steps = min(ask.count, 1 if bytes_per_s else MAX_STEPS)
        data = self._keeper.read(ask.number, ask.offset, steps * STEP_BYTES)
        if data:
            self._side.send(PART, RECORD, pack_part(ask.number, ask.offset, data))
            if bytes_per_s:
                time.sleep(min(PAUSE_S, len(data) / bytes_per_s))
