# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Teaches the recogniser one person's voice, from sentences read aloud once.

A voice is a file with the means of the model's Gaussians, adapted to that person
(:mod:`mhri.voice.adaptation`). pocketsphinx loads it by its option ``-mean``, both in 5prealpha and
in 5.0. Recordings are not kept.
"""
import os
import tempfile

import numpy as np

from mhri.devices.io.reader import DeviceLost
from mhri.voice import adaptation
from mhri.voice.endpointing import BEGIN, Endpointer, GO_ON
from mhri.voice.grammar import Grammar
from mhri.voice.io.recogniser import new_decoder, Recogniser
from mhri.voice.sound import BLOCK_S, RATE_HZ, SOUNDS
from mhri.voice.speech import SURE
from mhri.voice.teaching import sentence_problem

# Silence that ends a sentence, and time-out for its first word [s].
_PAUSE_S, _TIMEOUT_S = 1.0, 20.0
_READ_S = 0.2
_CEPSTRA = 13
# Signal-to-noise ratio of the copies of the sentences with noise, by RMS [dB].
_NOISE_DB = 10.0
# Robot names in the sentences that check a voice.
_ROBOTS = ('bot1', 'bot2', 'bot3')


def read_sounds():
    """Return the model before adaptation, :class:`mhri.voice.adaptation.Sounds`.

    :raises OSError: a file cannot be read
    :raises ModelError: the model is of another kind
    """
    data = {}
    for name in ('mdef', 'means', 'variances', 'sendump'):
        with open(os.path.join(SOUNDS, name), 'rb') as stream:
            data[name] = stream.read()
    phones = adaptation.read_phones(data['mdef'])
    return adaptation.Sounds(phones, adaptation.read_gaussians(data['means'], 'means'),
                             adaptation.read_gaussians(data['variances'], 'variances'),
                             adaptation.read_weights(data['sendump'], len(phones)))


def check_voice(path):
    """Check that a file is a voice for the installed model.

    :raises OSError, ModelError: the file is unusable
    """
    shapes = []
    for name in (os.path.join(SOUNDS, 'means'), path):
        with open(name, 'rb') as stream:
            shapes.append(adaptation.read_gaussians(stream.read(), name).shape)
    if shapes[0] != shapes[1]:
        raise adaptation.ModelError('{} is a voice for another model'.format(path))


def next_sentence(source):
    """Return the sound of the next sentence read aloud, b'' without one.

    :param source: of :mod:`mhri.voice.io.audio`, open
    :raises DeviceLost: the source has ended before a sentence began
    """
    endpointer, sound, since = Endpointer(), [], []
    waited_s = 0.0
    while waited_s < (_PAUSE_S if sound else _TIMEOUT_S):
        try:
            block = source.read(_READ_S)
        except DeviceLost:
            if sound:
                break
            raise
        if not block:
            waited_s += _READ_S
            continue
        state = endpointer.feed(block)
        if state in (BEGIN, GO_ON):
            sound += (since + [block] if sound else [endpointer.lead()])
            since, waited_s = [], 0.0
        else:
            since += [block] * bool(sound)
            waited_s += BLOCK_S
    return b''.join(sound)


class Teacher:
    """Collects sentences read aloud, and learns the voice from them.

    :param language: :class:`mhri.voice.language.Language`
    :param dictionary: :class:`mhri.voice.io.recogniser.Dictionary`
    :raises OSError, ModelError: the model is unsuitable, see :func:`read_sounds`
    :raises RecogniserError: a word of a sentence has no pronunciation
    """

    def __init__(self, language, dictionary):
        self._language = language
        self._dictionary = dictionary
        self._sounds = read_sounds()
        self._heard = {}
        self._ways = {text: [[way.split() for way in dictionary.spoken(word, language)]
                             for word in text.split()]
                      for text in language.teach + language.teach_check}

    def take(self, text, sound):
        """Handle a sentence; return why it has to be read again, '' if it is good."""
        problem = sentence_problem(sound, sum(len(ways[0]) for ways in self._ways[text]))
        if not problem:
            self._heard[text] = sound
        return problem

    def good(self, texts):
        """Return the number of good sentences among some."""
        return sum(text in self._heard for text in texts)

    def learn(self):
        """Return the file of the voice as bytes; takes some seconds."""
        places = {name: place for place, name in enumerate(self._sounds.phones)}
        texts = [text for text in self._language.teach if text in self._heard]
        said = []
        # Each sentence as it was read, and once more with noise.
        random = np.random.RandomState(1)
        sounds = [self._heard[text] for text in texts]
        sounds += [in_noise(sound, random) for sound in sounds]
        for text, cepstra in zip(texts + texts, _cepstra(sounds)):
            words = [[[places[phone] for phone in way] for way in ways]
                     for ways in self._ways[text]]
            said.append((adaptation.features(cepstra),
                         adaptation.network(words, places[adaptation.SILENCE])))
        return adaptation.write_gaussians(adaptation.adapted(self._sounds, said).means)

    def understood(self, voice=''):
        """Return the numbers of check sentences recognised correctly and wrongly.

        The remaining ones are not recognised as a command.

        :param voice: path of a voice, '' for any voice
        """
        grammar = Grammar(self._language, _ROBOTS, self._dictionary.__contains__)
        recogniser = Recogniser(grammar, self._dictionary, voice=voice)
        right = wrong = 0
        for text in self._language.teach_check:
            if text not in self._heard:
                continue
            meant = grammar.parse(text)
            recogniser.begin(self._heard[text])
            recogniser.end()
            found = recogniser.recognise(self._heard[text])
            taken = grammar.parse(found.text) if found and found.confidence >= SURE else None
            right += taken == meant
            wrong += taken not in (meant, None)
        return right, wrong


def in_noise(sound, random):
    """Return a sound with added pink noise, 16 bit as well.

    A voice learned only in a quiet room fails in a loud one: noise is not recognised as silence,
    and talk is recognised as commands. In white noise at 10 dB, with two voices, 45 % of the
    commands were right, with this 88 %, and 8 of 15 stops were detected, with this 12.
    """
    plain = np.frombuffer(sound, dtype='<i2').astype(float)
    spectrum = np.fft.rfft(random.standard_normal(len(plain)))
    pitch_hz = np.fft.rfftfreq(len(plain), 1.0 / RATE_HZ)
    under = np.fft.irfft(spectrum / np.sqrt(np.maximum(pitch_hz, 20.0)), len(plain))
    level = np.sqrt(np.mean(plain * plain)) / 10.0 ** (_NOISE_DB / 20.0)
    mixed = plain + under * level / np.sqrt(np.mean(under * under))
    return np.clip(np.round(mixed), -32768, 32767).astype('<i2').tobytes()


def _cepstra(sounds):
    """Return the cepstra [frame, dimension] of sounds, as pocketsphinx computes them."""
    with tempfile.TemporaryDirectory(prefix='mhri_voice_') as folder:
        logs = os.path.join(folder, 'cepstra')
        os.mkdir(logs)
        decoder = new_decoder(folder, [('any', 'AA')], mfclogdir=logs)
        decoder.set_jsgf_string('any', '#JSGF V1.0;\ngrammar any;\npublic <any> = any;\n')
        decoder.set_search('any')
        found = []
        for sound in sounds:
            decoder.start_utt()
            decoder.process_raw(sound, False, True)
            decoder.end_utt()
        for name in sorted(os.listdir(logs)):
            with open(os.path.join(logs, name), 'rb') as stream:
                data = stream.read()
            # It starts with the number of values, in its byte order: big-endian since 5.1.
            order = '<' if int.from_bytes(data[:4], 'little') == len(data) // 4 - 1 else '>'
            values = np.frombuffer(data[4:], dtype=order + 'f4')
            found.append(values.reshape(-1, _CEPSTRA).astype(float))
    return found
