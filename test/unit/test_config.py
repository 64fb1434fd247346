# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Configuration text: every kind of value, every kind of slip."""
import pytest

from mhri.core.config import ConfigError, parse_yaml, Section

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
