# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Configuration text: every kind of value, every kind of slip."""
import time

import pytest
import yaml

from mhri.base.config import (
    ConfigError, MAX_BYTES, parse_yaml, Section, yaml_text, yaml_value)
from mhri.base.robot_types import parse_robot_type
from mhri.devices.pedals import parse_pedal_profile
from mhri.devices.profile import parse_profile
from mhri.driving.sources import parse_mux_config
from mhri.robots.discovery import parse_ignore_list
from mhri.voice.language import parse_language

READERS = {
    'text': lambda section: section.text('key'),
    'flag': lambda section: section.flag('key'),
    'number': lambda section: section.number('key', 0.0, 10.0),
    'index': lambda section: section.index('key'),
    'texts': lambda section: section.texts('key'),
    'section': lambda section: section.section('key'),
    'sections': lambda section: section.sections('key'),
    'named_sections': lambda section: section.named_sections('key'),
}
GOOD = [
    ('text', 'a', 'a'), ('flag', False, False), ('number', 0, 0.0), ('number', 10, 10.0),
    ('index', 0, 0), ('texts', 'a', ('a',)), ('texts', ['a', 'b'], ('a', 'b')), ('texts', [], ())]
BAD = [
    ('text', 1), ('text', ['a']), ('text', True), ('flag', 'yes'), ('flag', 1), ('flag', 0),
    ('number', '1'), ('number', True), ('number', float('nan')), ('number', float('inf')),
    ('number', -0.1), ('number', 10.1), ('number', [1]), ('index', -1), ('index', 1.0),
    ('index', True), ('index', '1'), ('texts', 1), ('texts', ['a', 1]), ('texts', {'a': 1}),
    ('section', 'a'), ('section', [1]), ('sections', {}), ('sections', ['a']), ('sections', 'a'),
    ('named_sections', []), ('named_sections', {'a': 1})]


@pytest.mark.parametrize('reader, value, expected', GOOD)
def test_good_values(reader, value, expected):
    """Read as what they are."""
    assert READERS[reader](Section({'key': value}, 'f')) == expected


@pytest.mark.parametrize('reader, value', BAD)
def test_bad_values_name_file_and_key(reader, value):
    """And are never bent into something else."""
    with pytest.raises(ConfigError) as error:
        READERS[reader](Section({'key': value}, 'f.yaml', 'top'))
    assert str(error.value).startswith('f.yaml: top.key')
    assert error.value.origin == 'f.yaml'


@pytest.mark.parametrize('reader', sorted(set(READERS) - {'named_sections'}))
@pytest.mark.parametrize('mapping', [{}, {'key': None}])
def test_missing_values(reader, mapping):
    """A key without a value is missing as well."""
    with pytest.raises(ConfigError, match='f: key: is missing'):
        READERS[reader](Section(mapping, 'f'))


def test_defaults():
    """Returned as they are, checked by nobody."""
    section = Section({}, 'f')
    assert section.text('a', None) is None and section.number('a', 0, 1, 7) == 7
    assert section.index('a', None) is None and section.texts('a', ()) == ()
    assert section.flag('a', True) is True and section.section('a', None) is None
    assert section.named_sections('a') == {} and 'a' not in section


def test_close_refuses_what_nobody_asked_for():
    """Most often a slip of the pen; keys need not be texts."""
    section = Section({'a': 1, 'colour': 2, 3: 4}, 'f')
    section.index('a')
    with pytest.raises(ConfigError, match='f: 3: unknown key'):
        section.close()
    Section({}, 'f').close()


@pytest.mark.parametrize('key', [0, False, None, 0.0])
def test_a_key_that_counts_as_nothing_is_named_as_well(key):
    with pytest.raises(ConfigError, match='^f: {}: unknown key$'.format(key)) as error:
        Section({key: 1}, 'f').close()
    assert error.value.key == str(key)


@pytest.mark.parametrize('text', [
    '', '[]', 'a', '3', 'a: [', '\t- a', 'a: b: c', '{a', '!!python/x y'])
def test_not_a_mapping_names_the_file(text):
    """On one line."""
    with pytest.raises(ConfigError, match='f.yaml: ') as error:
        parse_yaml(text, 'f.yaml')
    assert '\n' not in str(error.value)


