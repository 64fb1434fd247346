# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What the screen says of a drill, and when it says nothing."""
from dataclasses import replace

import pytest

from mhri.drill.view import (
    drill_changes, drill_texts, DrillView, ENDED, RUNNING, SILENT_S, STAYS_S, WAITING)
from mhri.events.events import KINDS

AT = 1000.0
BEGINS = DrillView(AT, 'Search', 'Find the cans.', WAITING, 0.0, 480.0, (), ('red', 'blue'))
RUNS = replace(BEGINS, phase=RUNNING, elapsed_s=158.6, found=('red',), left=('blue',))
ENDS = replace(RUNS, phase=ENDED, found=('red', 'blue'), left=(), elapsed_s=104.2,
               ended='all found', page='/here/drill.html')


@pytest.mark.parametrize('drill, age_s, first, last', (
    (BEGINS, 0.0, 'Drill Search: Find the cans. The clock starts when you drive.',
     'Drill Search: drive to start'),
    (RUNS, 0.5, 'Drill Search: 1 of 2 found, 5:21 left', '1 of 2 found, 5:21 left'),
    (replace(RUNS, in_order=True), 0.5, 'Drill Search: 1 of 2 found, 5:21 left, next: blue',
     '1 of 2 found, 5:21 left'),
    (RUNS, SILENT_S + 1.0, 'Drill Search: its referee has stopped', 'Drill Search: stopped'),
    (ENDS, SILENT_S + 1.0,
     'Drill Search: all 2 found after 1:44; page: /here/drill.html',
     'Drill Search: all 2 found after 1:44'),
    (replace(RUNS, phase=ENDED, ended='time is up', elapsed_s=480.1), 0.0,
     'Drill Search: time is up after 8:00, 1 of 2 found',
     'Drill Search: time is up after 8:00, 1 of 2 found'),
    (RUNS, STAYS_S, '', ''), (ENDS, STAYS_S, '', ''),
    # A replay has jumped to before it.
    (RUNS, -5.0, '', '')))
def test_the_line(drill, age_s, first, last):
    texts = drill_texts(drill, AT + age_s) or ('',)
    assert (texts[0], texts[-1]) == (first, last)


@pytest.mark.parametrize('old, new, kinds', (
    (None, BEGINS, ['drill.waits']), (None, RUNS, []), (None, ENDS, []),
    (BEGINS, BEGINS, []),
    (BEGINS, RUNS, ['drill.begun', 'drill.found']),
    (RUNS, RUNS, []),
    (RUNS, ENDS, ['drill.found', 'drill.ended']),
    (ENDS, ENDS, []),
    # The next run, of the same drill or of another.
    (ENDS, BEGINS, ['drill.waits']), (RUNS, BEGINS, ['drill.waits']),
    (BEGINS, replace(RUNS, title='Maze'), [])))
def test_the_events(old, new, kinds):
    told = drill_changes(old, new)
    assert [kind for kind, _ in told] == kinds
    assert set(kinds) <= set(KINDS)
    assert all(text.startswith('drill Search: ') for _, text in told)
