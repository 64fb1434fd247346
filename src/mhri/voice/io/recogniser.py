# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Recognises speech by pocketsphinx, offline, with its English model.

Four searches work together. The spotter detects a stop while the word is being spoken. After the
end of an utterance, the command search always fits the grammar to it; and the filler, a loop of all
sounds of the language, yields the best possible fit. If the command fits much worse than the filler
in the same place, or there is speech before its first word, the utterance was not a command;
several weak signs of that are combined. For a motion, the fourth search fits all other commands
("robot record" for "robot forward"): the motion has to fit far better.
"""
import math
import os
import tempfile
from dataclasses import dataclass

import numpy as np

from mhri.voice.sound import MODEL, SOUNDS

try:
    import pocketsphinx
except ImportError as error:  # reported when the voice is used; other inputs do not need it
    pocketsphinx = None
    IMPORT_PROBLEM = str(error)

_NOTHING = '(NULL)'
_NO_WORDS = '<+[('
# Uncertainty of the ends of a short word [frames of 10 ms].
_SHORT_FRAMES = 5
# In frames: an utterance begins with 0.3 s of earlier sound, and speech starts a moment later.
_USUAL_START, _MAX_LATE_FRAMES, _MAX_GAPS = 33, 12, 40
_COMMAND, _STILL, _FILLER = 'command', 'still', 'filler'
# Steps below the limit at which everything is refused, even with push-to-talk.
_SURELY_NOT = -3.0
_REMEDY = 'install python3-pocketsphinx and pocketsphinx-en-us'
_DICTIONARY = os.path.join(MODEL, 'cmudict-en-us.dict')


class RecogniserError(Exception):
    """Speech cannot be recognised here; the text has the missing part and the remedy."""


@dataclass(frozen=True)
class Tuning:
    """Parameters to distinguish commands from talk, from ``test/bench/bench_voice.py --tune``.

    ``stop_threshold`` is the likelihood ratio at which a stop is spotted (smaller: sooner, and more
    often in talk), ``wake_threshold`` the same for the wake words. ``worst_word``, ``first_word``
    (if that is the wake word) and ``all_words`` are limits of the fit compared with the filler
    [score per 10 ms]. ``latest_start`` is the limit for the begin of the first word [frames of
    10 ms, including 0.3 s from before the utterance]: with earlier speech it is talk. The word of a
    stop has to fit at least as well as ``stop_word``, and last at least ``stop_frames``.
    ``unspotted_wake`` replaces ``first_word`` if the spotter has not detected the wake word. At the
    limit the confidence is 0.5; one ``slope`` below it 0.27.

    ``motion_lead`` is the required lead of a whole motion over the best phrase that moves nothing
    [score], with and without push-to-talk; ``lead_slope`` is like ``slope``. With 250, 7 of 160
    correct motions are refused, and 4 of 180 other commands move a robot instead of 10 (with 500:
    17 and 4), with push-to-talk 7 instead of 14; ``doc/input_voice.md`` has the table.

    The others are the weights of a logistic regression over the :class:`Fit` of a command with more
    than the wake word, whose result has to be at least 0.5, too. It was fitted to commands against
    talk of both tuning runs, ten voices in three rooms; ``by_start`` is from leave-one-out cross
    validation over the voices. All limits are 0.4 of a slope below the results for those ten, since
    other voices fit worse.
    """

    stop_threshold: float = 1e-10
    wake_threshold: float = 1e-20
    worst_word: float = -38.0
    stop_word: float = -18.0
    stop_frames: int = 24
    first_word: float = -25.0
    unspotted_wake: float = -21.0
    all_words: float = -24.5
    latest_start: float = 42.0
    slope: float = 5.0
    by_worst: float = 0.236
    by_second: float = 0.187
    by_first: float = 0.098
    by_mean: float = 0.150
    by_gaps: float = -0.068
    by_start: float = -0.8
    at_rest: float = 15.82
    motion_lead: float = 250.0
    lead_slope: float = 100.0


@dataclass(frozen=True)
class Fit:
    """The fit of a command compared with another search in the same place [score per 10 ms frame].

    Negative is worse than the other. ``start`` is the first frame of the first word, ``gaps`` the
    number of frames between the first and the last word that belong to no word. ``words`` are
    (word, fit).
    """

    worst: float
    second: float
    first: float
    mean: float
    start: int
    gaps: int
    words: tuple = ()

    def margin(self, tuning, stops=(), woken=True, spotted=True):
        """Return the minimum margin over the limits [score per frame], negative below a limit.

        :param stops: the words for a stop, if it may be one: a stop may be said at any place
        :param woken: its first word is the wake word
        :param spotted: the spotter has detected a wake word, too
        """
        worst, mean = self.worst - tuning.worst_word, self.mean - tuning.all_words
        if stops:
            own = max(fit for word, fit in self.words if word in stops)
            return min(worst, mean, own - tuning.stop_word)
        lowest = tuning.first_word if spotted else tuning.unspotted_wake
        first = self.first - lowest if woken else math.inf
        return min(worst, first, mean, tuning.latest_start - self.start)

    def logit(self, tuning, woken=True):
        """Return the logarithm of the odds that it is a command, from all signs together.

        Each sign is clipped to its range in the tuning.
        """
        worst, second, mean = (max(-60.0, min(0.0, value))
                               for value in (self.worst, self.second, self.mean))
        first = max(-40.0, min(0.0, self.first)) if woken else 0.0
        late = max(0, min(_MAX_LATE_FRAMES, self.start - _USUAL_START))
        return (tuning.at_rest + tuning.by_worst * worst + tuning.by_second * second
                + tuning.by_first * first + tuning.by_mean * mean
                + tuning.by_gaps * min(_MAX_GAPS, self.gaps) + tuning.by_start * late)


def compare(fitted, anything):
    """Return the :class:`Fit` of one search against another.

    Silence of the first search counts for the worst word, too, since talk may be hidden in it.

    :param fitted: [(word, first frame, last frame, score)] of the first, with at least one word
    :param anything: the same of the other
    """
    length = max(last for _, _, last, _ in anything + fitted) + 1
    others = np.zeros(length)
    for _, first, last, score in anything:
        if last >= first >= 0:
            others[first:last + 1] = score / (last + 1 - first)
    total = np.concatenate([[0.0], np.cumsum(others)])
    parts = [(word, first, last + 1 - first, score - (total[last + 1] - total[first]))
             for word, first, last, score in fitted if word != _NOTHING and first >= 0]
    spoken = [part for part in parts if part[0][0] not in _NO_WORDS]
    fits = [(word.partition('(')[0], over / (frames + _SHORT_FRAMES))
            for word, _, frames, over in spoken]
    return Fit(
        worst=min(over / (frames + _SHORT_FRAMES) for _, _, frames, over in parts),
        second=sorted(fit for _, fit in fits)[min(1, len(fits) - 1)],
        first=fits[0][1],
        mean=sum(part[3] for part in spoken) / sum(part[2] for part in spoken),
        start=spoken[0][1],
        gaps=sum(frames for word, first, frames, _ in parts
                 if word[0] in _NO_WORDS and spoken[0][1] < first < spoken[-1][1]),
        words=tuple(fits))


@dataclass(frozen=True)
class Hypothesis:
    """The words that fit an utterance best, and their confidence.

    ``confidence`` is in [0, 1]; 0.5 and more is a command.
    """

    text: str
    confidence: float


class Dictionary:
    """The pronunciations of the model's words, read at their first use."""

    def __init__(self):
        self._sounds = None

    def _read(self):
        if self._sounds is not None:
            return
        try:
            with open(_DICTIONARY, encoding='utf-8') as lines:
                rows = [line.split(None, 1) for line in lines]
        except OSError as error:
            raise RecogniserError('cannot read {}: {}; {}'.format(
                _DICTIONARY, error.strerror or error, _REMEDY))
        sounds = {}
        for word, spoken in rows:
            sounds.setdefault(word.partition('(')[0], []).append(spoken.strip())
        self._sounds = sounds

    def __contains__(self, word):
        self._read()
        return word in self._sounds

    def sounds(self, word):
        """Return the pronunciations of a word as CMU phones, [] if it is missing."""
        self._read()
        return self._sounds.get(word, [])

    def spoken(self, word, language):
        """Return the pronunciations of a word, those of the language first.

        :raises RecogniserError: the word has no pronunciation
        """
        ways = list(language.pronunciations.get(word, ())) or self.sounds(word)
        if not ways:
            raise RecogniserError('the word "{}" of the voice language {} is not in the '
                                  'dictionary: give its sounds below pronunciations'.format(
                                      word, language.name))
        return ways

    def phones(self):
        """Return every sound of the language, sorted."""
        self._read()
        return sorted({phone for ways in self._sounds.values() for way in ways
                       for phone in way.split()})


