# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Teaching a voice: what the operator is told, and what is kept; a stand-in does the learning."""
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from mhri.nodes import mhri_voice_teach as teach
from mhri.voice.io import teaching

GOOD = ''


class Teacher:
    """Learns nothing; ``understood`` answers for anybody's voice and for the new one."""

    def __init__(self, problems=(), before=(2, 0), now=(5, 0)):
        self._problems = dict(problems)
        self._answers = {True: now, False: before}
        self.taken = []

    def take(self, text, sound):
        """Return the next problem of a sentence."""
        rest = self._problems.get(text, [])
        problem = rest.pop(0) if rest else GOOD
        self.taken += [] if problem else [text]
        return problem

    def good(self, texts):
        """Return how many of some sentences were good."""
        return len([text for text in self.taken if text in texts])

    def learn(self):
        """Return what is written."""
        return b'a voice'

    def understood(self, voice=''):
        """Return how many were understood, and how many taken for something else."""
        assert not voice or Path(voice).read_bytes() == b'a voice'
        return self._answers[bool(voice)]


LANGUAGE = SimpleNamespace(teach=('one', 'two', 'three'), teach_check=('four', 'five'))


def hear(text):
    """Return the sound of a sentence."""
    return text.encode()


@pytest.fixture
def voices(tmp_path, monkeypatch):
    monkeypatch.setenv('ROS_HOME', str(tmp_path))
    return tmp_path / 'mhri' / 'voices'


def test_a_bad_sentence_is_read_again_and_after_three_times_left_out():
    said = []
    teacher = Teacher({'two': ['too quiet'], 'three': ['too loud'] * 3})
    teach._read_all(LANGUAGE, teacher, hear, said.append)
    assert teacher.taken == ['one', 'two', 'four', 'five']
    assert said == ['1 of 5:  one', '2 of 5:  two', '    again: too quiet', '3 of 5:  three',
                    '    again: too loud', '    again: too loud', '    left out: too loud',
                    '4 of 5:  four', '5 of 5:  five']


def test_too_few_sentences_are_refused():
    for bad, words in ((('two', 'three'), '1 of 3'), (('four',), '1 of 2')):
        teacher = Teacher({text: ['too quiet'] * 3 for text in bad})
        with pytest.raises(teach.Refused, match='only {} sentences'.format(words)):
            teach._read_all(LANGUAGE, teacher, hear, lambda text: None)


def test_a_better_voice_is_kept_and_its_use_is_told(voices):
    said = []
    teach._keep(LANGUAGE, Teacher(), 'ann', said.append)
    assert [path.name for path in voices.iterdir()] == ['ann.means']
    assert any('2 were understood before, 5 are now' in text for text in said)
    assert 'rosparam set /mhri_voice/voice ann' in said[-1]


@pytest.mark.parametrize('now', [(1, 0), (4, 3)], ids=['fewer', 'taken for another'])
def test_a_worse_voice_is_refused_and_the_old_one_stays(voices, now):
    voices.mkdir(parents=True)
    (voices / 'ann.means').write_bytes(b'before')
    with pytest.raises(teach.Refused, match='better before'):
        teach._keep(LANGUAGE, Teacher(now=now), 'ann', lambda text: None)
    assert [path.read_bytes() for path in voices.iterdir()] == [b'before']


@pytest.mark.parametrize('name', ['', '../ann', 'a b'])
def test_a_name_that_is_none_is_refused(name, capsys):
    with pytest.raises(SystemExit):
        teach.parse([name])
    assert 'expected a name of letters' in capsys.readouterr().err


def test_without_recordings_nothing_is_kept(voices, tmp_path):
    said = []
    with pytest.raises(teach.Refused, match='only 0 of'):
        teach.teach(teach.parse(['ann', '--recordings', str(tmp_path)]), said.append)
    assert not voices.exists() and any('nothing was heard' in text for text in said)


def test_what_is_learned_with_noise_has_as_much_of_it_whatever_its_level():
    random = np.random.RandomState(3)
    for level in (300.0, 3000.0):
        plain = np.round(level * random.standard_normal(16001)).astype('<i2')
        noisy = np.frombuffer(teaching.in_noise(plain.tobytes(), random), dtype='<i2')
        under = noisy.astype(float) - plain
        assert np.std(under) == pytest.approx(level / 10.0 ** 0.5, rel=0.03)
    loudest = np.full(16000, 32767, dtype='<i2')
    noisy = np.frombuffer(teaching.in_noise(loudest.tobytes(), random), dtype='<i2')
    assert noisy.max() == 32767 and noisy.min() > -25000, 'cut off, not turned over'
