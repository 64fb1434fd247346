# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What is said to use accessories: the words of a robot type into phrases and commands."""
import json

import pytest

from mhri.base.accessories import COMMAND_WORDS
from mhri.voice.accessories import spoken_rows
from mhri.voice.grammar import ACCESSORY, Command, Grammar, PANEL, STOP
from mhri.voice.language import parse_language

from support.paths import RESOURCE
from support.tools import ROWS, specs
from test_speech_grammar import said_by

PATH = RESOURCE / 'voice' / 'english.yaml'
LANGUAGE = parse_language(PATH.read_text(), str(PATH))
WORDS = set('lamp on off siren horn gripper open close arm pose rest high carry led one '
            'light beacon head fan hoot sound battery low'.split())
MORE = ROWS + """
  fan: {kind: toggle, topic: fan, on_stop: stop}
  door: {kind: toggle, topic: door, on_stop: stop, words: [beacon]}
  mute: {kind: toggle, topic: mute, on_stop: keep, words: []}
  led1: {kind: toggle, label: LED 1, topic: led, on_stop: keep}
  hooter: {kind: tap, topic: hooter, on_stop: keep, words: [hoot, siren light]}
  sound: {kind: tap, topic: sound, on_stop: keep, choices: {low_battery: {data: 1}}}
"""


def grammar(rows=MORE, words=WORDS):
    """Return the grammar as the process that listens has it, behind its channel."""
    found = spoken_rows(specs(rows).values())
    return Grammar(LANGUAGE, ['bot1'], words.__contains__, json.loads(json.dumps(found)))


MEANT = {
    'lamp on': ('lamp', 'on'), 'lamp off': ('lamp', 'off'), 'siren on': ('siren', 'on'),
    'horn': ('horn', ''), 'gripper open': ('gripper', 'open'),
    'led one off': ('led1', 'off'), 'hoot': ('hooter', ''), 'siren light': ('hooter', ''),
    'sound low battery': ('sound', 'low_battery'),
    # Its row has words, although only another word ends its motion.
    'beacon on': ('door', 'on')}


@pytest.mark.parametrize('text', MEANT)
def test_what_is_said_for_an_accessory(text):
    key, choice = MEANT[text]
    expected = Command(PANEL, ACCESSORY, woken=True, key=key, choice=choice)
    assert grammar().parse('robot ' + text) == grammar().parse(
        'robot please {} please'.format(text)) == expected
    assert expected.words == ' '.join(filter(None, MEANT[text])) and expected.acts


@pytest.mark.parametrize('text', [
    # What is held, and what only another word would end; without words; by its key or its choice.
    'head', 'flipper', 'winch', 'fan on', 'arm pose rest', 'mute on', 'door on', 'hooter', 'lamp',
    'open', 'lamp on off', 'gripper on'])
def test_what_is_no_command(text):
    assert grammar().parse('robot ' + text) is None


def test_a_stop_in_it_is_a_stop():
    assert grammar().parse('robot lamp stop') == grammar().parse('stop lamp on') == Command(STOP)


def test_every_sentence_with_accessories_has_a_meaning():
    made = grammar()
    sentences = said_by(made.jsgf())
    assert all(made.parse(sentence) is not None for sentence in sentences)
    assert {'robot ' + text for text in MEANT} <= sentences & said_by(made.jsgf(motion=False))
    assert {word for text in MEANT for word in text.split()} <= set(made.words)
    assert made.notes == []


@pytest.mark.parametrize('rows, said, named', [
    ('{kind: toggle, label: left lamp, topic: lamp, on_stop: keep}', 'left lamp on', 'left'),
    ('{kind: tap, topic: lamp, on_stop: keep, choices: {on: {}, stop: {}}}', 'lamp stop', 'stop'),
    ('{kind: tap, topic: lamp, on_stop: keep, words: [lamp, flob]}', 'flob', 'flob'),
    ('{kind: tap, label: xqzwvv, topic: lamp, on_stop: keep}', 'xqzwvv', 'xqzwvv'),
    ('{kind: toggle, topic: lamp, on_stop: keep}\n  light: {kind: toggle, topic: light, '
     'on_stop: keep, words: [lamp]}', 'lamp on', 'lamp')])
def test_what_cannot_be_said_is_named_and_everything_else_can(rows, said, named):
    made = grammar('\n  lamp: ' + rows)
    assert made.notes and all(named in note for note in made.notes)
    command = made.parse('robot ' + said)
    assert command is None or command.kind == STOP or command.key == 'lamp'
    assert made.parse('robot drive forward')


def test_a_word_has_the_sounds_of_the_language():
    assert 'forward' not in WORDS and 'rover' in LANGUAGE.pronunciations
    made = grammar('\n  lamp: {kind: tap, topic: lamp, on_stop: keep, words: [rover]}')
    assert made.parse('robot rover').key == 'lamp' and not made.notes


def test_the_words_that_a_type_may_not_have_are_those_of_the_commands():
    assert COMMAND_WORDS == Grammar(LANGUAGE, [], WORDS.__contains__).taken
