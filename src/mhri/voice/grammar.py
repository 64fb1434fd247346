# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The grammar for the present robots: the phrases to recognise, and their meanings."""
from dataclasses import dataclass, replace
from typing import Any, Callable, Dict, Iterable, Iterator, List, Optional, Tuple

from mhri.voice.accessories import call_accessories, SpokenRow
from mhri.voice.language import GROUP_ACTIONS, Language, ROBOT_ACTIONS
from mhri.voice.names import call_robots, number_words, numbered

# Numbers up to this are recognised, whether a robot has them or not.
MAX_NUMBER = 20
DRIVE, PACE, PANEL, MODE, STOP, WAKE, NOBODY = (
    'drive', 'pace', 'panel', 'mode', 'stop', 'wake', 'nobody')
# The action of the panel for an accessory.
ACCESSORY = 'accessory'
_Words = Tuple[str, ...]


@dataclass(frozen=True)
class Command:
    """A spoken command as a value.

    ``kind`` is DRIVE (``action``: a direction, ``manner``: '' or one of ``MANNERS``), PACE
    (``action``: faster or slower), PANEL (``action`` of ``mhri/PanelRequest``, ``robots``), MODE
    (``action``: a source), STOP, WAKE (the wake word alone), or NOBODY (``action``: the action for
    an unassigned number). ``woken``: whether it was said with the wake word. ``key`` and ``choice``
    are those of an accessory.
    """

    kind: str
    action: str = ''
    manner: str = ''
    robots: Tuple[str, ...] = ()
    woken: bool = False
    key: str = ''
    choice: str = ''

    @property
    def acts(self) -> bool:
        """Whether it moves something, and must not be carried out late."""
        return self.kind in (DRIVE, PACE) or bool(self.key)

    @property
    def words(self) -> str:
        """The command in one line, e.g. 'forward little', 'select bot1 bot2', 'use pedal'."""
        if self.kind in (STOP, WAKE):
            return self.kind
        if self.key:
            return ' '.join(filter(None, (self.key, self.choice)))
        first = 'use ' + self.action if self.kind == MODE else self.action
        return ' '.join([first] + [self.manner] * bool(self.manner) + list(self.robots))


def _after(words: _Words, phrases: Iterable[str]) -> Iterator[_Words]:
    """Yield the remaining words after each phrase at their beginning."""
    for phrase in phrases:
        start = tuple(phrase.split())
        if words[:len(start)] == start:
            yield words[len(start):]


def _seldom(text: str) -> str:
    """Return a rarely used part in JSGF, with a low weight so that it matches no other word."""
    return '(/0.9/ <NULL> | /0.1/ {})'.format(text)


def _any_of(phrases: Iterable[str]) -> str:
    """Return alternatives in JSGF."""
    return '(' + ' | '.join(sorted(set(phrases))) + ')'


