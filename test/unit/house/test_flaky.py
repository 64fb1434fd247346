# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The list of tests that may fail stays short, young, and far from robots that move."""
import datetime
import os
import warnings

import pytest
import yaml

from support.paths import REPO

MOST, OLDEST_DAYS = 10, 14
ROWS = yaml.safe_load((REPO / 'test' / 'flaky.yaml').read_text(encoding='utf-8'))


def faults(rows, today):
    """Return what is wrong with such a list, and which of its rows are too old."""
    wrong = ['more than {}'.format(MOST)] if len(rows) > MOST else []
    old = []
    for row in rows:
        if set(row) != {'test', 'first_seen', 'mechanism'} or not row['mechanism']:
            wrong.append('not whole: {}'.format(row))
            continue
        path, *names = row['test'].split('::')
        if not path.startswith('test/long/') or 'driving' in path or 'guard' in row['test']:
            wrong.append('may not fail: ' + row['test'])
        elif not (REPO / path).exists() or names[-1].partition('[')[0] not in (
                REPO / path).read_text(encoding='utf-8'):
            wrong.append('is not there: ' + row['test'])
        if (today - row['first_seen']).days > OLDEST_DAYS:
            old.append(row['test'])
    return wrong, old


def test_the_list_is_short_young_and_far_from_robots_that_move():
    wrong, old = faults(ROWS, datetime.date.today())
    assert wrong == []
    assert not old or not os.environ.get('MHRI_ALL'), old
    for test in old:
        warnings.warn('on the list for more than two weeks: ' + test)


@pytest.mark.parametrize('change, said', [
    ({}, ''), ({'mechanism': ''}, 'not whole'),
    ({'test': 'test/long/driving/test_control.py::test_x'}, 'may not fail'),
    ({'test': 'test/e2e/web/test_web.py::test_x'}, 'may not fail'),
    ({'test': 'test/long/house/test_run.py::test_no_more'}, 'is not there'),
])
def test_a_row_is_looked_at(change, said):
    row = dict({'test': 'test/long/house/test_run.py::test_each_way_to_end_counts',
                'first_seen': datetime.date(2026, 11, 1), 'mechanism': 'seen'}, **change)
    wrong, old = faults([row], datetime.date(2026, 11, 15))
    assert old == [] and bool(wrong) == bool(said) and said in ''.join(wrong)
    assert faults([row] * (MOST + 1), datetime.date(2026, 11, 16))[0]
    assert faults([row], datetime.date(2026, 11, 16))[1] or said == 'not whole'
