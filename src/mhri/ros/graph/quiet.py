# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What rospy logs over and over, once a second.

A message whose bytes are none of its type costs a traceback or two each time, and so does one that
a callback cannot deal with: dozens a second hide what an operator has to read, and fill the disk.
"""
import logging
import time

EVERY_S = 1.0
_MOST_KEYS = 200
_LONGEST_KEY = 200
# So much of a line is looked at, at both ends.
_LOOKED_AT = 500
# rospy.msg, deserialize_messages; rospy.impl.tcpros_base, receive_once and receive_loop;
# rospy.topics, _invoke_callback.
_REPEATED = ('cannot deserialize', 'error deserializing incoming request', 'bad callback')
# Those that rospy logs with.
_LOGGERS = ('rosout', 'rospy.internal', 'rospy.msg')


class OncePerSecond(logging.Filter):
    """Lets a line that comes with every message through once a second; all others always.

    :param clock: seconds, monotonic
    """

    def __init__(self, clock=time.monotonic):
        super().__init__()
        self._clock = clock
        self._passed = {}

    def filter(self, record):
        """Tell whether a record is to be logged."""
        text = record.getMessage()
        looked_at = text[:_LOOKED_AT] + text[-_LOOKED_AT:]
        words = next((words for words in _REPEATED if words in looked_at), None)
        if words is None:
            return True
        # A topic in brackets stands before the words, a callback's name behind them.
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
    """Filter what rospy logs in this program; once is enough, more do no harm."""
    for name in _LOGGERS:
        logger = logging.getLogger(name)
        if not any(isinstance(known, OncePerSecond) for known in logger.filters):
            logger.addFilter(OncePerSecond())
