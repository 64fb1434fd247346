# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""run.py over small tests that fail in every way: each of them counts."""
import os
import re
import shutil
import signal
import subprocess
import sys
from xml.etree import ElementTree

import pytest

from support.checkout import children_with, REPO
from support.ros_system import wait_for

PASSES, FAILS = 'def test_a():\n    pass\n', 'def test_b():\n    assert 1 == 2\n'
# Fails at these of its tries, which it counts in a file.
UNSOUND = """import pathlib


def test_unsound():
    came = pathlib.Path(__file__).with_suffix('.came')
    tries = int(came.read_text()) + 1 if came.exists() else 1
    came.write_text(str(tries))
    assert tries not in {}, 'try {{}}'.format(tries)
"""
ROSTEST = '<launch><test test-name="{0}" pkg="mhri" type="node.py" args="{1}"/></launch>'
NODE = """#!/usr/bin/env python3
import os
import sys
import unittest
import rosunit

sys.path.insert(0, os.path.join(os.path.dirname(os.path.realpath(__file__)), '..', '..'))
import support
""" + UNSOUND.format({1}) + """

class Case(unittest.TestCase):
    def test_one(self):
        exec(sys.argv[1])

    def test_two(self):
        from support.ros_system import say_insisted
        say_insisted(3, 'a node')


rosunit.unitrun('mhri', 'node', Case)
"""
# Each of four waits for the other three.
MEETS = """import pathlib
import time


def test_meeting():
    here = pathlib.Path(__file__)
    (here.parents[2] / (here.stem + '.came')).touch()
    while len(list(here.parents[2].glob('*.came'))) < 4:
        time.sleep(0.02)
"""
SLEEPS = 'import time\n\n\ndef test_a():\n    time.sleep(600)\n'
TIMED = PASSES + '\n\n' + '''import pytest
from support.node_tools import measured


@pytest.mark.parametrize('what', ['one thing'])
def test_timed(what):
    measured(what, {}, 0.05)
'''
SKIPS = 'import pytest\n\n\n@pytest.mark.skip(reason="{}")\n'
# What each ends with: passed, failed, skipped.
ENDS = {
    'unit/map/test_a.py': (PASSES + '\n\n' + FAILS, 1, 1),
    'unit/map/test_b.py': ('import rospy\n', 0, 1),
    'ros/map/test_pass.py': ('import rospy\n\n\n' + PASSES, 1, 0),
    'ros/map/test_import.py': ('import no_such_module\n', 0, 1),
    'ros/map/test_empty.py': ('', 0, 1),
    'ros/map/test_crash.py': ('import os\n\n\ndef test_a():\n    os.abort()\n', 0, 1),
    'ros/map/test_stop.py': ('import os\n\n\ndef test_a():\n    os._exit(0)\n', 0, 1),
    'ros/map/test_starts.py': ('import subprocess\n\n\ndef test_a():\n'
                               '    subprocess.check_call(["true"])\n', 0, 1),
    'e2e/map/test_leak.py': ('import subprocess\n\n\ndef test_a():\n    subprocess.Popen('
                             '["sleep", "600"], start_new_session=True)\n', 1, 1),
    'ros/map/test_skip.py': (SKIPS.format('I like') + FAILS + '\n\n' + PASSES, 1, 1, 1),
    'ros/map/test_mark.py': ('import pytest\npytestmark = pytest.mark.tiemd\n' + PASSES, 0, 1),
    'ros/map/test_hang.py': ('import pytest\nimport time\n\n\n@pytest.mark.timeout(1)\n'
                             'def test_a():\n    time.sleep(600)\n', 0, 1),
    'e2e/map/test_shows.py': (
        'import os\nimport subprocess\n\n\ndef test_a():\n'
        '    assert os.environ["ROS_MASTER_URI"].endswith(":9")\n'
        '    subprocess.check_call(["xdpyinfo"], stdout=subprocess.DEVNULL)\n', 1, 0),
    'e2e/map/pass.test': (ROSTEST.format('pass_node', 'pass'), 2, 0),
    'e2e/map/fail.test': (ROSTEST.format('fail_node', 'self.fail()'), 1, 1),
    'e2e/map/exit.test': (ROSTEST.format('exit_node', 'os._exit(3)'), 0, 1),
}
AGAIN = re.compile(r'AGAIN (\S+): .*: passed (\d) of 3')


