# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Reads and checks the phrases of a language, ``resource/voice/<language>.yaml``."""
import re
from dataclasses import dataclass
from typing import Dict, Iterable, Optional, Pattern, Tuple

from mhri.base.config import parse_yaml, Section

DIRECTIONS = ('forward', 'backward', 'left', 'right')
MANNERS = ('little', 'faster', 'slower')
ROBOT_ACTIONS = ('select', 'deselect', 'only')
GROUP_ACTIONS = ('select_all', 'select_none')
REQUESTS = ('record', 'stop_recording', 'mark')
# Longest duration of one motion command: robots stop unless it is repeated [s].
MAX_MOTION_S = 2.0
_WORD_OR_PHRASE = re.compile(r"[a-z']+( [a-z']+)*\Z")
_SOUNDS = re.compile(r'[A-Z]+( [A-Z]+)*\Z')


@dataclass(frozen=True)
class Motion:
    """The speeds and durations of spoken commands.

    ``fraction`` is the initial speed, ``step`` the change by "faster" and "slower", between
    ``lowest`` and ``highest``: all fractions of the operator's speed limit. A command lasts
    ``lasts_s``, one with "a little" ``little_s``.
    """

    fraction: float
    step: float
    lowest: float
    highest: float
    lasts_s: float
    little_s: float


@dataclass(frozen=True)
class Language:
    """The phrases of one language, in lower case, words separated by one space.

    ``stop`` are single words, optionally between phrases of ``stop_before`` and ``stop_after``.
    ``drive`` maps a direction to (verbs, words), ``manner`` a manner to its phrases, ``robots`` an
    action on robots, ``requests`` a request to the panel, ``sources`` a source of ``mux.yaml``.
    ``pronunciations`` maps a word to its pronunciations (CMU phones). ``teach`` are the sentences
    to learn a voice from, ``teach_check`` those to check it with.
    """

    name: str
    wake_words: Tuple[str, ...]
    stop: Tuple[str, ...]
    stop_before: Tuple[str, ...]
    stop_after: Tuple[str, ...]
    please: Tuple[str, ...]
    drive: Dict[str, Tuple[Tuple[str, ...], Tuple[str, ...]]]
    manner: Dict[str, Tuple[str, ...]]
    robots: Dict[str, Tuple[str, ...]]
    numbers: Tuple[str, ...]
    joiners: Tuple[str, ...]
    requests: Dict[str, Tuple[str, ...]]
    use: Tuple[str, ...]
    sources: Dict[str, Tuple[str, ...]]
    pronunciations: Dict[str, Tuple[str, ...]]
    teach: Tuple[str, ...]
    teach_check: Tuple[str, ...]
    motion: Motion
    wake_window_s: float
    push_to_talk_s: float


def parse_language(text: str, origin: str) -> Language:
    """Return the :class:`Language` that a YAML text describes.

    :raises ConfigError: names the file and the wrong key
    """
    section = parse_yaml(text, origin)
    stop = _phrases(section, 'stop')
    for phrase in stop:
        if ' ' in phrase:
            raise section.error('stop', 'a stop is one word, so that it is spotted at once; got '
                                '{!r}'.format(phrase))
    robots = section.section('robots')
    language = Language(
        name=section.text('name'), wake_words=_phrases(section, 'wake_words'), stop=stop,
        stop_before=_phrases(section, 'stop_before', ()),
        stop_after=_phrases(section, 'stop_after', ()),
        please=_phrases(section, 'please', ()), drive=_drive(section.section('drive')),
        manner=_table(section.section('manner'), MANNERS),
        numbers=_phrases(robots, 'numbers', ()), joiners=_phrases(robots, 'and', ()),
        robots=_table(robots, ROBOT_ACTIONS + GROUP_ACTIONS),
        requests=_table(section.section('requests'), REQUESTS), use=_phrases(section, 'use'),
        sources=_free_table(section, 'sources', _WORD_OR_PHRASE, 'lower-case words'),
        pronunciations=_free_table(section, 'pronunciations', _SOUNDS, 'CMU phones such as B AA T'),
        teach=_phrases(section, 'teach', ()), teach_check=_phrases(section, 'teach_check', ()),
        motion=_motion(section.section('motion')),
        **_listening(section.section('listening')))
    section.close()
    return language


def _phrases(section: Section, key: str,
             default: Optional[Tuple[str, ...]] = None) -> Tuple[str, ...]:
    """Read a list of phrases; at least one is required without a default."""
    phrases = section.texts(key) if default is None else section.texts(key, default)
    if default is None and not phrases:
        raise section.error(key, 'name at least one phrase')
    for phrase in phrases:
        if not _WORD_OR_PHRASE.match(phrase):
            raise section.error(key, 'expected lower-case words with one space between them, got '
                                '{!r}'.format(phrase))
    return phrases


def _table(section: Section, keys: Iterable[str]) -> Dict[str, Tuple[str, ...]]:
    """Read {key: phrases} of fixed keys."""
    table = {key: _phrases(section, key) for key in keys}
    section.close()
    return table


def _drive(section: Section) -> Dict[str, Tuple[Tuple[str, ...], Tuple[str, ...]]]:
    """Read the verbs and words of each direction."""
    drive = {}
    for direction in DIRECTIONS:
        row = section.section(direction)
        drive[direction] = (_phrases(row, 'verbs', ()), _phrases(row, 'words'))
        row.close()
    section.close()
    return drive


def _free_table(section: Section, key: str, form: Pattern[str],
                expected: str) -> Dict[str, Tuple[str, ...]]:
    """Read {any key: texts of a form}, e.g. the sources of a lab."""
    value = section.take(key, {})
    if not isinstance(value, dict):
        raise section.error(key, 'expected a mapping, got {!r}'.format(value))
    table = {}
    for name, texts in value.items():
        texts = [texts] if isinstance(texts, str) else texts
        good = isinstance(texts, list) and texts and all(
            isinstance(text, str) and form.match(text) for text in texts)
        if not good:
            raise section.error('{}.{}'.format(key, name), 'expected a list of {}, got {!r}'.format(
                expected, texts))
        table[str(name)] = tuple(texts)
    return table


def _motion(section: Section) -> Motion:
    """Read the speeds and times of spoken commands."""
    motion = Motion(
        fraction=section.number('fraction', 0.01, 1.0), step=section.number('step', 0.01, 1.0),
        lowest=section.number('lowest', 0.01, 1.0), highest=section.number('highest', 0.01, 1.0),
        lasts_s=section.number('lasts_s', 0.1, MAX_MOTION_S),
        little_s=section.number('little_s', 0.1, MAX_MOTION_S))
    if not motion.lowest <= motion.fraction <= motion.highest:
        raise section.error('fraction', 'must lie between lowest and highest')
    section.close()
    return motion


def _listening(section: Section) -> Dict[str, float]:
    """Read the durations of wake word and push-to-talk."""
    times = {'wake_window_s': section.number('wake_window_s', 0.0, 10.0),
             'push_to_talk_s': section.number('push_to_talk_s', 1.0, 60.0)}
    section.close()
    return times
