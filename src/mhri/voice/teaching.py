# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Judges whether a sentence read by an operator is good enough to learn from."""
import re
from typing import Mapping

import numpy as np

from mhri.recording.recording import ros_home
from mhri.voice.endpointing import loudness_db
from mhri.voice.sound import BLOCK_BYTES, BLOCK_S

# Samples this large are clipped; a sound with a larger share of them is too loud [fraction].
_CLIPPED = 32600
_CLIPPED_SHARE = 1e-3
# Minimum level of the loudest tenth of a sentence [dB of one step of 16 bit], and its minimum level
# over the quietest part [dB].
_LOUD_DB = 45.0
_OVER_DB = 15.0
# Minimum and maximum mean duration of a sound of the language [s].
_MIN_SOUND_S, _MAX_SOUND_S = 0.035, 0.30
# Silence before and after the speech in an utterance [s].
_ROOM_S = 0.7
_NAME = re.compile(r'[A-Za-z0-9_-]{1,40}\Z')


def sentence_problem(sound: bytes, sounds: int) -> str:
    """Return why a recorded sentence has to be read again, and how; '' if it is good.

    :param sound: as in :mod:`mhri.voice.sound`
    :param sounds: number of sounds of the language in the sentence
    """
    samples = np.abs(np.frombuffer(sound, dtype='<i2').astype(np.int32))
    levels = [loudness_db(sound[at:at + BLOCK_BYTES]) for at in range(0, len(sound), BLOCK_BYTES)]
    if not levels:
        return 'nothing was heard: speak after the sentence is shown'
    if float(np.mean(samples >= _CLIPPED)) > _CLIPPED_SHARE:
        return 'too loud: turn the microphone down, or go further from it'
    loud_db, room_db = np.percentile(levels, [90.0, 5.0])
    if loud_db < _LOUD_DB:
        return 'too quiet: come closer to the microphone, or turn it up'
    if loud_db - room_db < _OVER_DB:
        return 'too much noise around: come closer to the microphone, or go where it is quiet'
    length_s = len(levels) * BLOCK_S - _ROOM_S
    if length_s < sounds * _MIN_SOUND_S:
        return 'too short: read the whole sentence, at an even pace'
    if length_s > sounds * _MAX_SOUND_S:
        return 'too long: read the sentence alone, without long pauses'
    return ''


def voice_path(name: str, env: Mapping[str, str]) -> str:
    """Return the path of a voice's file: ``$ROS_HOME/mhri/voices/<name>.means``."""
    return '{}/mhri/voices/{}.means'.format(ros_home(env), name)


def voice_problem(name: str) -> str:
    """Return why a name is not allowed for a voice, '' if it is."""
    if _NAME.match(name):
        return ''
    return 'expected a name of letters, digits, "_" and "-", 40 at most, got {!r}'.format(name[:60])
