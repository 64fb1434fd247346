# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Texts of others: short, printable, and quick to deal with whatever they are."""
import pytest

from mhri.base.text import (
    listed, MAX_CHARACTERS, MAX_NAMES, shown_number, tidy_names, tidy_text, typed_number)


@pytest.mark.parametrize('text, tidy', [
    ('', ''), ('robot forward', 'robot forward'), ('Zürich – 東京', 'Zürich – 東京'),
    ('two\nlines\tand\x00more\x1b[31m', 'two lines and more [31m'),
    ('left\u202eright', 'left right'), ('a\ud800b', 'a b'), ('<b>x</b>', '<b>x</b>'),
    ('x' * MAX_CHARACTERS, 'x' * MAX_CHARACTERS),
    ('x' * (MAX_CHARACTERS + 1), 'x' * (MAX_CHARACTERS - 3) + '...')])
def test_texts(text, tidy):
    assert tidy_text(text) == tidy


@pytest.mark.parametrize('text', ['a' * 1_000_000, 'e' + '\u0301' * 300_000, '\n' * 1_000_000])
def test_a_long_text_is_short_afterwards(text):
    assert len(tidy_text(text)) == MAX_CHARACTERS


def test_names():
    assert tidy_names(['bot1', 'x' * 1000]) == ('bot1', 'x' * (MAX_CHARACTERS - 3) + '...')
    assert len(tidy_names('bot{}'.format(number) for number in range(20_000))) == MAX_NAMES


def test_listed():
    assert listed([]) == '' and listed('abc') == 'a, b, c' and len(listed('abcdef')) < 30
    assert 'e' not in listed('abcdef').split(', ')


@pytest.mark.parametrize('typed, value', [
    ('1.5', 1.5), ('1,5', 1.5), ('-2.25', -2.25), ('-2,25', -2.25), (' 0,5 ', 0.5), ('+3', 3.0),
    ('\u22121,5', -1.5), (',5', 0.5), ('.5', 0.5), ('7,', 7.0), ('1.500', 1.5), ('0010', 10.0)])
def test_point_and_comma_are_the_decimal_sign(typed, value):
    assert typed_number(typed) == value
    assert typed_number(shown_number(value)) == value


@pytest.mark.parametrize('typed', [
    '1.500,0', '1,500.0', '1.000.000', '1 500', '1\u202f500', '1\u00a0500', "1'500", '1\u2019500',
    '1_500', '1,5,0', '', '.', '-', 'x', '1e3', '1:30', '0x1F', 'nan', 'inf', '\u0661', '1.5 m',
    '--1', '1-', '1.5.', '\u00bd', '1' * 400 + 'x'])
def test_what_is_no_number_is_refused_and_quoted(typed):
    with pytest.raises(ValueError) as refused:
        typed_number(typed)
    assert tidy_text(typed)[:30] in str(refused.value) and len(str(refused.value)) < 200


@pytest.mark.parametrize('typed', ['0,019', '2.01', '-1', '9' * 400])
def test_a_number_out_of_bounds_is_refused_with_the_bounds(typed):
    with pytest.raises(ValueError, match='from 0.02 to 2') as refused:
        typed_number(typed, 0.02, 2.0)
    assert len(str(refused.value)) < 200


@pytest.mark.parametrize('value, decimals, text', [
    (0.2, 2, '0.20'), (120.0, 0, '120'), (1.2345, 2, '1.2345'), (-0.5, 0, '-0.5'),
    (1e6, 0, '1000000'), (1.0 / 3.0, 2, '0.333333')])
def test_shown_number(value, decimals, text):
    assert shown_number(value, decimals) == text