class Package:
    """The runner with tests of its own beside it."""

    def __init__(self, folder):
        self.root, self.results = folder / 'mhri', folder / 'results' / 'mhri'
        shutil.copytree(str(REPO / 'test' / 'support'), str(self.root / 'test' / 'support'))
        for name in ('test/conftest.py', 'test/skips.txt', 'test/flaky.yaml', 'setup.cfg',
                     'package.xml'):
            shutil.copy(str(REPO / name), str(self.root / name))
        shutil.copy(str(REPO / 'test' / 'run.py'), str(self.root / 'test'))
        # These tests themselves keep the machine from its rest.
        self.change(', 60.0\n', ', 0.0\n')
        self.env = dict(os.environ, ROS_PACKAGE_PATH='{}:{}'.format(
            self.root, os.environ['ROS_PACKAGE_PATH']), MARK=str(folder))

    def change(self, old, new):
        runner = self.root / 'test' / 'run.py'
        text = runner.read_text()
        assert text.count(old) == 1
        runner.write_text(text.replace(old, new))
        return self

    def write(self, tests):
        for name, text in tests.items():
            path = self.root / 'test' / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text)
            path.chmod(0o755)
        return self

    def start(self, *arguments, **env):
        return subprocess.Popen(
            [sys.executable, str(self.root / 'test' / 'run.py'), '--results',
             str(self.results.parent), *arguments], stdout=subprocess.PIPE, encoding='utf-8',
            stderr=subprocess.STDOUT, env=dict(self.env, **env))

    def run(self, *arguments, **env):
        """Return (exit status, lines)."""
        process = self.start(*arguments, **env)
        output = process.communicate(timeout=300)[0]
        print(output)
        return process.returncode, output.splitlines()

    def run_named(self):
        """Return (exit status, lines) where files are named: what fails does not run again."""
        return self.run(str(self.root / 'test'))

    def failures(self, path, kept=''):
        """Return how many a file of results has; what it said at first is kept in it."""
        root = ElementTree.parse(str(self.results / path)).getroot()
        assert kept in ElementTree.tostring(root, 'unicode')
        return sum(int(suite.get(kind, '0')) for suite in root.iter('testsuite')
                   for kind in ('failures', 'errors'))


@pytest.fixture
def package(tmp_path):
    return Package(tmp_path)


def test_each_way_to_end_counts(package):
    status, lines = package.write(dict({name: text for name, (text, *_) in ENDS.items()},
                                       **{'e2e/map/node.py': NODE})).run_named()
    counts = {name.replace('/', '-').rpartition('.')[0]: counts
              for name, (_, *counts) in ENDS.items()}
    counts.update({'unit-{}'.format(half): counts.pop('unit-map-test_' + name)
                   for half, name in ((1, 'a'), (2, 'b'))})
    said = dict(re.match(r'(?:FAIL|  ok) +[0-9.]+ s  (\S+): (.*)', line).groups()
                for line in lines if re.match('FAIL |  ok ', line))
    counts = {name: (*count, 0)[:3] for name, count in counts.items()}
    assert said == {name: '{} passed, {} failed, {} skipped'.format(*count)
                    for name, count in counts.items()}
    assert children_with('MARK=' + package.env['MARK']) == []
    # So does what had to be done more than once.
    assert sorted(line for line in lines if line.startswith('INSISTED ')) == [
        'INSISTED e2e-map-{}: 3 times: a node'.format(name) for name in ('fail', 'pass')]
    passes, failures, skips = map(sum, zip(*counts.values()))
    assert (lines[-1], status) == ('{} passed, {} failed, {} skipped'.format(
        passes, failures, skips), 1)
    assert len([line for line in lines if line.startswith('FAILED ')]) == failures
    # catkin_test_results finds the same.
    assert sum(package.failures(path) for path in package.results.rglob('*.xml')) == failures


@pytest.mark.parametrize('tests, said, status', [
    ({}, '0 passed, 0 failed, 0 skipped', 1),
    ({'ros/map/test_a.py': SKIPS.format('needs root') + PASSES},
     '0 passed, 0 failed, 1 skipped', 1),
    ({'unit/map/test_a.py': PASSES, 'long/map/test_a.py': FAILS},
     '1 passed, 0 failed, 0 skipped', 0)])
def test_only_what_ran_and_passed_is_success(package, tests, said, status):
    done, lines = package.write(tests).run()
    assert (lines[-1], done) == (said, status)


def test_what_failed_passes_three_times_of_three_alone_or_is_a_failure(package):
    """The others of its file do not run again; a failure elsewhere changes nothing."""
    status, lines = package.write({
        'e2e/map/test_once.py': UNSOUND.format({1}) + '\n\n' + PASSES,
        'e2e/map/test_twice.py': UNSOUND.format({1, 4}),
        'e2e/map/once.test': ROSTEST.format('once_node', 'test_unsound()'),
        'e2e/map/node.py': NODE,
        'unit/map/test_a.py': UNSOUND.format({1}), 'lint/test_lint.py': FAILS}).run()
    assert (lines[-1], status) == ('4 passed, 3 failed, 0 skipped', 1)
    assert dict(AGAIN.match(line).groups() for line in lines if line.startswith('AGAIN ')) == {
        'e2e-map-test_once': '3', 'e2e-map-test_twice': '2', 'e2e-map-once': '3'}
    assert [package.failures(path, 'try 1') for path in (
        'e2e-map-test_once/pytest.xml', 'e2e-map-once/mhri/rosunit-once_node.xml',
        'e2e-map-test_twice/pytest.xml')] == [0, 0, 1]