@pytest.mark.parametrize('read', [
    lambda: parse_yaml('a: 2026-13-45', 'f'),
    lambda: Section({'key': 10 ** 400}, 'f').number('key', 0.0, 1.0),
    lambda: parse_yaml('[' * 5000, 'f'),
], ids=['impossible_date', 'huge_integer', 'deep_nesting'])
def test_every_error_is_a_config_error(read):
    """Whatever is in the file, one guard catches it."""
    with pytest.raises(ConfigError):
        read()


LAUGHS = 'a0: &a0 [x]\n' + ''.join('a{0}: &a{0} [{1}]\n'.format(
    level, ', '.join(['*a{}'.format(level - 1)] * 9)) for level in range(1, 12))
MERGES = 'a0: &a0 {x: 1}\n' + ''.join('a{0}: &a{0} {{<<: [{1}]}}\n'.format(
    level, ', '.join(['*a{}'.format(level - 1)] * 9)) for level in range(1, 12))
# Text, and what the error says of it.
HOSTILE = {
    'digits': ('name: ' + '7' * 5000, '5000 characters'),
    'hex_digits': ('name: 0x' + 'f' * 4300, '4302 characters'),
    'float_digits': ('name: 1' + '0' * 5000 + '.5', '5003 characters'),
    'bool_tag': ('name: !!bool maybe', "line 1: 'maybe'"),
    'int_tag': ('a: b\nname: !!int ""', "line 2: ''"),
    'float_tag': ('name: !!float ""', "''"),
    'float_words': ('name: !!float fast', "'fast'"),
    'timestamp_tag': ('name: !!timestamp foo', "'foo'"),
    'date': ('name: 2026-13-45', "'2026-13-45'"),
    'binary_tag': ('name: !!binary é', 'base64'),
    'python_tag': ('name: !!python/object/apply:os.system [ls]', 'could not determine'),
    'list_as_key': ('? [a]\n: b', 'unhashable'),
    'itself': ('name: &a [*a]', r'\*a stands inside itself'),
    'unknown_alias': ('name: *b', 'undefined alias'),
    'laughs': (LAUGHS, 'more than 10000 values'),
    'merges': (MERGES, 'more than 10000 values'),
    'long_list': ('name: [' + '1, ' * 80000 + '1]', 'more than 10000 values'),
    'huge_list': ('name: [' + '1, ' * 3500000 + '1]', 'larger than 250 kB'),
    'deep_flow': ('name: ' + '[' * 5000, 'more than 40 levels'),
    'deep_block': ('- ' * 5000 + 'a', 'more than 40 levels'),
    'many_words': ('name: ' + 'x ' * 120000, 'more than 50000 words'),
    'long_key': ('k' * 240000 + ': 1', 'mapping values are not allowed'),
    'long_tag': ('name: !' + 't' * 240000 + ' 1', 'could not determine'),
    'blank_lines': ('\n' * 240000, 'expected a mapping'),
    'escapes': ('name: "\\e[2J\\e]0;x\\a"\n"\\e[2J": 1', r'x1b\[2J'),
    'nul': ('name: \0', 'unacceptable character'),
    'directive': ('%YAML 1.' + '1' * 5000 + '\n--- a', 'not valid YAML'),
}


def section_of(text):
    """Read one key as a text, as every reader begins, and refuse the others."""
    section = parse_yaml(text, 'f.yaml')
    section.text('name')
    section.close()


@pytest.mark.parametrize('name', sorted(HOSTILE))
def test_hostile_text_is_a_short_error_soon(name):
    """About a second of work at most; one line of 300 characters that says where and why."""
    text, said = HOSTILE[name]
    begun = time.thread_time()
    with pytest.raises(ConfigError, match=said) as error:
        section_of(text)
    took_s = time.thread_time() - begun
    print('MEASURED {}: {:.2f} s'.format(name, took_s))
    # A second on the machine that it was made for; a busy one, or an older Python, takes longer.
    assert took_s < 3.0
    message = str(error.value)
    assert message.startswith('f.yaml: ') and message.count('f.yaml') == 1
    assert len(message) <= 300 and message.isprintable()


