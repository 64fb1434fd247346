# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""How the links and viewers of the page read on the operator's screen."""
from datetime import datetime

import pytest

from mhri.web.view import CHOICES, clock_text, LinkView, ViewerView

NOON = datetime(2026, 3, 4, 12, 0).timestamp()


@pytest.mark.parametrize('at_s, text', [
    (NOON, '12:00'), (NOON + 3600.0, '13:00'), (NOON - 12 * 3600.0, '00:00'),
    (NOON + 12 * 3600.0, '2026-03-05 00:00'), (NOON - 86400.0, '2026-03-03 12:00')])
def test_a_time_of_another_day_has_its_date(at_s, text):
    assert clock_text(at_s, NOON) == text


@pytest.mark.parametrize('choice', CHOICES)
@pytest.mark.parametrize('head', [False, True])
def test_a_link_says_what_it_allows(choice, head):
    words, role, may_stop = CHOICES[choice]
    said = LinkView('1', 'Maria', role, may_stop, head, NOON).words(NOON)
    assert said.startswith(words + ', ') and said.endswith('12:00') and ('camera' in said) == head


@pytest.mark.parametrize('holds', [False, True])
@pytest.mark.parametrize('thinned', [False, True])
def test_a_viewer_says_what_is_special(holds, thinned):
    plain = ViewerView('1', 'Maria', '10.0.0.7', NOON, False, False).words(NOON)
    said = ViewerView('1', 'Maria', '10.0.0.7', NOON, holds, thinned).words(NOON)
    assert said.startswith(plain) and (said == plain) == (not holds and not thinned)
    assert ('DRIVES' in said) == holds