@pytest.mark.parametrize('tests, count', [
    ({'e2e/map/test_a.py': '\n\n'.join('def test_{}():\n    assert False\n'.format(number)
                                       for number in range(4))}, 4),
    ({'unit/map/test_a.py': FAILS, 'ros/map/test_b.py': FAILS,
      'e2e/map/test_c.py': 'import no_such_module\n'}, 3)])
def test_what_is_pure_or_did_not_begin_or_fails_often_does_not_run_again(package, tests, count):
    status, lines = package.write(tests).run()
    assert (lines[-1], status) == ('0 passed, {} failed, 0 skipped'.format(count), 1)
    assert not [line for line in lines if line.startswith('AGAIN ')]


def test_two_files_run_at_a_time_and_what_is_pure_beside_them(package):
    package.write({name: MEETS for name in (
        'e2e/map/test_a.py', 'e2e/map/test_b.py', 'ros/map/test_c.py', 'unit/map/test_d.py')})
    assert package.run()[1][-1] == '4 passed, 0 failed, 0 skipped'


def test_the_gate_ends_when_its_time_is_up(package):
    status, lines = package.change('900.0', '4.0').write(
        {'e2e/map/test_{}.py'.format(number): SLEEPS for number in range(3)}).run()
    assert (lines[-1], status) == ('0 passed, 3 failed, 0 skipped', 1)
    assert children_with('MARK=' + package.env['MARK']) == []


def test_everything_is_the_gate_and_the_rest_and_promises_of_time_as_they_stand(package):
    status, lines = package.write({
        'e2e/map/test_a.py': TIMED.format(0.04), 'long/map/test_b.py': TIMED.format(0.2),
        'long/map/test_c.py': PASSES, 'long/map/test_d.py': FAILS,
        'flaky.yaml': '[{test: "test/long/map/test_d.py::test_b", mechanism: seen}]'}).run('--all')
    assert (lines[-1], status) == ('6 passed, 1 failed, 1 skipped', 1)
    assert [line.split(':')[0] for line in lines if line.startswith('FAILED ')] == [
        'FAILED exact/long-map-test_b']


def test_an_interrupted_run_leaves_nothing(package):
    package.write({'ros/map/test_{}.py'.format(number): SLEEPS for number in range(3)})
    process = package.start()
    log = package.results / 'ros-map-test_0' / 'log'
    wait_for(lambda: log.exists() and 'test_0.py::' in log.read_text())
    process.send_signal(signal.SIGINT)
    process.communicate(timeout=60)
    assert process.returncode and children_with('MARK=' + package.env['MARK']) == []


@pytest.mark.parametrize('arguments, named', [
    (['--frobnicate'], '--frobnicate'), (['/etc'], '/etc')])
def test_wrong_arguments_are_refused_before_anything_is_installed(checkout, arguments, named):
    shutil.copytree(str(REPO / 'test'), str(checkout.root / 'test'))
    status, output = checkout.run(*arguments, script=checkout.script.with_name('mhri_test.sh'))
    assert status == 2 and named in output and checkout.calls == []


def test_fast_tests_need_neither_a_build_nor_ros_nor_a_screen(checkout):
    small = Package(checkout.root.parent).write({
        'lint/test_lint.py': 'def test_flake8():\n    pass\n\n\n' + FAILS.replace('_b', '_mypy'),
        'unit/map/test_a.py': PASSES, 'unit/map/test_b.py': PASSES, 'ros/map/test_c.py': FAILS})
    shutil.copytree(str(small.root / 'test'), str(checkout.root / 'test'))
    (checkout.root / 'build' / '.ws').mkdir(parents=True)
    (checkout.root / 'build' / '.ws' / 'tools').symlink_to(REPO / 'build' / '.ws' / 'tools')
    status, output = checkout.run('--only', 'fast',
                                  script=checkout.script.with_name('mhri_test.sh'))
    assert (status, output.splitlines()[-1]) == (0, '3 passed, 0 failed, 0 skipped')
    assert checkout.calls == []


def test_path_with_a_space_is_refused(checkout):
    shutil.copytree(str(REPO / 'test'), str(checkout.root / 'test'))
    status, output = checkout.run(script=checkout.script.with_name('mhri_test.sh'))
    assert status == 1 and str(checkout.root) in output
    assert checkout.calls == []
