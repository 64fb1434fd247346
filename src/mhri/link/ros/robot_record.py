# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""On the robot: answers one host that fetches what it missed."""
import threading
import time

import rospy

from mhri.link.records import OFFER, pack_offer, pack_part, PART, PART_BYTES, RECORD, unpack_ask
from mhri.link.ros.keeper import keeper_of

TICK_S = 0.5
# Where the radio does not bear everything this share of what it bears is for what was missed.
SHARE = 0.15
# So long one answer may take then [s].
ANSWER_S = 2.0


class RobotRecord:
    """Answers, and tells the keeper what this host wants, on a thread of its own: the disk waits.

    :param side: of the link with the host
    :param topics: function that returns what to record, absolute names: with pictures if it is
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
        """Begin."""
        threading.Thread(target=self._run, name='record', daemon=True).start()

    def on_ask(self, body):
        """Take in what the host says; the newest counts.

        :raises FrameError: it is no such thing
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
                    self._keeper.want(self, self._keep, self._side.peer.heard(now), self._pictures)
                    self._keeper.tick(self._topics(self._keeper.pictures_too()))
            except Exception as error:  # the disk, a master that is gone: the link goes on
                if not self._side.ended():
                    rospy.logwarn_throttle(10.0, '{}: cannot record: {!r}'.format(
                        self._side.name, error))

        self._keeper.forget(self)

    def keeps(self):
        """Tell whether this host wants what it misses."""
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
        count = ask.count if not bytes_per_s else \
            min(ask.count, max(1, int(ANSWER_S * bytes_per_s / PART_BYTES)))
        for part in range(count):
            offset = ask.offset + part * PART_BYTES
            data = self._keeper.read(ask.number, offset, PART_BYTES)
            if not data:
                return
            self._side.send(PART, RECORD, pack_part(ask.number, offset, data))
            if bytes_per_s:
                time.sleep(min(ANSWER_S, len(data) / bytes_per_s))
