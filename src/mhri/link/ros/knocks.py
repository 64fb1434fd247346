# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Who knocked at the link and was not let in: zenoh says it on its own log alone, and at length."""
import os
import sys
import threading
import time

import rospy

from mhri.base.text import tidy_text

# Of each kind one line in so long [s]: who knocks in a loop must not fill the disk.
EVERY_S = 10.0
_ASKED = ('off,zenoh_link_tls::unicast=warn,zenoh_link_quic::unicast=warn,'
          'zenoh::net::routing::interceptor::access_control=info')
# What zenoh writes, and what it means; the last one is for the rest.
_MEANS = (
    ('sent no certificates', 'somebody without a key was not let in'),
    ('did not match any configured ACL subject',
     'somebody was not let in whose key is withdrawn, not on the list here (put the keys in place '
     'again), or for something else'),
    ('NotValidYet', 'somebody was not let in whose key is good from later on: a clock is wrong, '
     'that of this robot or that of who made the key'),
    ('Expired', 'somebody was not let in whose key has run out'),
    ('UnknownIssuer', 'somebody was not let in with a key of another authority'),
    ('BadSignature', 'somebody was not let in with a key of another authority'),
    ('UnknownCA', 'somebody with keys of another authority called'),
    ('certificate', 'somebody was not let in with a key that is none'),
    ('zenoh_link_', 'somebody called who does not speak TLS'))


def meaning(line):
    """Return what a line of zenoh's log means, '' for one that is not about somebody knocking."""
    if 'multiple network interfaces' in line:
        return ''
    return next((words for part, words in _MEANS if part in line), '')


class Knocks:
    """Says each kind of knock once in a while.

    :param tell: called with a sentence
    """

    def __init__(self, tell, clock=time.monotonic):
        self._tell = tell
        self._clock = clock
        self._told_at = {}

    def on_line(self, line):
        """Take in a line; return whether it was one of zenoh's."""
        if 'zenoh' not in line:
            # The rest of one that a caller made longer, by a line break in its name.
            return False
        words, now = meaning(line), self._clock()
        if words and now - self._told_at.get(words, -EVERY_S) >= EVERY_S:
            self._told_at[words] = now
            self._tell(words)
        return True


def tell_knocks(zenoh, name):
    """Write into the log, once for each kind in 10 s, who was not let in at a robot's link.

    zenoh writes on the standard output of the process, and nowhere else: that is read here first.
    """
    reader, writer = os.pipe()
    out = os.fdopen(os.dup(1), 'w', buffering=1)
    os.dup2(writer, 1)
    os.close(writer)
    sys.stdout = out
    knocks = Knocks(lambda words: rospy.logwarn('%s: %s', name, words))

    def read():
        """Read to the end of the process."""
        with os.fdopen(reader, errors='replace') as lines:
            for line in lines:
                if not knocks.on_line(line):
                    # What a caller says goes into no terminal as it is.
                    out.write(tidy_text(line.rstrip('\n')) + '\n')
    threading.Thread(target=read, name='knocks', daemon=True).start()
    zenoh.init_log_from_env_or(_ASKED)
