# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Sources of sound: a stream that comes and goes, and a recording played once."""
import os
import time
import wave

import pytest

from mhri.devices.io.reader import DeviceAbsent, DeviceLost
from mhri.voice.io.audio import Microphone, open_source, RawStream, WavFile
from mhri.voice.sound import BLOCK_BYTES, BLOCK_S, RATE_HZ

BLOCK = bytes(range(256)) * (BLOCK_BYTES // 256) + bytes(BLOCK_BYTES % 256)


@pytest.fixture
def fifo(tmp_path):
    path = str(tmp_path / 'sound')
    os.mkfifo(path)
    return path


@pytest.fixture
def stream(fifo):
    source = RawStream(fifo)
    yield source
    source.close()


def test_which_source_a_text_means():
    for text, kind in (('', Microphone), ('microphone', Microphone), ('microphone:usb', Microphone),
                       ('-', RawStream), ('/tmp/x.wav', WavFile), ('/tmp/x', RawStream)):
        assert type(open_source(text)) is kind


def test_a_stream_is_read_in_whole_blocks(fifo, stream):
    writer = os.open(fifo, os.O_RDWR)
    assert fifo in stream.open()
    assert stream.read(0.0) == b''
    os.write(writer, BLOCK[:100])
    assert stream.read(1.0) == b''
    os.write(writer, BLOCK[100:] + BLOCK[:7])
    assert stream.read(1.0) == BLOCK
    assert stream.read(0.0) == b''
    os.close(writer)


def test_a_stream_without_a_writer_is_absent(fifo, stream):
    with pytest.raises(DeviceAbsent, match='nobody writes to'):
        stream.open()


def test_a_stream_whose_writer_goes_is_lost(fifo, stream):
    """But what it has said before is heard."""
    writer = os.open(fifo, os.O_RDWR)
    stream.open()
    os.write(writer, BLOCK)
    os.close(writer)
    assert stream.read(1.0) == BLOCK
    with pytest.raises(DeviceLost, match='any longer'):
        stream.read(1.0)
    stream.close()
    with pytest.raises(DeviceAbsent):
        stream.open()


def test_what_is_no_stream(tmp_path):
    with pytest.raises(DeviceAbsent, match='No such file.*mkfifo'):
        RawStream(str(tmp_path / 'none')).open()
    (tmp_path / 'file').write_bytes(BLOCK)
    with pytest.raises(DeviceAbsent, match='mkfifo'):
        RawStream(str(tmp_path / 'file')).open()


def write_wav(path, rate=RATE_HZ, channels=1):
    with wave.open(str(path), 'wb') as out:
        out.setnchannels(channels)
        out.setsampwidth(2)
        out.setframerate(rate)
        out.writeframes(BLOCK * 2 + BLOCK[:100])


def test_a_recording_is_played_at_its_pace_and_once(tmp_path):
    write_wav(tmp_path / 'said.wav')
    source = WavFile(str(tmp_path / 'said.wav'))
    source.open()
    begun = time.monotonic()
    blocks = [source.read(1.0) for _ in range(5)]
    assert time.monotonic() - begun >= 4 * BLOCK_S
    assert blocks[:2] == [BLOCK, BLOCK]
    assert blocks[2] == BLOCK[:100] + bytes(BLOCK_BYTES - 100)
    assert blocks[3] == blocks[4] == bytes(BLOCK_BYTES), 'silence when it has ended'
    source.close()
    source.close()


def test_what_is_no_recording(tmp_path):
    with pytest.raises(DeviceAbsent, match='none.wav'):
        WavFile(str(tmp_path / 'none.wav')).open()
    (tmp_path / 'text.wav').write_text('no sound')
    with pytest.raises(DeviceAbsent, match='cannot read'):
        WavFile(str(tmp_path / 'text.wav')).open()
    write_wav(tmp_path / 'music.wav', 44100, 2)
    with pytest.raises(DeviceAbsent, match='44100 Hz, 2 channels.*sox'):
        WavFile(str(tmp_path / 'music.wav')).open()
