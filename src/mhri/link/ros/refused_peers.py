# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Logs refused connections, which zenoh reports only in its own verbose log."""
import os
import sys
import threading
import time

import rospy

from mhri.base.text import tidy_text

# Period of the lines of each kind [s]: repeated attempts must not fill the disk.
EVERY_S = 10.0
_ASKED = ('off,zenoh_link_tls::unicast=warn,'
          'zenoh::net::routing::interceptor::access_control=info')
# Text in zenoh's log, and its meaning; the last row is for the rest.
_MEANS = (
    ('sent no certificates', 'refused a connection without a key'),
    ('did not match any configured ACL subject',
     'refused a key that is withdrawn, not on the list here (put the keys in place again), or for '
     'another purpose'),
    ('NotValidYet', 'refused a key that is not valid yet: the clock of this robot is wrong, or '
     'was wrong where the key was made'),
    ('Expired', 'refused an expired key'),
    ('UnknownIssuer', 'refused a key of another authority'),
    ('BadSignature', 'refused a key of another authority'),
    ('UnknownCA', 'a peer with keys of another authority called'),
    ('certificate', 'refused a malformed key'),
    ('zenoh_link_', 'refused a caller without TLS'))


def meaning(line):
    """Return the meaning of a line of zenoh's log, '' unless about a refused connection."""
    if 'multiple network interfaces' in line:
        return ''
    return next((words for part, words in _MEANS if part in line), '')


class RefusalLog:
    """Reports each kind of refusal once per period.

    :param report: called with a sentence
    """

    def __init__(self, report, clock=time.monotonic):
        self._report = report
        self._clock = clock
        self._reported_at = {}

    def on_line(self, line):
        """Handle a line; return whether it came from zenoh."""
        if 'zenoh' not in line:
            # The remainder of a line, after a line break in the name of a peer.
            return False
        words, now = meaning(line), self._clock()
        if words and now - self._reported_at.get(words, -EVERY_S) >= EVERY_S:
            self._reported_at[words] = now
            self._report(words)
        return True


def log_refused_peers(zenoh, name):
    """Log refused connections to a robot's link, once per kind in 10 s.

    zenoh only writes to the standard output of the process, which is filtered here.
    """
    reader, writer = os.pipe()
    out = os.fdopen(os.dup(1), 'w', buffering=1)
    os.dup2(writer, 1)
    os.close(writer)
    sys.stdout = out
    refusals = RefusalLog(lambda words: rospy.logwarn('%s: %s', name, words))

    def read():
        """Read until the end of the process."""
        with os.fdopen(reader, errors='replace') as lines:
            for line in lines:
                if not refusals.on_line(line):
                    # Text from peers must not reach a terminal with escape sequences.
                    out.write(tidy_text(line.rstrip('\n')) + '\n')
    threading.Thread(target=read, name='refusals', daemon=True).start()
    zenoh.init_log_from_env_or(_ASKED)
