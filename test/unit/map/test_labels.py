# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The words of flags lie over no others, the newest first."""
import pytest

from mhri.map.labels import place_labels


@pytest.mark.parametrize('flags, words', [
    ([(50, 50, '1 ab')], [(70, '1 ab')]),
    # 10 px a character; at the right edge they are left of it.
    ([(180, 50, '1 ab')], [(pytest.approx(180 - 40 - 20 / 3), '1 ab')]),
    # The newer one is right of its flag, the older one left of its own.
    ([(90, 50, '1 ab'), (95, 50, '2 cd')],
     [(pytest.approx(90 - 40 - 20 / 3), '1 ab'), (115, '2 cd')]),
    # Beneath each other both have room.
    ([(50, 50, '1 ab'), (50, 70, '2 cd')], [(70, '1 ab'), (70, '2 cd')]),
    # Without room for words there is the number, else nothing.
    ([(30, 50, '1 ab'), (30, 50, '2 cd')], [(pytest.approx(30 - 10 - 20 / 3), '1'), (50, '2 cd')]),
    ([(0, 50, '1 ab'), (0, 50, '2 cd')], [(0, ''), (20, '2 cd')]),
    ([], [])])
def test_where_words_go(flags, words):
    assert place_labels(flags, lambda text: 10.0 * len(text), 18.0, 20.0, 200.0) == words
