# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The grammar: every utterance of the sets means what is written beside it, and no talk does."""
import itertools
import re

import pytest

from mhri.voice.grammar import Command, DRIVE, Grammar, MODE, NOBODY, PANEL, STOP, WAKE
from mhri.voice.language import parse_language

from support import speech
from support.paths import RESOURCE

PATH = RESOURCE / 'voice' / 'english.yaml'
LANGUAGE = parse_language(PATH.read_text(), str(PATH))
WORDS = set('bot rover turtle t b'.split())
GRAMMAR = Grammar(LANGUAGE, speech.ROBOTS, WORDS.__contains__)
COMMANDS = speech.commands('tune') + speech.commands('test')
# What no recogniser returns, since the grammar does not have it: only a stop is spotted in it.
OUTSIDE = {'stop them all', 'stop immediately', 'everybody stop'}


@pytest.mark.parametrize('utterance', COMMANDS, ids=lambda utterance: utterance.text)
def test_every_command_means_what_is_written_beside_it(utterance):
    command = GRAMMAR.parse(utterance.text)
    assert command.words == utterance.expected
    if command.kind != STOP:
        assert command.woken


def test_talk_is_no_command():
    """Only "stop" is found in it, as it would be spotted."""
    for utterance in speech.talk('tune') + speech.talk('test'):
        command = GRAMMAR.parse(utterance.text.lower())
        assert command is None or command.kind == STOP, utterance.text
        if command:
            assert 'stop' in utterance.text.lower().split()


MEANT = [
    ('', None), ('robot', Command(WAKE, woken=True)),
    ('drive forward', Command(DRIVE, 'forward')),
    ('robot robot', None), ('forward robot', None), ('robot forward left', None),
    ('robot turn forward', None), ('robot drive forward a little faster', None),
    ('robot select', None), ('robot select bot nine', None),
    ('robot select bot one and', None),
    ('robot select bot one and bot one', Command(PANEL, 'select', '', ('bot1',), True)),
    ('robot use', None), ('robot use voice', Command(MODE, 'voice', woken=True)),
    ('robot please drive forward please', Command(DRIVE, 'forward', woken=True)),
    ('stop recording', Command(PANEL, 'stop_recording')),
    ('robot drive forward stop', Command(STOP)),
    ('stop robot drive forward', Command(STOP)),
    ('robot stop recording now', Command(STOP))]


@pytest.mark.parametrize('text, command', MEANT, ids=[text for text, _ in MEANT])
def test_meaning(text, command):
    assert GRAMMAR.parse(text) == command


def said_by(jsgf):
    """Return every sentence of a JSGF grammar, as :meth:`Grammar.jsgf` writes it."""
    rules = dict(re.findall(r'^(?:public )?<(\w+)> = (.*);$', jsgf, re.M))

    def alternatives(tokens):
        found = sequence(tokens)
        while tokens and tokens[0] == '|':
            tokens.pop(0)
            found = found + sequence(tokens)
        return found

    def sequence(tokens):
        found = ['']
        while tokens and tokens[0] not in '|)]':
            part = item(tokens)
            found = [' '.join(pair).strip() for pair in itertools.product(found, part)]
        return found

    def item(tokens):
        token = tokens.pop(0)
        if token in '([':
            found = alternatives(tokens)
            assert tokens.pop(0) in ')]'
            return found + [''] if token == '[' else found
        if token == '<NULL>':
            return ['']
        # "+": as often as one likes; once is enough here.
        token = token.rstrip('+')
        return rule(token[1:-1]) if token[0] == '<' else [token]

    def rule(name):
        return alternatives(re.findall(r"<\w+>\+?|[()\[\]|]|[a-z']+", rules[name]))

    return set(rule('said'))


def test_all_that_the_recogniser_can_return_has_a_meaning():
    """Every sentence of the grammar parses, and each command of the sets is a sentence of it."""
    small = Grammar(LANGUAGE, ['bot1', 'rover'], WORDS.__contains__)
    sentences = said_by(small.jsgf())
    assert len(sentences) > 1000
    for sentence in sentences:
        assert small.parse(sentence) is not None, sentence
    for utterance in COMMANDS:
        if (not re.search('bot two|three|four|five|six', utterance.text)
                and utterance.text not in OUTSIDE):
            text = re.sub(r'\bstop( stop)+\b', 'stop', utterance.text)
            assert text in sentences or small.parse(text) is None, text


def test_only_the_words_of_the_sentences_are_in_the_dictionary():
    grammar = Grammar(LANGUAGE, ['bot1'], WORDS.__contains__)
    used = {word for sentence in said_by(grammar.jsgf()) for word in sentence.split()}
    assert used == set(grammar.words)


def test_without_robots_nothing_is_selected_by_name():
    grammar = Grammar(LANGUAGE, [], WORDS.__contains__)
    assert grammar.parse('robot select bot one') is None
    assert grammar.parse('robot select all') == Command(PANEL, 'select_all', woken=True)
    assert '<robot>' not in grammar.jsgf()


@pytest.mark.parametrize('robots', [[], ['bot1', 'bot2', 'bot3'], ['bot1', '', 'tango']])
def test_a_number_that_no_robot_has_is_known_and_means_nobody(robots):
    """Else it is taken for what sounds most like it: "number four" for "forward"."""
    grammar = Grammar(LANGUAGE, robots, WORDS.__contains__)
    heard = grammar.parse('robot select number four')
    assert heard == Command(NOBODY, 'select', woken=True) and not grammar.moves(
        'robot select number four')
    assert 'number four' in grammar.jsgf() and {'number', 'four', 'twenty'} <= set(grammar.words)
    named = Grammar(LANGUAGE, ['a', 'b', 'c', 'tango'], WORDS.__contains__)
    assert named.parse('robot select number four').robots == ('tango',)


def test_a_robot_that_cannot_be_spoken_goes_by_its_number():
    grammar = Grammar(LANGUAGE, ['zzzzzz', 'stop1'], WORDS.__contains__)
    assert grammar.parse('robot select two').robots == ('stop1',)
    assert grammar.parse('robot select number one').robots == ('zzzzzz',)
    assert len(grammar.notes) == 2
    gaps = Grammar(LANGUAGE, grammar.robots[:1] + ('', '') + grammar.robots[1:], WORDS.__contains__)
    assert gaps.parse('robot select four').robots == ('stop1',)
    assert gaps.parse('robot select two').kind == NOBODY
    # Above all, no robot's name becomes a stop or takes it away.
    assert grammar.parse('robot select stop one') == Command(STOP)
