# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What is good enough to learn a voice from, and where one sentence ends and the next begins."""
import numpy as np
import pytest

from mhri.devices.io.reader import DeviceLost
from mhri.voice.io.teaching import next_sentence
from mhri.voice.sound import BLOCK_BYTES, BLOCK_S, RATE_HZ
from mhri.voice.teaching import sentence_problem, voice_path, voice_problem

SOUNDS_OF_SENTENCE = 20
READ_S = 2.0


def noise(seconds, rms):
    """Return 16 bit noise."""
    values = np.random.RandomState(1).normal(0.0, rms, int(seconds * RATE_HZ))
    return np.clip(values, -32768, 32767).astype('<i2').tobytes()


def sentence(seconds=READ_S, rms=1500.0, room=8.0):
    """Return what stands for a sentence in a room."""
    return noise(0.3, room) + noise(seconds, rms) + noise(0.4, room)


PROBLEMS = {'good': (sentence(), ''), 'nothing': (b'', 'nothing was heard'),
            'clipped': (sentence(rms=15000.0), 'too loud'),
            'quiet': (sentence(rms=60.0, room=1.0), 'too quiet'),
            'noise': (sentence(room=700.0), 'too much noise'),
            'one word': (sentence(0.4), 'too short'), 'a story': (sentence(9.0), 'too long')}


@pytest.mark.parametrize('name', sorted(PROBLEMS))
def test_what_a_sentence_lacks_is_said(name):
    sound, words = PROBLEMS[name]
    problem = sentence_problem(sound, SOUNDS_OF_SENTENCE)
    assert problem.startswith(words) and bool(problem) == bool(words)


@pytest.mark.parametrize('name, good', [('ann', True), ('Ann_2-b', True), ('', False),
                                        ('../ann', False), ('a' * 41, False), ('ann\n', False)])
def test_names(name, good):
    assert (voice_problem(name) == '') == good


def test_voices_lie_beside_the_other_things_of_ros():
    assert voice_path('ann', {'ROS_HOME': '/r'}) == '/r/mhri/voices/ann.means'
    assert voice_path('ann', {'HOME': '/h'}) == '/h/.ros/mhri/voices/ann.means'


class Source:
    """Gives sound as fast as it is read, and then is lost."""

    def __init__(self, sound):
        self._sound = sound

    def read(self, timeout_s):
        """Return the next block."""
        block, self._sound = self._sound[:BLOCK_BYTES], self._sound[BLOCK_BYTES:]
        if not block:
            raise DeviceLost('over')
        return block


def seconds(sound):
    """Return how long sound is [s]."""
    return len(sound) / BLOCK_BYTES * BLOCK_S


def test_a_pause_ends_no_sentence_and_silence_does():
    parts = noise(1.0, 8.0), noise(1.0, 1500.0), noise(0.7, 8.0), noise(1.0, 1500.0)
    source = Source(b''.join(parts) + noise(1.5, 8.0) + noise(1.2, 1500.0))
    # With 0.3 s of the room before it, and 0.4 s behind.
    assert seconds(next_sentence(source)) == pytest.approx(3.4, abs=0.2)
    assert seconds(next_sentence(source)) == pytest.approx(1.5, abs=0.2)
    with pytest.raises(DeviceLost):
        next_sentence(source)


def test_who_does_not_read_is_not_waited_for_for_ever():
    assert next_sentence(Source(noise(30.0, 8.0))) == b''
