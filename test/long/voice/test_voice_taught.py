# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The recogniser itself: a voice that is taught, and a word that sounds like a motion.

The voices are espeak-ng's. To be taught, there is a short language, so that it takes seconds.
"""
import os
from pathlib import Path
import subprocess
import sys

import numpy as np
import yaml

from support import speech

from mhri.voice.grammar import Grammar
from mhri.voice.io.recogniser import Dictionary, Recogniser
from mhri.voice.io.teaching import check_voice
from mhri.voice.language import parse_language
from mhri.voice.speech import SURE, SURE_WHEN_HELD

REPO = Path(__file__).resolve().parents[3]
# One of which pocketsphinx understands next to nothing.
VOICE = speech.Voice('en-us+Annie', 150, 50)
TEACH = ('robot turn right and go left a little', 'robot deselect bot one and the rover',
         'start recording and stop recording again', 'four hours of steady work faced us')
CHECK = ('robot left a little', 'robot record')
LATER = ('robot go right', 'robot deselect rover', 'robot turn left')
TIMEOUT_S = 900.0


def spoken(text, gain=1.0, voice=VOICE):
    """Return a sentence in a quiet room."""
    sound = speech.speak(text, voice) * gain
    return speech.in_room(sound, np.random.RandomState(1), before_s=0.5, after_s=1.5)


def test_a_voice_is_taught_and_understood(tmp_path):
    path = tmp_path / 'short.yaml'
    rows = yaml.safe_load((REPO / 'resource' / 'voice' / 'english.yaml').read_text())
    path.write_text(yaml.safe_dump(dict(rows, teach=list(TEACH), teach_check=list(CHECK))))
    sound = b''.join([spoken(TEACH[0], 30.0)] + [spoken(text) for text in TEACH + CHECK])
    done = subprocess.run(
        [sys.executable, str(REPO / 'scripts' / 'mhri_voice_teach'), 'annie', '--source', '-',
         '--language', str(path)], input=sound, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
        env=dict(os.environ, ROS_HOME=str(tmp_path)), timeout=TIMEOUT_S, check=False)
    output = done.stdout.decode()
    assert done.returncode == 0, output
    assert output.count('again: ') == 1 and 'again: too loud' in output
    voice = tmp_path / 'mhri' / 'voices' / 'annie.means'
    check_voice(str(voice))
    dictionary = Dictionary()
    grammar = Grammar(parse_language(path.read_text(), str(path)), ('bot1', 'rover'),
                      dictionary.__contains__)
    recogniser = Recogniser(grammar, dictionary, voice=str(voice))
    heard = [recogniser.recognise(spoken(text)) for text in LATER]
    assert [found and found.text for found in heard] == list(LATER)


def test_a_word_that_sounds_like_a_motion_moves_nothing():
    """Of this voice, "robot, record" fits "robot forward a bit" best, with a confidence of 0.6."""
    path, dictionary = REPO / 'resource' / 'voice' / 'english.yaml', Dictionary()
    grammar = Grammar(parse_language(path.read_text(), str(path)), speech.ROBOTS,
                      dictionary.__contains__)
    recogniser = Recogniser(grammar, dictionary)

    def heard(text):
        sound = speech.speak(text, speech.Voice('en-us+f3', 150, 50))
        recogniser.begin(b'')
        sound = speech.in_room(sound, np.random.RandomState(3), before_s=0.35, after_s=0.45)
        recogniser.go_on(sound)
        found = recogniser.recognise(sound)
        print('heard', text, found)
        return found
    found = heard('robot, record')
    assert not grammar.moves(found.text) or found.confidence < SURE_WHEN_HELD
    found = heard('robot forward')
    assert found.text == 'robot forward' and found.confidence >= SURE
