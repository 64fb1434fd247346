# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Synthetic speakers: sentences of ``utterances/`` spoken by programs, with noise around them.

A voice is one of espeak-ng ("en-us+f2"), of another program ("flite:rms", "festival:ked_diphone"),
or a folder of recordings ("wav:/path"), one for each sentence: "robot_drive_forward.wav".
"""
import collections
import hashlib
from pathlib import Path
import shutil
import subprocess
import sys
import tempfile
import wave

import numpy as np

RATE_HZ = 16000
UTTERANCES = Path(__file__).resolve().parent / 'utterances'
# The robots of commands.txt, in the panel's order.
ROBOTS = ('bot1', 'bot2', 'bot3', 'bot4', 'rover', 'tb3')
# How loud all speech is [steps of 16 bit, RMS of the whole utterance], and a quiet room's hiss.
SPEECH_RMS = 1500.0
HISS_RMS = 8.0

Utterance = collections.namedtuple('Utterance', 'expected text')
Voice = collections.namedtuple('Voice', 'name words_per_minute pitch')
# What flite and festival speak without being told a speed.
_USUAL_WPM = 150.0
_CACHE = Path(tempfile.gettempdir()) / 'mhri_utterances'


def _rows(name):
    """Yield the columns of a file of utterances."""
    for line in (UTTERANCES / name).read_text().splitlines():
        if line and not line.startswith('#'):
            yield [column.strip() for column in line.split('|')]


def commands(which, wake_word='robot'):
    """Return the command utterances of a set, 'tune' or 'test'."""
    return [Utterance(expected, text.format(wake=wake_word))
            for chosen, expected, text in _rows('commands.txt') if chosen == which]


def talk(which):
    """Return the sentences of a set that are no commands; ``expected`` is ''."""
    return [Utterance('', text) for chosen, text in _rows('talk.txt') if chosen == which]


def _run(command, text=''):
    """Run a program to its end with a text as its input."""
    try:
        subprocess.run(command, input=text.encode(), check=True, stdout=subprocess.DEVNULL,
                       stderr=subprocess.DEVNULL)
    except FileNotFoundError:
        sys.exit('{} is not installed: apt-get install espeak-ng sox flite festival '
                 'festvox-kdlpc16k festvox-us-slt-hts'.format(command[0]))


def _espeak(text, voice, path):
    """Speak by espeak-ng into a file; return the effects of sox that are needed still."""
    _run(['espeak-ng', '-v', voice.name, '-s', str(voice.words_per_minute),
          '-p', str(voice.pitch), '-w', str(path), text])
    return []


def _flite(text, voice, path):
    """As :func:`_espeak`; it has no pitch to set."""
    stretch = 'duration_stretch={:.3f}'.format(_USUAL_WPM / voice.words_per_minute)
    _run(['flite', '-voice', voice.name, '--setf', stretch, '-t', text, '-o', str(path)])
    return []


def _festival(text, voice, path):
    """As :func:`_espeak`; its voices do not all obey a speed."""
    _run(['text2wave', '-eval', '(voice_{})'.format(voice.name), '-o', str(path)], text)
    return ['tempo', '-s', str(voice.words_per_minute / _USUAL_WPM)]


def _recorded(text, folder):
    """Return the path of a recording."""
    return Path(folder) / (text.replace(' ', '_') + '.wav')


def can_say(text, voice):
    """Return whether a voice can say a sentence: recordings need not be of all of them."""
    program, _, name = voice.name.rpartition(':')
    return program != 'wav' or _recorded(text, name).exists()


def _recording(text, voice, path):
    """As :func:`_espeak`, from a folder of recordings."""
    shutil.copy(str(_recorded(text, voice.name)), str(path))
    return ['tempo', '-s', str(voice.words_per_minute / _USUAL_WPM)]


_PROGRAMS = {'': _espeak, 'flite': _flite, 'festival': _festival, 'wav': _recording}


def speak(text, voice=Voice('en-us', 150, 50)):
    """Return a sentence as samples at 16 kHz, float, with an RMS of SPEECH_RMS."""
    key = hashlib.sha1('|'.join([text] + [str(item) for item in voice]).encode()).hexdigest()
    path = _CACHE / (key + '.wav')
    if not path.exists():
        _CACHE.mkdir(exist_ok=True)
        with tempfile.TemporaryDirectory(dir=str(_CACHE)) as folder:
            raw, ready = Path(folder) / 'raw.wav', Path(folder) / 'ready.wav'
            program, _, name = voice.name.rpartition(':')
            effects = _PROGRAMS[program](text, voice._replace(name=name), raw)
            # -R: the same sound every time.
            _run(['sox', '-R', str(raw), '-r', str(RATE_HZ), '-c', '1', '-b', '16', str(ready),
                  'gain', '-3'] + effects)
            ready.rename(path)
    with wave.open(str(path), 'rb') as stream:
        sound = np.frombuffer(stream.readframes(stream.getnframes()), dtype='<i2').astype(float)
    return sound * (SPEECH_RMS / np.sqrt(np.mean(sound ** 2)))


def noise(kind, count, random):
    """Return noise with an RMS of 1: 'white', or 'pink' (3 dB less each octave, from 20 Hz on)."""
    white = random.standard_normal(count)
    if kind == 'white':
        return white
    spectrum = np.fft.rfft(white)
    spectrum /= np.sqrt(np.maximum(np.fft.rfftfreq(count, 1.0 / RATE_HZ), 20.0))
    pink = np.fft.irfft(spectrum, count)
    return pink / np.std(pink)


def in_room(sound, random, kind='white', ratio_db=None, before_s=1.0, after_s=0.7):
    """Return 16 bit sound as bytes: an utterance with a room before, behind and under it.

    :param ratio_db: RMS of the speech to RMS of the noise [dB]; None: a quiet room's hiss
    """
    whole = np.concatenate([np.zeros(int(before_s * RATE_HZ)), sound,
                            np.zeros(int(after_s * RATE_HZ))])
    level = HISS_RMS if ratio_db is None else SPEECH_RMS / 10.0 ** (ratio_db / 20.0)
    whole += noise(kind, len(whole), random) * level
    return np.clip(np.round(whole), -32768, 32767).astype('<i2').tobytes()
