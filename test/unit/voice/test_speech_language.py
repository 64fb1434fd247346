# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What can be said, as a file: the shipped one, and one for each way of being wrong."""
import copy
from pathlib import Path

import pytest
import yaml

from mhri.base.config import ConfigError
from mhri.voice.language import DIRECTIONS, parse_language

RESOURCE = Path(__file__).resolve().parents[3] / 'resource'
PATH = RESOURCE / 'voice' / 'english.yaml'
TEXT = PATH.read_text()


def test_the_shipped_language():
    language = parse_language(TEXT, str(PATH))
    assert language.name == PATH.stem
    assert language.stop == ('stop',)
    assert set(language.drive) == set(DIRECTIONS)
    assert language.motion.lasts_s <= 2.0
    assert language.drive['left'] == (('turn', 'go', 'move', 'drive'), ('left',))


def test_it_can_choose_every_source_there_is():
    """A source that is added to mux.yaml gets a phrase as well."""
    rows = yaml.safe_load((RESOURCE / 'mux.yaml').read_text())['sources']
    assert set(parse_language(TEXT, 'x').sources) == {row['name'] for row in rows}


def changed(path, value):
    """Return the shipped file with one value changed; None takes it out."""
    data = copy.deepcopy(yaml.safe_load(TEXT))
    *parents, key = path.split('.')
    place = data
    for parent in parents:
        place = place[parent]
    if value is None:
        del place[key]
    else:
        place[key] = value
    return yaml.safe_dump(data)


WRONG = [
    ('wake_words', None, 'is missing'),
    ('wake_words', ['Robot'], 'lower-case'),
    ('stop', ['stop now'], 'one word'),
    ('drive.left', None, 'is missing'),
    ('drive.up', {'words': ['up']}, 'unknown key'),
    ('requests.record', None, 'is missing'),
    ('sources.joy', [], 'list of lower-case'),
    ('pronunciations.bot', ['b aa t'], 'CMU phones'),
    ('motion.lasts_s', 2.5, 'from 0.1 to 2'),
    ('motion.fraction', float('nan'), 'number from'),
    ('motion.fraction', 0.1, 'between lowest and highest'),
    ('listening.push_to_talk_s', 'long', 'number from'),
    ('loudness', 3, 'unknown key')]


@pytest.mark.parametrize('path, value, words', WRONG)
def test_what_is_wrong_is_refused_by_name(path, value, words):
    with pytest.raises(ConfigError) as caught:
        parse_language(changed(path, value), 'mine.yaml')
    assert str(caught.value).startswith('mine.yaml: ')
    assert words in str(caught.value)
    assert path.split('.')[-1] in str(caught.value)


def test_one_phrase_may_stand_without_a_list():
    assert parse_language(changed('wake_words', 'computer'), 'x').wake_words == ('computer',)
    assert parse_language(changed('sources.joy', 'stick'), 'x').sources['joy'] == ('stick',)
