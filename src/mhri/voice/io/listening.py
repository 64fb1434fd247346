# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The process for speech recognition, a :class:`Child`.

Recognition takes tenths of a second during which pocketsphinx blocks all other threads of its
process, and the zero that ends a spoken motion must not wait for that. It therefore has a separate
process, which :class:`mhri.voice.io.voice.VoiceReader` starts and ends.

The process receives orders and sends events. The first order is ``{"source": text,
"language": path, "robots": [names], "accessories": [rows], "voice": path or ""}``, later ones
``{"robots": [names], "accessories": [rows]}``, the rows as in :mod:`mhri.voice.accessories`; the
process ends at the end of the orders. Events are ``{"kind": ...}`` with one of these kinds:

- ``open`` (``device``, ``notes``, ``robots``, ``accessories``, ``words``), again after each change
  of robots or accessories
- ``absent`` or ``lost`` (``reason``): the process ends
- ``began``, ``spotted`` (``word``)
- ``ended`` (``text``, ``confidence``, ``age_s``: time since the utterance began, ``spoken_s``:
  end of the pause after it [s, monotonic], however long the sound waited to be read,
  ``computed_s``: processor time of its recognition, ``spoken_on``: whether the sound received
  meanwhile contains speech)
"""
import importlib.util
import os
import time

from mhri.base.config import ConfigError
from mhri.devices.io.child import parent
from mhri.devices.io.reader import DeviceAbsent, DeviceLost
from mhri.voice.adaptation import ModelError
from mhri.voice.io.audio import open_source
from mhri.voice.language import parse_language
from mhri.voice.sound import MODEL


def missing():
    """Return the missing part of pocketsphinx, '' if none is missing, without loading it."""
    if importlib.util.find_spec('pocketsphinx') is None:
        return 'pocketsphinx is not installed: install python3-pocketsphinx'
    if not os.path.isdir(MODEL):
        return 'the model {} is not installed: install pocketsphinx-en-us'.format(MODEL)
    return ''


def begin(first, send):
    """Open the source of the first order; return the :class:`mhri.voice.io.session.Session`.

    :raises DeviceAbsent: the source or the recogniser is unavailable
    """
    if missing():
        raise DeviceAbsent(missing())
    source, opened_s = open_source(first['source']), time.monotonic()
    device = source.open()
    # Imported late: loading takes a second of a core, and the search for a microphone repeats once
    # a second.
    from mhri.voice.io.recogniser import RecogniserError
    from mhri.voice.io.session import Session
    from mhri.voice.io.teaching import check_voice
    try:
        with open(first['language'], encoding='utf-8') as stream:
            language = parse_language(stream.read(), first['language'])
        if first['voice']:
            check_voice(first['voice'])
        return Session(language, source, device, first['robots'], first['voice'],
                       opened_s, send, first['accessories'])
    except (RecogniserError, ConfigError, ModelError, OSError) as reason:
        source.close()
        raise DeviceAbsent(str(reason))


def listen(orders, send):
    """Listen until the source or the orders end.

    :param orders: :class:`mhri.devices.io.child.Channel`
    :raises EOFError: the orders have ended
    """
    first = {}
    while 'source' not in first:
        first = orders.messages(None)[-1]
    try:
        session = begin(first, send)
    except DeviceAbsent as reason:
        send({'kind': 'absent', 'reason': str(reason)})
        return
    try:
        while True:
            for order in orders.messages():
                session.set_robots(order['robots'], order['accessories'])
            session.step()
    except DeviceLost as reason:
        session.finish()
        send({'kind': 'lost', 'reason': str(reason)})


def main():
    """Run until the source or the orders end."""
    node = parent()

    def send(event):
        """Send one event."""
        node.send(event, wait=True)

    try:
        listen(node, send)
    except (EOFError, BrokenPipeError, KeyboardInterrupt):
        # The node has ended or is ending.
        os._exit(0)
    except Exception as error:  # the guard of this process: reported in the diagnostics of the node
        send({'kind': 'lost', 'reason': 'recognising failed: {}: {}'.format(
            type(error).__name__, error)})
