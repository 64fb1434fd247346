# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The process that listens: ``python3 -m mhri.voice.io.listening <fd of orders>``.

Recognising takes tenths of a second during which pocketsphinx lets no other thread of its process
run, and the zero that ends a spoken motion must not wait for that. So it has a process of its own,
which :class:`mhri.voice.io.voice.VoiceReader` begins and ends.

It reads orders and writes events, both as JSON, one a line. The first order is ``{"source": text,
"language": path, "robots": [names], "voice": path or ""}``, later ones ``{"robots": [names]}``;
where the orders end, so does the process. Events are ``{"kind": ...}`` with one of these kinds:

- ``open`` (``device``, ``notes``, ``robots``, ``words``), again after each change of the robots
- ``absent`` or ``lost`` (``reason``): the process ends
- ``began``, ``spotted`` (``word``)
- ``ended`` (``text``, ``confidence``, ``age_s``: how long ago the utterance began, ``spoken_s``:
  when the pause behind it was over [s, monotonic], however long the sound waited to be read,
  ``computed_s``: how long the processor took to recognise it, ``spoken_on``: somebody speaks in the
  sound that has come meanwhile)
"""
import importlib.util
import json
import os
import select
import sys
import time

from mhri.base.config import ConfigError
from mhri.devices.io.reader import DeviceAbsent, DeviceLost
from mhri.voice.adaptation import ModelError
from mhri.voice.io.audio import open_source
from mhri.voice.language import parse_language
from mhri.voice.sound import MODEL


class Orders:
    """Lines of JSON from a file descriptor, read without waiting."""

    def __init__(self, fd):
        self._fd = fd
        self._held = b''

    def take(self, timeout_s=0.0):
        """Return the orders that have come.

        :raises EOFError: whoever gives them is gone
        """
        if not select.select([self._fd], [], [], timeout_s)[0]:
            return []
        data = os.read(self._fd, 65536)
        if not data:
            raise EOFError
        *lines, self._held = (self._held + data).split(b'\n')
        return [json.loads(line.decode()) for line in lines]


def missing():
    """Say what pocketsphinx lacks here, or return '': looked at without loading it."""
    if importlib.util.find_spec('pocketsphinx') is None:
        return 'pocketsphinx is not installed: install python3-pocketsphinx'
    if not os.path.isdir(MODEL):
        return 'the model {} is not installed: install pocketsphinx-en-us'.format(MODEL)
    return ''


def begin(first, say):
    """Open what the first order names; return the :class:`mhri.voice.io.session.Session`.

    :raises DeviceAbsent: there is nothing to listen to, or nothing to recognise it with
    """
    if missing():
        raise DeviceAbsent(missing())
    source, opened_s = open_source(first['source']), time.monotonic()
    device = source.open()
    # Only now: loading takes a second of a core, and a microphone is looked for once a second.
    from mhri.voice.io.recogniser import RecogniserError
    from mhri.voice.io.session import Session
    from mhri.voice.io.teaching import check_voice
    try:
        with open(first['language'], encoding='utf-8') as stream:
            language = parse_language(stream.read(), first['language'])
        if first['voice']:
            check_voice(first['voice'])
        return Session(language, source, device, first['robots'], first['voice'],
                       opened_s, say)
    except (RecogniserError, ConfigError, ModelError, OSError) as reason:
        source.close()
        raise DeviceAbsent(str(reason))


def listen(orders, say):
    """Listen until the source or the orders end."""
    first = {}
    while 'source' not in first:
        for order in orders.take(None):
            first = order
    try:
        session = begin(first, say)
    except DeviceAbsent as reason:
        say({'kind': 'absent', 'reason': str(reason)})
        return
    try:
        while True:
            for order in orders.take():
                session.set_robots(order['robots'])
            session.step()
    except DeviceLost as reason:
        session.finish()
        say({'kind': 'lost', 'reason': str(reason)})


def main():
    """Run until the source or the orders end."""
    # What PortAudio and ALSA write to the standard output must not look like events.
    events = os.fdopen(os.dup(1), 'w', encoding='utf-8')
    os.dup2(2, 1)

    def say(event):
        """Write one event."""
        events.write(json.dumps(event) + '\n')
        events.flush()

    try:
        listen(Orders(int(sys.argv[1])), say)
    except (EOFError, BrokenPipeError, KeyboardInterrupt):
        # The node has ended, or ends: nobody is left to be told.
        os._exit(0)
    except Exception as error:  # the guard of this process: the node says it in its diagnostics
        say({'kind': 'lost', 'reason': 'recognising failed: {}: {}'.format(
            type(error).__name__, error)})


if __name__ == '__main__':
    main()
