# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Teaching a voice: which sentences are read again, what is kept; a stand-in does the learning."""
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import yaml

from mhri.graph.ros.resources import resource_path
from mhri.nodes import mhri_voice_teach as node
from mhri.voice.io import teaching


class Teacher:
    """Learns nothing; ``before`` and ``now`` are how many it understands: (right, wrong)."""

    def __init__(self, problems=(), before=(2, 0), now=(5, 0)):
        self._problems = dict(problems)
        self._answers = {True: now, False: before}
        self.asked, self.taken = [], []

    def take(self, text, sound):
        """Return the next problem of a sentence."""
        rest = self._problems.get(text, [])
        problem = rest.pop(0) if rest else ''
        self.asked.append(text)
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


@pytest.fixture
def voices(tmp_path, monkeypatch):
    monkeypatch.setenv('ROS_HOME', str(tmp_path))
    return tmp_path / 'mhri' / 'voices'


@pytest.fixture
def read(voices, tmp_path, monkeypatch):
    """Return a function that reads five sentences to a teacher, and returns the last line said."""
    rows = yaml.safe_load(Path(resource_path('voice', 'english.yaml')).read_text())
    path = tmp_path / 'short.yaml'
    path.write_text(yaml.safe_dump(dict(rows, teach=['one', 'two', 'three'],
                                        teach_check=['four', 'five'])))
    monkeypatch.setattr(node, 'open_source', lambda text: SimpleNamespace(open=lambda: 'a desk'))
    monkeypatch.setattr(teaching, 'next_sentence', lambda source: b'sound')

    def teach(teacher):
        said = []
        monkeypatch.setattr(teaching, 'Teacher', lambda language, dictionary: teacher)
        node.teach(node.parse(['ann', '--language', str(path)]), said.append)
        return said[-1]
    return teach


def test_a_bad_sentence_is_read_again_and_after_three_times_left_out(read, voices):
    teacher = Teacher({'two': ['too quiet'], 'three': ['too loud'] * 3})
    assert 'ann' in read(teacher)
    assert teacher.asked == ['one', 'two', 'two', 'three', 'three', 'three', 'four', 'five']
    assert teacher.taken == ['one', 'two', 'four', 'five']
    assert [path.name for path in voices.iterdir()] == ['ann.means']


@pytest.mark.parametrize('bad', [('two', 'three'), ('four',)])
def test_too_few_sentences_are_refused(read, voices, bad):
    with pytest.raises(node.Refused):
        read(Teacher({text: ['too quiet'] * 3 for text in bad}))
    assert not voices.exists()


@pytest.mark.parametrize('now', [(1, 0), (4, 3)], ids=['fewer', 'taken for another'])
def test_a_worse_voice_is_refused_and_the_old_one_stays(read, voices, now):
    voices.mkdir(parents=True)
    (voices / 'ann.means').write_bytes(b'before')
    with pytest.raises(node.Refused):
        read(Teacher(now=now))
    assert [path.read_bytes() for path in voices.iterdir()] == [b'before']


def test_without_recordings_nothing_is_kept(voices, tmp_path):
    with pytest.raises(node.Refused):
        node.teach(node.parse(['ann', '--recordings', str(tmp_path)]), lambda text: None)
    assert not voices.exists()


def test_what_is_learned_with_noise_has_as_much_of_it_whatever_its_level():
    random = np.random.RandomState(3)
    for level in (300.0, 3000.0):
        plain = np.round(level * random.standard_normal(16001)).astype('<i2')
        noisy = np.frombuffer(teaching.in_noise(plain.tobytes(), random), dtype='<i2')
        under = noisy.astype(float) - plain
        assert np.std(under) == pytest.approx(level / 10.0 ** 0.5, rel=0.03)
    loudest = np.full(16000, 32767, dtype='<i2')
    noisy = np.frombuffer(teaching.in_noise(loudest.tobytes(), random), dtype='<i2')
    assert noisy.max() == 32767 and noisy.min() > -25000, 'clipped, without overflow'