def new_decoder(folder, rows, **settings):
    """Return a decoder of pocketsphinx with a dictionary of some rows (word, sounds).

    :param folder: for its files, needed only during this call
    :param settings: options of pocketsphinx; an empty text is ignored
    """
    path = os.path.join(folder, 'words.dict')
    with open(path, 'w', encoding='utf-8') as stream:
        counts = {}
        for word, sounds in rows:
            counts[word] = counts.get(word, 0) + 1
            number = '({})'.format(counts[word]) if counts[word] > 1 else ''
            stream.write('{}{} {}\n'.format(word, number, sounds))
    config = pocketsphinx.Decoder.default_config()
    set_as = {str: config.set_string, bool: config.set_boolean, int: config.set_int,
              float: config.set_float}
    # The endpointer has removed silence already.
    given = dict(settings, hmm=SOUNDS, dict=path, logfn=os.devnull, remove_silence=False)
    for key, value in given.items():
        if value != '':
            set_as[type(value)]('-' + key, value)
    try:
        return pocketsphinx.Decoder(config)
    except RuntimeError as error:
        raise RecogniserError('pocketsphinx does not take its model {}: {}; {}'.format(
            ' with '.join(filter(None, (SOUNDS, settings.get('mean')))), error, _REMEDY))


class Recogniser:
    """Recognises the phrases of one grammar.

    :param grammar: :class:`mhri.voice.grammar.Grammar`
    :param dictionary: :class:`Dictionary`
    :param voice: path of a voice that was taught, see :mod:`mhri.voice.io.teaching`; '': any voice
    :raises RecogniserError: pocketsphinx or its model is missing
    """

    def __init__(self, grammar, dictionary, tuning=Tuning(), voice=''):
        if pocketsphinx is None:
            raise RecogniserError('pocketsphinx cannot be loaded ({}); {}'.format(
                IMPORT_PROBLEM, _REMEDY))
        self._dictionary = dictionary
        self._tuning = tuning
        self._voice = voice
        self._spotting = self._wake_spotted = False
        with tempfile.TemporaryDirectory(prefix='mhri_voice_') as folder:
            # Spot stops with the untaught model, too: a taught one misses some.
            self._spotters = [self._new_spotter(folder, grammar, one)
                              for one in sorted({'', voice})]
        self.set_grammar(grammar)

    def _rows(self, words, language):
        """Return (word, sounds) of words, the language's own before the dictionary's.

        :raises RecogniserError: a word has no sounds
        """
        rows = []
        for word in words:
            rows += [(word, sounds) for sounds in self._dictionary.spoken(word, language)]
        return rows

    def _new_spotter(self, folder, grammar, voice):
        """Return a decoder that spots stops and wake words."""
        language, tuning = grammar.language, self._tuning
        path = os.path.join(folder, 'spotted.kws')
        with open(path, 'w', encoding='utf-8') as stream:
            for phrases, threshold in ((language.stop, tuning.stop_threshold),
                                       (language.wake_words, tuning.wake_threshold)):
                stream.writelines('{} /{:g}/\n'.format(phrase, threshold) for phrase in phrases)
        words = sorted({word for phrase in language.stop + language.wake_words
                        for word in phrase.split()})
        return new_decoder(folder, self._rows(words, language), kws=path, remove_noise=False,
                           beam=1e-100, pbeam=1e-100, mean=voice)

    def set_grammar(self, grammar):
        """Use another grammar, e.g. for other robots, from the next utterance on (0.2 s).

        :raises RecogniserError: a word of the language has no sounds
        """
        phones = self._dictionary.phones()
        rows = self._rows(grammar.words, grammar.language)
        rows += [('sound_' + phone.lower(), phone) for phone in phones]
        loop = ' | '.join('sound_' + phone.lower() for phone in phones)
        with tempfile.TemporaryDirectory(prefix='mhri_voice_') as folder:
            # compallsen: required for comparable scores of two searches. topn: more of the
            # model's densities than usual, which helps in noise. Wide beams: words must not
            # be lost early if the voice differs from those of the model.
            decoder = new_decoder(folder, rows, compallsen=True, cmn='batch', topn=8, beam=1e-120,
                                  wbeam=1e-100, pbeam=1e-120, mean=self._voice)
        decoder.set_jsgf_string(_COMMAND, grammar.jsgf())
        decoder.set_jsgf_string(_STILL, grammar.jsgf(motion=False))
        decoder.set_jsgf_string(_FILLER, '#JSGF V1.0;\ngrammar filler;\npublic <any> = ({})+;\n'
                                .format(loop))
        self._decoder = decoder
        self._language, self._moves = grammar.language, grammar.moves

    # Stops and wake words, while they are spoken.

    def begin(self, sound):
        """Begin an utterance with its first sound; return the same as :meth:`go_on`."""
        self.end()
        for spotter in self._spotters:
            spotter.start_utt()
        self._spotting, self._wake_spotted = True, False
        return self.go_on(sound)

    def go_on(self, sound):
        """Handle more sound of the utterance; return the stop or wake word detected, or ''.

        A wake word is reported once for each utterance. A stop shorter than ``stop_frames`` is
        part of another word, such as "fastest".
        """
        heard = [self._spotted(spotter, sound) for spotter in self._spotters]
        stops = [word for word in heard if word in self._language.stop]
        if stops:
            for spotter in self._spotters:
                spotter.end_utt()
                spotter.start_utt()
        return next(filter(None, stops + heard), '')

    def _spotted(self, spotter, sound):
        """Return the stop or wake word detected by a spotter, or ''."""
        spotter.process_raw(sound, False, False)
        if spotter.hyp() is None:
            return ''
        parts = [(part.word.strip(), part.end_frame - part.start_frame)
                 for part in spotter.seg()]
        woken = [word for word, _ in parts if word in self._language.wake_words]
        if woken and not self._wake_spotted:
            # Do not restart the spotter: the end of a wake word is part of the stop after it.
            self._wake_spotted = True
            return woken[0]
        return next((word for word, frames in parts if word in self._language.stop
                     and frames >= self._tuning.stop_frames), '')

    def end(self):
        """End the utterance for the spotter."""
        if self._spotting:
            self._spotting = False
            for spotter in self._spotters:
                spotter.end_utt()

    # The command, when it has been spoken.

    def _segments(self, search, sound):
        """Return [(word, first frame, last frame, score)] of the best fit, [] without one."""
        decoder = self._decoder
        decoder.set_search(search)
        decoder.start_utt()
        decoder.process_raw(sound, False, True)
        decoder.end_utt()
        if decoder.hyp() is None or not decoder.hyp().hypstr:
            return []
        return [(part.word, part.start_frame, part.end_frame, part.ascore)
                for part in decoder.seg()]

    def _lead(self, fitted, sound):
        """Return the lead of a motion over phrases that move nothing, in slopes over the limit."""
        other = self._segments(_STILL, sound)
        if not other:
            return math.inf
        lead = sum(score for *_, score in fitted) - sum(score for *_, score in other)
        return (lead - self._tuning.motion_lead) / self._tuning.lead_slope

    def recognise(self, sound):
        """Return the :class:`Hypothesis` of a whole utterance, or None if nothing fits.

        :param sound: 16 bit little endian, mono, 16 kHz
        """
        fitted = self._segments(_COMMAND, sound)
        anything = self._segments(_FILLER, sound) if fitted else []
        if not anything:
            return None
        words = [word.partition('(')[0] for word, _, _, _ in fitted if word[0] not in _NO_WORDS]
        if not words:
            return None
        text, language = ' '.join(words), self._language
        stops = language.stop if any(word in language.stop for word in words) else ()
        woken = text.startswith(language.wake_words)
        fit = compare(fitted, anything)
        steps = fit.margin(self._tuning, stops, woken, self._wake_spotted) / self._tuning.slope
        if not stops and text not in language.wake_words:
            steps = min(steps, fit.logit(self._tuning, woken))
        if steps > _SURELY_NOT and self._moves(text):
            steps = min(steps, self._lead(fitted, sound))
        # Clipped, since exp() overflows.
        return Hypothesis(text, 1.0 / (1.0 + math.exp(-max(-50.0, min(50.0, steps)))))
