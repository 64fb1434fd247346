# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Limits what rospy logs over and over to once a second.

A message whose bytes do not fit its type costs a traceback or two each time, and so does one that a
callback cannot handle: dozens a second hide what an operator must read, and fill the disk.
"""
import logging
import time

EVERY_S = 1.0
_MOST_KEYS = 200
_LONGEST_KEY = 200
# So many characters of a line are examined, at both ends.
_LOOKED_AT = 500
# rospy.msg, deserialize_messages; rospy.impl.tcpros_base, receive_once and receive_loop;
# rospy.topics, _invoke_callback; and of mhri.graph.ros.peers.
_REPEATED = ('cannot deserialize', 'error deserializing incoming request', 'bad callback',
             'a message was not read')
# The loggers of rospy.
_LOGGERS = ('rosout', 'rospy.internal', 'rospy.msg')


class OncePerSecond(logging.Filter):
    """Passes a line that comes with every message once a second, and all others always.

    :param clock: seconds, monotonic
    """

    def __init__(self, clock=time.monotonic):
        super().__init__()
        self._clock = clock
        self._passed = {}

    def filter(self, record):
        """Tell whether to log a record."""
        text = record.getMessage()
        looked_at = text[:_LOOKED_AT] + text[-_LOOKED_AT:]
        words = next((words for words in _REPEATED if words in looked_at), None)
        if words is None:
            return True
        # A topic in brackets precedes the words, a callback's name follows them.
        key = (record.name, words, text[:_LONGEST_KEY].partition('\n')[0].partition(words)[
            2 if text.startswith('bad') else 0])
        now = self._clock()
        if now - self._passed.get(key, now - EVERY_S) < EVERY_S:
            return False
        if len(self._passed) >= _MOST_KEYS:
            self._passed.clear()
        self._passed[key] = now
        return True


def quiet_repeats():
    """Filter what rospy logs in this program; further calls do no harm."""
    for name in _LOGGERS:
        logger = logging.getLogger(name)
        if not any(isinstance(known, OncePerSecond) for known in logger.filters):
            logger.addFilter(OncePerSecond())
