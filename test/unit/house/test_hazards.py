# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Hazards, promises and mutants name code and tests that exist; the pages are up to date."""
import ast
import re
import sys

import pytest

from support.paths import REPO

sys.path.insert(0, str(REPO / 'test'))
import hazards  # noqa: E402
import mutants  # noqa: E402

LOG = hazards.load()
ACTIONS = LOG['actions']
_SKIPPED = re.compile(r'\b(skip|skipif|xfail)\b')
_KEYS = {'id', 'action', 'hazards', 'constraint', 'held_in', 'tests', 'mutation', 'residual',
         'refuted_by'}


def function_of(path, names):
    """Return the node of a test in a file, None if it is not there."""
    body = ast.parse(path.read_text(encoding='utf-8')).body
    for name in names:
        found = [node for node in body if getattr(node, 'name', None) == name]
        if not found:
            return None
        body = getattr(found[0], 'body', [])
    return found[0]


def test_every_action_of_the_analysis_is_there_once():
    assert [row['id'] for row in ACTIONS] == list(range(1, len(ACTIONS) + 1))
    assert len(ACTIONS) >= 38


@pytest.mark.parametrize('row', ACTIONS, ids=lambda row: str(row['id']))
def test_a_row_is_whole(row):
    assert set(row) == _KEYS
    assert set(row['hazards']) <= set(LOG['hazards'])
    for path in row['held_in']:
        assert (REPO / path).exists(), path
    assert row['tests']
    for test in row['tests'] + row['mutation'].get('tests', []):
        path, *names = test.split('::')
        node = function_of(REPO / path, names)
        assert node is not None, test
        marks = [ast.dump(mark) for mark in getattr(node, 'decorator_list', [])]
        assert not any(map(_SKIPPED.search, marks)), test


def test_each_promise_from_outside_has_files_and_each_file_a_promise():
    text = (REPO / 'doc' / 'developing.md').read_text(encoding='utf-8')
    head = '| promise | files |'
    rows = text[text.index(head):].partition('\n\n')[0].splitlines()[2:]
    named = [re.findall(r'`(test/e2e/[^`]+)`', row) for row in rows]
    assert all(named), rows
    assert sorted(sum(named, [])) == sorted(
        path.relative_to(REPO).as_posix() for kind in ('test_*.py', '*.test')
        for path in (REPO / 'test/e2e').rglob(kind))


@pytest.mark.parametrize('group', hazards.promises())
def test_each_promise_names_tests_that_are_there(group):
    rows = hazards.promises()[group]
    missing = [test for tests in rows.values() for test in tests or ['none'] if not re.search(
        r'^ *def {}\('.format(test.partition('::')[2]),
        (REPO / test.partition('::')[0]).read_text(encoding='utf-8'), re.M)]
    assert missing == []
    _, page, head = hazards.GROUPS[group]
    assert not page or hazards.first_cells(page, head) == set(rows)


@pytest.mark.parametrize('row', ACTIONS, ids=lambda row: str(row['id']))
def test_its_mutation_fits_the_code(row):
    mutation = row['mutation']
    text = (REPO / mutation['file']).read_text(encoding='utf-8')
    assert text.count(mutation['from']) == 1 and mutation['from'] != mutation['to']


@pytest.mark.parametrize('path', hazards.pages(), ids=lambda path: path.name)
def test_pages_are_of_today(path):
    assert path.read_text(encoding='utf-8') == hazards.pages()[path], \
        'run test/hazards.py --write'


def test_mutants_are_of_files_and_tests_that_exist():
    files = {mutants.path_of(name) for name in mutants.TESTS}
    tests = {test for name in mutants.TESTS for test in mutants.tests_of(name)}
    assert {path for path in files | tests if not (REPO / path).is_file()} == set()
    rules = {str(path.relative_to(REPO)) for path in (REPO / 'src/mhri/driving').glob('[!_]*.py')}
    assert rules - files == {'src/mhri/driving/journal.py'}, 'it decides nothing'


@pytest.mark.parametrize('name', mutants.kept())
def test_a_kept_fault_fits_the_code_and_names_who_sees_it(name):
    what, tests = mutants.kept()[name]
    mutants.patch(name, REPO, '--check')
    assert what.endswith('.') and tests
    assert all((REPO / test).is_file() for test in tests), tests


def test_what_is_called_equivalent_is_a_mutant():
    found = {(mutant[0], *code) for name in mutants.TESTS for mutant in mutants.Finder(name).found
             for code in (mutants.told(mutant)[1:], mutants.told(mutant)[2:])}
    assert set(mutants.EQUIVALENT) - found == set()
