# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The process that hears a microphone: ``python3 -m mhri.voice.io.microphone <part of its name>``.

It writes a line of JSON, ``{"device": name}`` or ``{"absent": reason}``, and then raw sound in the
form of :mod:`mhri.voice.sound`, until the microphone is gone or nobody reads any more. It
is a separate process because the one that recognises reads nothing for tenths of a second, and
PortAudio would throw away what is said meanwhile: a stop, perhaps.
"""
import json
import os
import sys

from mhri.devices.io.reader import DeviceAbsent
from mhri.voice.sound import BLOCK_BYTES, RATE_HZ


def open_microphone(wanted):
    """Return (stream of PortAudio, name of the device).

    :param wanted: part of the name, in any case; '' for the system's default
    :raises DeviceAbsent: there is none, or it cannot be opened
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
    # What PortAudio and ALSA write to the standard output must not look like sound.
    out = os.fdopen(os.dup(1), 'wb', buffering=0)
    os.dup2(2, 1)
    try:
        stream, name = open_microphone(sys.argv[1] if len(sys.argv) > 1 else '')
    except DeviceAbsent as reason:
        out.write((json.dumps({'absent': str(reason)}) + '\n').encode())
        return
    try:
        out.write((json.dumps({'device': name}) + '\n').encode())
        while True:
            # Sound lost under load is no reason to give up the microphone.
            out.write(stream.read(BLOCK_BYTES // 2, exception_on_overflow=False))
    except (OSError, KeyboardInterrupt):
        # Pulled out, or nobody reads: whoever reads sees the end.
        os._exit(0)


if __name__ == '__main__':
    main()