FILES = {
    'robot type': parse_robot_type, 'pad': parse_profile, 'pedal': parse_pedal_profile,
    'mux': lambda text, origin: parse_mux_config(text, origin, None),
    'voice': parse_language, 'discovery': parse_ignore_list}


@pytest.mark.parametrize('name', ['digits', 'hex_digits', 'bool_tag', 'laughs', 'huge_list'])
@pytest.mark.parametrize('file', sorted(FILES))
def test_every_kind_of_file_is_read_that_way(file, name):
    """With the same words."""
    text, said = HOSTILE[name]
    with pytest.raises(ConfigError, match=said):
        FILES[file](text, 'f.yaml')


@pytest.mark.parametrize('text', [
    'a: &x {b: 1}\nc: *x', 'a: &x {b: 1}\nc:\n  <<: *x\n  d: 2', 'a: 0x1F', 'a: 2026-11-22',
    '# ' + 'x' * 240000 + '\na: 1'],
    ids=['alias', 'merge', 'hex', 'date', 'comment'])
def test_ordinary_yaml_is_read_as_before(text):
    """Aliases, merges, dates and long comments are no offence."""
    section = parse_yaml(text, 'f')
    assert {key: section.take(key) for key in yaml.safe_load(text)} == yaml.safe_load(text)


@pytest.mark.parametrize('value', [
    10 ** 5000, 'x' * 100000, [[[[1] * 999] * 999] * 999], {'k' * 9999: {1: {2: {3: 4}}}},
    '\x1b[2J\n'],
    ids=['digits', 'text', 'list', 'mapping', 'escapes'])
@pytest.mark.parametrize('reader', sorted(set(READERS) - {'text'}))
def test_an_error_is_one_short_line_whatever_the_value(reader, value):
    """Parameters of the master come in as values, without a text that could be measured."""
    origin = '/' + 'deep/' * 100 + 'f.yaml'
    try:
        READERS[reader](Section({'key': value}, origin, 'top' * 100))
    except ConfigError as error:
        message = str(error)
        assert len(message) <= 300 and message.isprintable()
        assert 'f.yaml: ' in message and 'toptop' in message and 'expected' in message
    else:
        assert reader in ('texts', 'sections', 'named_sections', 'section', 'index')


def test_a_long_error_keeps_its_remedy():
    """It stands at the end."""
    error = ConfigError('f.yaml', 'key', 'is ' + 'long ' * 100 + '; remedy')
    assert str(error).startswith('f.yaml: key: is long') and len(str(error)) == 300
    assert str(error).endswith('; remedy')


NUMBERS = {'5e-02': 0.05, '5E3': 5000.0, '1.5e-1': 0.15, '.5': 0.5, '-3': -3, '+0.25': 0.25, '7': 7,
           '0': 0, '.inf': float('inf'), '-.inf': -float('inf'), '1.': 1.0, '5e300': 5e300}
TEXTS = ('010', '030000005e0400001907000000010000', '03000000100800000100000010010000', '1_5',
         '1:30', '1_000.5', '0b1', '1,5', '1.5 m', '5e', '--1', '1.2.3', 'e5', '.')


@pytest.mark.parametrize('text', NUMBERS)
def test_a_number_is_what_it_looks_like(text):
    value = yaml_value('[{}]'.format(text))[0]
    assert (value, type(value)) == (NUMBERS[text], type(NUMBERS[text]))


@pytest.mark.parametrize('text', TEXTS)
def test_what_does_not_look_like_a_number_is_a_text(text):
    assert yaml_value('"a": {}'.format(text))['a'] == text


@pytest.mark.parametrize('value', [
    *TEXTS[:7], *NUMBERS, *NUMBERS.values(), 1e-7, 1e22, 'on', '', 'null', 'a: b', 'two\nlines',
    ['1e5', 1e5], {'x': '5e-02', 'y': 5e-2}, None, True, 'ä' * 200])
def test_what_is_written_is_read_as_it_was(value):
    text = yaml_text(value)
    assert yaml_value(text) == value and '\n' not in text


@pytest.mark.parametrize('text', ['[', '{a', 'a: *b', '[' * 100, 'x' * (MAX_BYTES + 1)])
def test_what_is_no_yaml_is_a_value_error(text):
    with pytest.raises(ValueError):
        yaml_value(text)
