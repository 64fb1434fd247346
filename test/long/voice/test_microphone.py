# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A microphone, through PortAudio and ALSA."""
import os
import signal

import pytest

from mhri.devices.io.reader import DeviceAbsent, DeviceLost
from mhri.voice.io.audio import Microphone
from mhri.voice.sound import BLOCK_BYTES
from support.ros_system import children

BLOCK = bytes(range(256)) * (BLOCK_BYTES // 256) + bytes(BLOCK_BYTES % 256)

# ALSA's file device gives what is in a file, so that PortAudio really hears something.
ALSA = """
pcm.!default {{ type null }}
pcm.stand_in {{ type file slave.pcm null file /dev/null infile {} format raw }}
"""


@pytest.fixture
def alsa(tmp_path, monkeypatch):
    """Let ALSA have a microphone "stand_in"; return the file with what it hears."""
    (tmp_path / '.asoundrc').write_text(ALSA.format(tmp_path / 'heard'))
    (tmp_path / 'heard').write_bytes(BLOCK * 50)
    monkeypatch.setenv('HOME', str(tmp_path))


def test_a_microphone_through_portaudio_and_alsa(alsa):
    microphone = Microphone('STAND_in')
    assert 'stand_in' in microphone.open()
    assert [microphone.read(10.0) for _ in range(20)] == [BLOCK] * 20
    microphone.close()
    microphone.close()


def test_a_microphone_that_goes_is_lost(alsa):
    microphone = Microphone('stand_in')
    microphone.open()
    os.kill(next(iter(children(os.getpid()))), signal.SIGKILL)
    with pytest.raises(DeviceLost, match='pulled out'):
        while True:
            microphone.read(10.0)
    microphone.close()


def test_a_microphone_of_another_name_is_absent(alsa):
    """And the message says which there are."""
    with pytest.raises(DeviceAbsent, match='no microphone has "usb" in its name.*stand_in'):
        Microphone('usb').open()


def test_a_driver_that_falls_is_no_microphone(tmp_path, monkeypatch):
    """PortAudio aborts where ALSA has no configuration at all."""
    (tmp_path / 'asound.conf').write_text('')
    monkeypatch.setenv('ALSA_CONFIG_PATH', str(tmp_path / 'asound.conf'))
    with pytest.raises(DeviceAbsent, match='microphone'):
        Microphone('none of this name').open()
