# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Limits repeated log lines of rospy to one per second.

A message whose bytes do not fit its type logs one or two tracebacks each time, as does one that a
callback cannot handle: dozens a second hide important lines, and fill the disk.
"""
import logging
import time

EVERY_S = 1.0
_MAX_KEYS = 200
_LONGEST_KEY = 200
# Number of characters examined at each end of a line.
_LOOKED_AT = 500
# rospy.msg, deserialize_messages; rospy.impl.tcpros_base, receive_once and receive_loop;
# rospy.topics, _invoke_callback; and of mhri.graph.ros.peers.
_REPEATED = ('cannot deserialize', 'error deserializing incoming request', 'bad callback',
             'a message was not read')
# The loggers of rospy.
_LOGGERS = ('rosout', 'rospy.internal', 'rospy.msg')


class OncePerSecond(logging.Filter):
    """Passes lines that repeat with every message once a second, and all others always.

    :param clock: function that returns monotonic seconds
    """

    def __init__(self, clock=time.monotonic):
        super().__init__()
        self._clock = clock
        self._passed = {}

    def filter(self, record):
        """Return whether to log a record."""
        text = record.getMessage()
        looked_at = text[:_LOOKED_AT] + text[-_LOOKED_AT:]
        words = next((words for words in _REPEATED if words in looked_at), None)
        if words is None:
            return True
        # The text follows a topic in brackets and precedes a callback's name.
        key = (record.name, words, text[:_LONGEST_KEY].partition('\n')[0].partition(words)[
            2 if text.startswith('bad') else 0])
        now = self._clock()
        if now - self._passed.get(key, now - EVERY_S) < EVERY_S:
            return False
        if len(self._passed) >= _MAX_KEYS:
            self._passed.clear()
        self._passed[key] = now
        return True


def quiet_repeats():
    """Filter rospy's log lines in this program; further calls have no effect."""
    for name in _LOGGERS:
        logger = logging.getLogger(name)
        if not any(isinstance(known, OncePerSecond) for known in logger.filters):
            logger.addFilter(OncePerSecond())
