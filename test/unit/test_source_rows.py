# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The parameter with the mux's sources, of the right and of any wrong shape."""
import pytest

from mhri.core.screen.source_rows import MOST_SOURCES, source_rows

JOY = {'name': 'joy', 'label': 'Virtual joystick', 'topic': '/mux_in/joy'}


@pytest.mark.parametrize('parameter, pairs', [
    ([JOY], (('joy', 'Virtual joystick'),)), ([], ()), (None, ()), (5, ()), ('joy', ()),
    ({'name': 'joy', 'label': 'x'}, ()), ([JOY, 5, 'x', None, []], (('joy', 'Virtual joystick'),)),
    ([{'name': 'joy'}, {'label': 'x'}, {'name': 5, 'label': 'x'}, {'name': 'a', 'label': [1]},
      {'name': '', 'label': 'x'}, JOY], (('joy', 'Virtual joystick'),)),
    ([{'name': 'a', 'label': 'two\nlines'}], (('a', 'two lines'),))])
def test_rows(parameter, pairs):
    assert source_rows(parameter) == pairs


def test_bounds():
    found = source_rows([{'name': 'a' * 1000, 'label': 'b' * 1_000_000}] * 1000)
    assert len(found) == MOST_SOURCES and all(len(text) == 200 for text in found[0])
