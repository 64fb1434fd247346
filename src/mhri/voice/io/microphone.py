# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The process that reads a microphone, a :class:`Child` whose argument is part of its name.

It sends ``{"device": name}`` or ``{"absent": reason}``, and then blocks of raw sound in the form of
:mod:`mhri.voice.sound`, until the microphone or the receiver is gone. It is a separate process
because recognition blocks for tenths of a second, and PortAudio would drop the sound meanwhile,
which might be a stop.
"""
import os
import sys

from mhri.devices.io.child import parent
from mhri.devices.io.reader import DeviceAbsent
from mhri.voice.sound import BLOCK_BYTES, RATE_HZ


def open_microphone(wanted):
    """Return (stream of PortAudio, name of the device).

    :param wanted: part of the name, in any case; '' for the system's default
    :raises DeviceAbsent: no microphone is connected, or it cannot be opened
    """
    try:
        import pyaudio
    except ImportError as error:
        raise DeviceAbsent('no microphone without PortAudio ({}): install '
                           'python3-pyaudio'.format(error))
    audio = pyaudio.PyAudio()
    info = _find(audio, wanted.lower())
    try:
        stream = audio.open(RATE_HZ, 1, pyaudio.paInt16, input=True,
                            input_device_index=int(info['index']),
                            frames_per_buffer=BLOCK_BYTES // 2)
    except (OSError, ValueError) as error:
        raise DeviceAbsent('the microphone "{}" cannot be opened: {}; close other programs that '
                           'use it, or choose another with ~source'.format(info['name'], error))
    return stream, 'the microphone "{}"'.format(info['name'])


def _find(audio, wanted):
    """Return PortAudio's entry of the wanted microphone."""
    rows = [audio.get_device_info_by_index(index) for index in range(audio.get_device_count())]
    rows = [row for row in rows if row['maxInputChannels'] > 0]
    if not rows:
        raise DeviceAbsent('no microphone: plug one in')
    if wanted:
        for row in rows:
            if wanted in row['name'].lower():
                return row
        raise DeviceAbsent('no microphone has "{}" in its name; there are: {}'.format(
            wanted, ', '.join(row['name'] for row in rows)))
    try:
        return audio.get_default_input_device_info()
    except OSError:
        return rows[0]


def main():
    """Run until the microphone is gone."""
    out = parent()
    try:
        stream, name = open_microphone(sys.argv[1])
    except DeviceAbsent as reason:
        out.send({'absent': str(reason)})
        return
    try:
        out.send({'device': name})
        while True:
            # Tolerate lost sound under load instead of closing the microphone.
            out.send(stream.read(BLOCK_BYTES // 2, exception_on_overflow=False), wait=True)
    except (OSError, KeyboardInterrupt):
        # Unplugged, or the receiver is gone.
        os._exit(0)
