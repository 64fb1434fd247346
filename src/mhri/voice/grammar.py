# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The grammar of the robots that are there: what the recogniser looks for, and what it means."""
from dataclasses import dataclass, replace
from typing import Any, Callable, Dict, Iterable, Iterator, List, Optional, Tuple

from mhri.voice.language import GROUP_ACTIONS, Language, ROBOT_ACTIONS
from mhri.voice.names import call_robots, number_words, numbered

# Numbers up to this are recognised, whether a robot has them or not.
MAX_NUMBER = 20
DRIVE, PACE, PANEL, MODE, STOP, WAKE, NOBODY = (
    'drive', 'pace', 'panel', 'mode', 'stop', 'wake', 'nobody')
_Words = Tuple[str, ...]


@dataclass(frozen=True)
class Command:
    """What was said, as a value.

    ``kind`` is DRIVE (``action``: a direction, ``manner``: '' or one of ``MANNERS``), PACE
    (``action``: faster or slower), PANEL (``action`` of ``mhri/PanelRequest``, ``robots``), MODE
    (``action``: a source), STOP, WAKE (the wake word alone), or NOBODY (``action``: what a robot
    was meant for by a number that none has). ``woken`` tells whether the wake word came with it.
    """

    kind: str
    action: str = ''
    manner: str = ''
    robots: Tuple[str, ...] = ()
    woken: bool = False

    @property
    def words(self) -> str:
        """The command in one line, e.g. 'forward little', 'select bot1 bot2', 'use pedal'."""
        if self.kind in (STOP, WAKE):
            return self.kind
        first = 'use ' + self.action if self.kind == MODE else self.action
        return ' '.join([first] + [self.manner] * bool(self.manner) + list(self.robots))


def _after(words: _Words, phrases: Iterable[str]) -> Iterator[_Words]:
    """Yield what follows each of the phrases that the words begin with."""
    for phrase in phrases:
        start = tuple(phrase.split())
        if words[:len(start)] == start:
            yield words[len(start):]


def _seldom(text: str) -> str:
    """Write in JSGF what may be left out, and mostly is: it must not stand for another word."""
    return '(/0.9/ <NULL> | /0.1/ {})'.format(text)


def _any_of(phrases: Iterable[str]) -> str:
    """Write alternatives in JSGF."""
    return '(' + ' | '.join(sorted(set(phrases))) + ')'


class Grammar:
    """The phrases of a language with the robots of the panel's list.

    :param language: :class:`mhri.voice.language.Language`
    :param robots: names, each in the place of its number, from 1; '' if nobody has it
    :param knows: function that tells whether the model's dictionary has a word
    """

    def __init__(self, language: Language, robots: Iterable[Any],
                 knows: Callable[[str], bool]) -> None:
        self.language = language
        self._fixed = self._fixed_phrases()
        taken = {word for phrase in self._fixed for word in phrase.split()}
        taken |= {word for phrase in language.joiners + language.numbers + language.please
                  for word in phrase.split()}
        # "robot one" may be a robot's name and a robot's number; then it is the name.
        taken -= set(language.numbers) & set(language.wake_words) - set(language.stop)
        self.robots = tuple(robots)
        self.called, self.notes = call_robots(
            self.robots, lambda word: word in language.pronunciations or knows(word), taken,
            language.wake_words)
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
        """Every word of the grammar, sorted: what the recogniser's dictionary has to hold."""
        language = self.language
        phrases = (self._fixed + tuple(self._robots) + tuple(self._nobody) + language.joiners
                   + language.please
                   + language.stop_before + language.stop_after)
        return sorted({word for phrase in phrases for word in phrase.split()})

    def moves(self, text: str) -> bool:
        """Tell whether words mean a motion."""
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

        :param motion: False: without what moves a robot
        """
        drives = self._drives() if motion else []
        language = self.language
        others = [phrase for action in GROUP_ACTIONS for phrase in language.robots[action]]
        others += [phrase for phrases in language.requests.values() for phrase in phrases]
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
        """Return the :class:`Command` that words mean, or None if they mean none.

        A word of ``stop`` anywhere stops, but for the phrases of the grammar that have it inside
        ("stop recording") and begin with the wake word or stand alone.
        """
        words = tuple(text.split())
        command = self._parse_whole(words)
        if command is None and any(word in self.language.stop for word in words):
            return Command(STOP)
        return command

    def _parse_whole(self, words: _Words) -> Optional[Command]:
        """Parse without the spotting of stop."""
        for rest in _after(words, self.language.wake_words):
            if not rest:
                return Command(WAKE, woken=True)
            command = self._parse_command(rest, True)
            if command:
                return command
        return self._parse_command(words, False)

    def _parse_command(self, words: _Words, woken: bool) -> Optional[Command]:
        """Parse what follows the wake word."""
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
        """Return the command of what is not a motion, or None."""
        language = self.language
        text = ' '.join(words)
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
        """Return what robots are chosen for by name or number, or None."""
        for action in ROBOT_ACTIONS:
            for rest in _after(words, self.language.robots[action]):
                robots = self._named(rest)
                if robots:
                    return Command(PANEL, action, '', robots)
                if ' '.join(rest) in self._nobody:
                    return Command(NOBODY, action)
        return None

    def _named(self, words: _Words) -> Tuple[str, ...]:
        """Return the robots that words name, one or two of them, or ()."""
        text = ' '.join(words)
        if text in self._robots:
            return (self._robots[text],)
        for joiner in self.language.joiners:
            first, found, second = text.partition(' {} '.format(joiner))
            if found and first in self._robots and second in self._robots:
                return tuple(dict.fromkeys((self._robots[first], self._robots[second])))
        return ()
