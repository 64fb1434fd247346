# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The count that ends a test run: nothing that failed, crashed or did not run is passed over."""
from pathlib import Path
import subprocess
import sys

import pytest

PROGRAM = Path(__file__).resolve().parents[2] / 'utils' / 'host' / 'count_results.py'

PASS = '<testcase classname="c" name="good"/>'
FAIL = '<testcase classname="c" name="bad"><failure message="the reason"/></testcase>'
ERROR = '<testcase classname="c" name="worse"><error message="the error"/></testcase>'
SKIP = '<testcase classname="c" name="left"><skipped message="why"/></testcase>'
# A test that failed and whose tear-down went wrong too is one test.
BOTH = '<testcase classname="c" name="b"><failure message="1"/><error message="2"/></testcase>'


def suite(*cases):
    return '<testsuites><testsuite tests="{}">{}</testsuite></testsuites>'.format(
        len(cases), ''.join(cases))


@pytest.mark.parametrize('files, not_run, counted, status', [
    ({}, [], (0, 0, 0), 1),
    ({'a.xml': suite(PASS, PASS)}, [], (2, 0, 0), 0),
    ({'a.xml': suite(PASS), 'b.xml': suite(PASS)}, [], (2, 0, 0), 0),
    ({'a.xml': suite(PASS, FAIL)}, [], (1, 1, 0), 1),
    ({'a.xml': suite(PASS, ERROR)}, [], (1, 1, 0), 1),
    ({'a.xml': suite(PASS, BOTH)}, [], (1, 1, 0), 1),
    ({'a.xml': suite(PASS, SKIP)}, [], (1, 0, 1), 0),
    ({'a.xml': suite(SKIP)}, [], (0, 0, 1), 1),
    ({'a.xml': suite()}, [], (0, 1, 0), 1),
    ({'a.xml': ''}, [], (0, 1, 0), 1),
    ({'a.xml': suite(PASS)[:-20]}, [], (0, 1, 0), 1),
    ({'MISSING-a.xml': suite(FAIL)}, [], (0, 1, 0), 1),
    ({'a.xml': suite(PASS)}, ['gui'], (1, 1, 0), 1),
    # rostest's own file repeats as a pass what the test nodes' files say in full.
    ({'rostest-x.xml': suite(PASS), 'rosunit-x.xml': suite(PASS, PASS)}, [],
     (2, 0, 0), 0),
    ({'rostest-x.xml': suite(PASS), 'rosunit-x.xml': suite(PASS, FAIL)}, [],
     (1, 1, 0), 1),
    ({'rostest-x.xml': suite(FAIL)}, [], (0, 1, 0), 1),
    ({'rostest-x.xml': suite()}, [], (0, 1, 0), 1),
])
def test_count(tmp_path, files, not_run, counted, status):
    for name, text in files.items():
        (tmp_path / name).write_text(text)
    done = subprocess.run([sys.executable, str(PROGRAM), str(tmp_path)] + not_run,
                          stdout=subprocess.PIPE, universal_newlines=True)
    last = '{} passed, {} failed'.format(*counted)
    last += ', {} skipped'.format(counted[2]) if counted[2] else ''
    assert (done.stdout.splitlines()[-1], done.returncode) == (last, status)


def test_failures_are_named(tmp_path):
    (tmp_path / 'a.xml').write_text(suite(PASS, FAIL, ERROR))
    done = subprocess.run([sys.executable, str(PROGRAM), str(tmp_path), 'gui'],
                          stdout=subprocess.PIPE, universal_newlines=True)
    assert done.stdout.splitlines()[:3] == [
        'FAILED gui: did not finish',
        'FAILED a.xml: c.bad: the reason',
        'FAILED a.xml: c.worse: the error']


BAD = suite(PASS, FAIL)


@pytest.mark.parametrize('names, targets', [
    ([], ''),
    (['pytest-gui_calm-test_a'], 'gui_calm_test_a'),
    (['MISSING-pytest-gui_calm-test_a'], 'gui_calm_test_a'),
    (['pytest-scripts_calm-test_a', 'pytest-faults_timed-test_b'],
     'faults_timed_test_b scripts_calm_test_a'),
    (['rosunit-x', 'rostest-test_rostest_x'], 'rostest_test_rostest_x.test'),
    (['pytest-bench-test_benchmarks'], 'bench_test_benchmarks'),
    (['pytest-unit-ros', 'pytest-oldest-widgets'], 'oldest_widgets unit_ros'),
    # What does not depend on the computer is not asked twice.
    (['pytest-unit-unit', 'pytest-gui_calm-test_a'], ''),
    (['pytest-lint-test_lint'], ''),
    (['pytest-oldest-unit', 'pytest-unit-ros'], ''),
    # So many failures are no accident.
    (['pytest-gui_calm-test_{}'.format(number) for number in range(5)], '')])
def test_set_aside(tmp_path, names, targets):
    results = tmp_path / 'results'
    results.mkdir()
    (results / 'pytest-gui_calm-test_good.xml').write_text(suite(PASS))
    for name in names:
        (results / (name + '.xml')).write_text(BAD)
    done = subprocess.run([sys.executable, str(PROGRAM), '--set-aside', str(results)],
                          stdout=subprocess.PIPE, universal_newlines=True)
    assert done.stdout.split() == targets.split() and done.returncode == 0
    left = {path.stem for path in results.iterdir()} - {'pytest-gui_calm-test_good'}
    assert left == (set() if targets else set(names))
    counted = subprocess.run([sys.executable, str(PROGRAM), str(results)],
                             stdout=subprocess.PIPE, universal_newlines=True).stdout
    assert counted.count('FAILED') == len(names)
    assert ('failed at first' in counted) == bool(targets)