class Grammar:
    """The phrases of a language with the robots of the panel's list.

    :param language: :class:`mhri.voice.language.Language`
    :param robots: names in the order of their numbers, from 1; '' for an unused number
    :param knows: function that returns whether the model's dictionary has a word
    :param accessories: of the robots, each a :class:`SpokenRow` or a list of its values
    """

    def __init__(self, language: Language, robots: Iterable[Any], knows: Callable[[str], bool],
                 accessories: Iterable[Iterable[Any]] = ()) -> None:
        self.language = language
        self._fixed = self._fixed_phrases()
        #: the words that no name and no accessory may have
        self.taken = frozenset(
            word for phrase in self._fixed + language.joiners + language.numbers + language.please
            for word in phrase.split())
        self.robots = tuple(robots)
        self.accessories = tuple(SpokenRow(*row) for row in accessories)

        def has(word: str) -> bool:
            return word in language.pronunciations or knows(word)
        # "robot one" may be both the name of a robot and a number; then the name takes precedence.
        self.called, notes = call_robots(
            self.robots, has, self.taken - (
                set(language.numbers) & set(language.wake_words) - set(language.stop)),
            language.wake_words)
        self._acts, more = call_accessories(self.accessories, has, self.taken)
        self.notes = notes + more
        self._robots: Dict[str, str] = {}
        for name, number in numbered(self.robots).items():
            for prefix in ('',) + language.numbers:
                self._robots[' '.join([prefix, number_words(number)]).strip()] = name
        self._robots.update({phrase: name for name, phrases in self.called.items()
                             for phrase in phrases})
        # Unassigned numbers are recognised, too: otherwise "select number four" could be mistaken
        # for a motion that sounds like it.
        self._nobody = frozenset(
            ' '.join([prefix, number_words(number)]).strip() for number in range(MAX_NUMBER + 1)
            for prefix in ('',) + language.numbers).difference(self._robots)

    def _fixed_phrases(self) -> Tuple[str, ...]:
        """Return every phrase that does not depend on the robots."""
        language = self.language
        tables = [language.manner, language.robots, language.requests, language.sources]
        phrases = [phrase for table in tables for entry in table.values() for phrase in entry]
        for verbs, words in language.drive.values():
            phrases += verbs + words
        return tuple(phrases) + language.wake_words + language.stop + language.use

    @property
    def words(self) -> List[str]:
        """All words of the grammar, sorted, for the recogniser's dictionary."""
        language = self.language
        phrases = (self._fixed + tuple(self._robots) + tuple(self._nobody) + tuple(self._acts)
                   + language.joiners
                   + language.please
                   + language.stop_before + language.stop_after)
        return sorted({word for phrase in phrases for word in phrase.split()})

    def moves(self, text: str) -> bool:
        """Return whether words are a command of motion."""
        command = self.parse(text)
        return command is not None and command.kind in (DRIVE, PACE)

    def _drives(self) -> List[str]:
        """Return the motions in the JSpeech Grammar Format."""
        language = self.language
        manners = [phrase for phrases in language.manner.values() for phrase in phrases]
        paces = language.manner['faster'] + language.manner['slower']
        drives = ['{} {} [{}]'.format('[' + _any_of(verbs) + ']' if verbs else '', _any_of(words),
                                      _any_of(manners))
                  for verbs, words in language.drive.values()]
        going = sorted({verb for verbs, _ in language.drive.values() for verb in verbs})
        drives.append('[{}] {}'.format(_any_of(going), _any_of(paces)) if going
                      else _any_of(paces))
        return drives

    def jsgf(self, motion: bool = True) -> str:
        """Return the grammar in the JSpeech Grammar Format; its public rule is ``said``.

        :param motion: whether to include motions
        """
        drives = self._drives() if motion else []
        language = self.language
        others = [phrase for action in GROUP_ACTIONS for phrase in language.robots[action]]
        others += [phrase for phrases in language.requests.values() for phrase in phrases]
        others += sorted(self._acts)
        if language.sources:
            others.append('{} {}'.format(_any_of(language.use), _any_of(
                phrase for phrases in language.sources.values() for phrase in phrases)))
        actions = [phrase for action in ROBOT_ACTIONS for phrase in language.robots[action]]
        if self._robots:
            more = (_seldom('({} <robot>)'.format(_any_of(language.joiners)))
                    if language.joiners else '')
            others.append('{} <robot> {}'.format(_any_of(actions), more))
        others.append('{} <nobody>'.format(_any_of(actions)))
        please = _seldom(_any_of(language.please)) if language.please else ''
        before, after = ('[{}]'.format(_any_of(phrases)) if phrases else ''
                         for phrases in (language.stop_before, language.stop_after))
        rules = ['#JSGF V1.0;', 'grammar mhri;', '<nobody> = {};'.format(_any_of(self._nobody))]
        if self._robots:
            rules.append('<robot> = {};'.format(_any_of(self._robots)))
        rules += ['<command> = {};'.format(' | '.join(drives + others)),
                  '<wake> = {};'.format(_any_of(language.wake_words)),
                  '<stop> = {};'.format(_any_of(language.stop)),
                  'public <said> = <wake> | [<wake>] {0} <command> {0} | [<wake>] {1} <stop>+ {2};'
                  .format(please, before, after)]
        return '\n'.join(rules) + '\n'

    def parse(self, text: str) -> Optional[Command]:
        """Return the :class:`Command` for words, or None.

        A word of ``stop`` anywhere is a stop, except in phrases of the grammar that contain it
        ("stop recording"), alone or after the wake word.
        """
        words = tuple(text.split())
        command = self._parse_whole(words)
        if command is None and any(word in self.language.stop for word in words):
            return Command(STOP)
        return command

    def _parse_whole(self, words: _Words) -> Optional[Command]:
        """Parse the words without searching for a stop."""
        for rest in _after(words, self.language.wake_words):
            if not rest:
                return Command(WAKE, woken=True)
            command = self._parse_command(rest, True)
            if command:
                return command
        return self._parse_command(words, False)

    def _parse_command(self, words: _Words, woken: bool) -> Optional[Command]:
        """Parse the words after the wake word."""
        for start in list(_after(words, self.language.please)) + [words]:
            for phrase in (None,) + self.language.please:
                size = len(phrase.split()) if phrase else 0
                if phrase and start[-size:] != tuple(phrase.split()):
                    continue
                body = start[:len(start) - size]
                command = self._drive(body) or self._request(body)
                if command:
                    return replace(command, woken=woken)
        return None

    def _drive(self, words: _Words) -> Optional[Command]:
        """Return the command of a motion, or None."""
        language = self.language
        for direction, (verbs, names) in language.drive.items():
            for rest in list(_after(words, verbs)) + [words]:
                for end in _after(rest, names):
                    if not end:
                        return Command(DRIVE, direction)
                    for manner, phrases in language.manner.items():
                        if ' '.join(end) in phrases:
                            return Command(DRIVE, direction, manner)
        for rest in [words] + [end for verbs, _ in language.drive.values()
                               for end in _after(words, verbs)]:
            for pace in ('faster', 'slower'):
                if ' '.join(rest) in language.manner[pace]:
                    return Command(PACE, pace)
        return None

    def _request(self, words: _Words) -> Optional[Command]:
        """Return the command if it is not a motion, or None."""
        language = self.language
        text = ' '.join(words)
        if text in self._acts:
            key, choice = self._acts[text]
            return Command(PANEL, ACCESSORY, key=key, choice=choice)
        for kind, table in ((PANEL, language.requests),
                            (PANEL, {key: language.robots[key] for key in GROUP_ACTIONS})):
            for action, phrases in table.items():
                if text in phrases:
                    return Command(kind, action)
        for rest in _after(words, language.use):
            for source, phrases in language.sources.items():
                if ' '.join(rest) in phrases:
                    return Command(MODE, source)
        return self._of_robots(words)

    def _of_robots(self, words: _Words) -> Optional[Command]:
        """Return the command on robots by name or number, or None."""
        for action in ROBOT_ACTIONS:
            for rest in _after(words, self.language.robots[action]):
                robots = self._named(rest)
                if robots:
                    return Command(PANEL, action, '', robots)
                if ' '.join(rest) in self._nobody:
                    return Command(NOBODY, action)
        return None

    def _named(self, words: _Words) -> Tuple[str, ...]:
        """Return the one or two robots that words name, or ()."""
        text = ' '.join(words)
        if text in self._robots:
            return (self._robots[text],)
        for joiner in self.language.joiners:
            first, found, second = text.partition(' {} '.format(joiner))
            if found and first in self._robots and second in self._robots:
                return tuple(dict.fromkeys((self._robots[first], self._robots[second])))
        return ()
