# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A model of sounds moves towards the voice that has said known sentences."""
import os
import struct

import numpy as np
import pytest

from mhri.voice import adaptation
from mhri.voice.adaptation import ModelError, Sounds
from mhri.voice.io.teaching import check_voice, read_sounds
from mhri.voice.sound import SOUNDS

PHONES = ('A', 'B', 'C', 'SIL')
A, B, C, SIL = range(4)
STREAMS, DENSITIES, SIZE = 3, 4, 2
FRAMES = 12
# PyPI has no such model, which matters where the libraries come from there alone.
WITH_MODEL = pytest.mark.skipif(not os.path.isdir(SOUNDS), reason='no pocketsphinx-en-us')


def model():
    """Return sounds that lie 20 apart, with densities around each, the same in each state."""
    random = np.random.RandomState(3)
    middle = 20.0 * np.arange(4).reshape(4, 1, 1, 1)
    means = middle + random.uniform(-4.0, 4.0, (4, STREAMS, DENSITIES, SIZE))
    weights = np.full((4, 3, STREAMS, DENSITIES), 1.0 / DENSITIES)
    return Sounds(PHONES, means, np.ones_like(means), weights)


def spoken(sounds, phones, move=lambda value: value):
    """Return frames of sounds said one after the other by a voice unlike the model's."""
    random = np.random.RandomState(5)
    rows = []
    for phone in phones:
        for _ in range(FRAMES):
            density = random.randint(DENSITIES)
            row = sounds.means[phone, :, density]
            rows.append((row if phone == SIL else move(row)) + random.normal(0.0, 0.3, row.shape))
    return np.array(rows)


def test_the_way_in_which_a_word_was_spoken_and_the_pauses_are_found():
    sounds = model()
    net = adaptation.network([[[A, B]], [[C], [B]]], SIL)
    said = [SIL, A, B, SIL, B, SIL]
    places, _ = adaptation.path(sounds, spoken(sounds, said), net)
    assert net.sound[places].tolist() == [phone for phone in said for _ in range(FRAMES)]


def test_a_voice_is_learned_for_sounds_it_has_not_said_as_well():
    """The transformation is of all sounds but silence, which is no part of a voice."""
    sounds = model()

    def move(row):
        return 1.1 * row + 1.5
    net = adaptation.network([[[A, B]]], SIL)
    frames = spoken(sounds, [SIL, A, B, A, B, SIL], move)
    twice = adaptation.network([[[A, B]], [[A, B]]], SIL)
    learned = adaptation.adapted(sounds, [(frames, twice),
                                          (spoken(sounds, [A, B], move), net)])
    for phone, most in ((A, 0.35), (B, 0.35), (C, 0.5)):
        before = np.abs(sounds.means[phone] - move(sounds.means[phone])).mean()
        after = np.abs(learned.means[phone] - move(sounds.means[phone])).mean()
        assert after < most * before
    assert np.abs(learned.means[SIL] - sounds.means[SIL]).max() < 0.3


def far(sounds, frames, phone):
    """Return how far frames are from the nearest densities of a sound, in the mean."""
    apart = frames[:, :, None] - sounds.means[phone]
    return np.sqrt((apart ** 2).sum(axis=3)).min(axis=2).mean()


def test_what_is_far_from_the_model_is_drawn_near():
    """One sound alone is said otherwise, and the room is another: no transformation has both."""
    sounds = model()
    said = np.repeat([SIL, A, B, SIL, B, A, B, SIL], FRAMES)
    frames = spoken(sounds, said[::FRAMES])
    frames += np.array([{A: 0.0, B: 6.0, SIL: -6.0}[phone] for phone in said])[:, None, None]
    net = adaptation.network([[[A, B]], [[B, A, B]]], SIL)
    learned = adaptation.adapted(sounds, [(frames, net)])
    for phone in (B, SIL):
        own = frames[said == phone]
        assert far(learned, own, phone) < 0.4 * far(sounds, own, phone)


def test_a_voice_like_the_models_changes_little():
    sounds = model()
    said = [(spoken(sounds, [SIL, A, B, C]), adaptation.network([[[A, B, C]]], SIL))]
    assert np.abs(adaptation.adapted(sounds, said).means - sounds.means).max() < 1.0


def test_differences_are_taken_as_pocketsphinx_does():
    cepstra = np.stack([np.arange(10.0), np.arange(10.0) ** 2], axis=1)
    found = adaptation.features(cepstra)
    assert found.shape == (10, 3, 2)
    assert np.allclose(found[:, 0].mean(axis=0), 0.0)
    # In the middle a slope of 1 gives 4 over four frames, and a square 2nd differences of 16.
    assert found[5, 1].tolist() == [4.0, 40.0] and found[5, 2].tolist() == [0.0, 16.0]


@WITH_MODEL
def test_the_model_that_is_installed_is_read():
    sounds = read_sounds()
    assert sounds.means.shape == sounds.variances.shape == (42, 3, 128, 13)
    assert len(sounds.phones) == 42 and 'SIL' in sounds.phones
    assert 0.8 < sounds.weights.sum(axis=3).min() and sounds.weights.sum(axis=3).max() < 1.1


def gaussians(**change):
    """Return a file of Gaussians that is wrong in one way."""
    values = dict(dict(magic=0x11223344, streams=3, sizes=(2, 2, 2), count=4 * 3 * 4 * 2), **change)
    head = struct.pack('<4i', values['magic'], 4, values['streams'], 4)
    return b's3\nendhdr\n' + head + struct.pack('<4i', *values['sizes'], values['count']) + bytes(
        4 * 4 * 3 * 4 * 2)


BAD = {'nothing': b'', 'a text': b'hello', 'another order': gaussians(magic=0x44332211),
       'several sizes': gaussians(sizes=(2, 3, 2)), 'a wrong count': gaussians(count=5),
       'cut off': gaussians()[:-8], 'no streams': gaussians(streams=-1)}


@WITH_MODEL
@pytest.mark.parametrize('name', sorted(BAD))
def test_a_broken_voice_is_named(name, tmp_path):
    path = tmp_path / 'ann.means'
    path.write_bytes(BAD[name])
    with pytest.raises(ModelError, match='ann.means'):
        check_voice(str(path))


@WITH_MODEL
def test_a_voice_for_another_model_is_named(tmp_path):
    path = tmp_path / 'ann.means'
    path.write_bytes(adaptation.write_gaussians(model().means))
    with pytest.raises(ModelError, match='another model'):
        check_voice(str(path))
    check_voice(SOUNDS + '/means')


@WITH_MODEL
def test_numbers_that_are_none_are_refused(tmp_path):
    path = tmp_path / 'ann.means'
    means = read_sounds().means.copy()
    means[3, 1, 2, 0] = np.nan
    path.write_bytes(adaptation.write_gaussians(means))
    with pytest.raises(ModelError, match='ann.means'):
        check_voice(str(path))


@pytest.mark.parametrize('data', [b'', b'text', b'BMDF' + bytes(60)])
def test_another_mdef_is_refused(data):
    with pytest.raises(ModelError, match='mdef'):
        adaptation.read_phones(data)
