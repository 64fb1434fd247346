# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Texts of others: short, printable, and quick to deal with whatever they are."""
import pytest

from mhri.base.text import listed, MAX_CHARACTERS, MAX_NAMES, tidy_names, tidy_text


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
