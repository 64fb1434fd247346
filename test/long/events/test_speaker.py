# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The tones in a child: their pitch as it leaves SDL, and what happens without a sound device."""
import os
import subprocess
import sys
import threading
import time

import numpy as np
import psutil
import pytest

from mhri.devices.io import child
from mhri.events.io import speaker as speaker_module
from mhri.events.io.speaker import RATE_HZ, Speaker
from support.ros_system import child_processes

TIMEOUT_S = 60.0
PARENT = '''
import signal
from mhri.events.io.speaker import Speaker
Speaker().start()
signal.pause()
'''


def pitches(sound, rate_hz, part_s=0.06):
    """Return the loudest pitch [Hz] of each part that is not silent, repeats left out."""
    size, found = round(part_s * rate_hz), []
    for start in range(0, len(sound) - size, size // 2):
        part = sound[start:start + size].astype(float)
        if np.abs(part).min(initial=0.0) == 0.0 and np.abs(part).mean() < 1500.0:
            continue
        spectrum = np.abs(np.fft.rfft(part * np.hanning(size), 1 << 15))
        pitch = 10 * round(spectrum.argmax() * rate_hz / (1 << 15) / 10)
        if not found or found[-1] != pitch:
            found.append(pitch)
    return found


def is_alive(process):
    """Return whether a process still runs."""
    try:
        return process.status() != psutil.STATUS_ZOMBIE
    except psutil.NoSuchProcess:
        return False


def players(pid=None):
    """Return the players that are children of a process, by default of this one."""
    return child_processes('mhri.events.io.speaker', pid)


def wait_until(condition):
    """Wait for a condition; fail after a long time."""
    deadline = time.monotonic() + TIMEOUT_S
    while not condition():
        assert time.monotonic() < deadline, 'waited in vain'
        time.sleep(0.02)


@pytest.fixture
def make(monkeypatch, tmp_path):
    """Return a function that starts a speaker with a driver of SDL; and what it said."""
    made = []

    def start(driver):
        monkeypatch.setenv('SDL_AUDIODRIVER', driver)
        monkeypatch.setenv('SDL_DISKAUDIOFILE', str(tmp_path / 'sound'))
        monkeypatch.setenv('ALSA_CONFIG_PATH', str(tmp_path / 'none'))
        said = []
        made.append(Speaker(said.append).start())
        return made[-1], said
    yield start
    for one in made:
        one.close()


def test_of_several_tones_the_most_urgent_leaves_sdl_with_its_pitch(make, tmp_path):
    pytest.importorskip('pygame')
    speaker, said = make('disk')
    wait_until(lambda: (tmp_path / 'sound').exists() and (tmp_path / 'sound').stat().st_size)
    for tone in ('calm', 'nonsense', 'attention', 'lost', 'attention', 'calm'):
        speaker.play(tone)

    def heard():
        return np.fromfile(str(tmp_path / 'sound'), dtype='<i2')
    wait_until(lambda: np.abs(heard()).max() > 25000)
    wait_until(lambda: not heard()[-RATE_HZ // 4:].any())
    assert pitches(heard(), RATE_HZ)[-4:] == [880, 440, 880, 440] and said == []


def test_without_a_device_it_says_so_once_and_goes_on(make, capfd):
    pytest.importorskip('pygame')
    speaker, said = make('alsa')
    wait_until(lambda: said)
    for _ in range(20):
        speaker.play('lost')
    assert players()
    speaker.close()
    wait_until(lambda: not players())
    assert len(said) == 1
    assert capfd.readouterr() == ('', '')


def test_without_pygame_it_says_so_once_and_ends(make, monkeypatch, tmp_path):
    (tmp_path / 'pygame.py').write_text('raise ImportError("none here")\n')
    monkeypatch.syspath_prepend(str(tmp_path))
    speaker, said = make('dummy')
    wait_until(lambda: said and not any(
        thread.name == 'speaker' for thread in threading.enumerate()))
    assert len(said) == 1 and 'none here' in said[0]
    speaker.play('calm')


def test_a_child_that_cannot_start_is_said_once_and_tried_again(make, monkeypatch, tmp_path):
    pytest.importorskip('pygame')
    python, tries = sys.executable, []
    monkeypatch.setattr(sys, 'executable', '/nonexistent/python3')
    monkeypatch.setattr(speaker_module, '_RESTART_S', 0.01)
    command = child.command
    monkeypatch.setattr(child, 'command', lambda *words: tries.append(words) or command(*words))
    speaker, said = make('disk')
    speaker.play('lost')
    wait_until(lambda: len(tries) > 3)
    assert len(said) == 1
    monkeypatch.setattr(sys, 'executable', python)
    wait_until(lambda: (tmp_path / 'sound').exists() and np.abs(
        np.fromfile(str(tmp_path / 'sound'), dtype='<i2')).max(initial=0) > 20000)
    assert len(said) == 1, 'and the tone that was asked for meanwhile is heard'


def test_a_child_that_dies_is_started_again(make, monkeypatch):
    pytest.importorskip('pygame')
    monkeypatch.setattr(speaker_module, '_RESTART_S', 0.01)
    speaker, said = make('dummy')
    wait_until(players)
    first, = players()
    first.kill()
    wait_until(lambda: players() not in ([], [first]))
    assert said == []


def test_the_child_ends_with_its_parent():
    pytest.importorskip('pygame')
    parent = subprocess.Popen([sys.executable, '-c', PARENT], env=dict(
        os.environ, SDL_AUDIODRIVER='dummy'))
    wait_until(lambda: players(parent.pid))
    orphan, = players(parent.pid)
    parent.kill()
    parent.wait()
    wait_until(lambda: not is_alive(orphan))
