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

# What it looks at again waits for a machine at rest.
pytestmark = pytest.mark.timed

PASSES, FAILS = 'def test_a():\n    pass\n', 'def test_b():\n    assert 1 == 2\n'
CRASHES, STOPS = ('import os\n\n\ndef test_a():\n    os.{}\n'.format(how)
                  for how in ('abort()', '_exit(0)'))
ROSTEST = """<!-- mark: {} -->
<launch>
  <test test-name="{}" pkg="mhri" type="node.py" args="{}"/>
</launch>
"""
NODE = """#!/usr/bin/env python3
import os
import sys
import unittest
import rosunit

sys.path.insert(0, os.path.join(os.path.dirname(os.path.realpath(__file__)), '..', '..'))
import support


class Case(unittest.TestCase):
    def test_one(self):
        exec(sys.argv[1])

    def test_two(self):
        from support.ros_system import say_insisted
        say_insisted(3, 'a node')


rosunit.unitrun('mhri', 'node', Case)
"""
LEAKS = ('import subprocess\n\n\ndef test_leak():\n'
         '    subprocess.Popen(["sleep", "600"], start_new_session=True)\n')
SHOWS = ('import os\nimport subprocess\n\n\ndef test_a():\n    assert os.environ["ROS_MASTER_URI"]'
         '.endswith(":9")\n    subprocess.check_call(["xdpyinfo"], stdout=subprocess.DEVNULL)\n')
MEETS = '''import os
import pathlib
import time

import pytest

pytestmark = pytest.mark.{}


def test_meeting():
    here = pathlib.Path(__file__)
    here.with_suffix('.came').touch()
    end = time.monotonic() + float(os.environ['MEETING_S'])
    while len(list(here.parent.glob('*.came'))) < 2:
        assert time.monotonic() < end, 'nobody else came'
        time.sleep(0.02)
'''


# Fails at these of its tries, which it counts in a file.
UNSOUND = """import pathlib


def test_unsound():
    came = pathlib.Path(__file__).with_suffix('.came')
    tries = int(came.read_text()) + 1 if came.exists() else 1
    came.write_text(str(tries))
    assert tries not in {}, 'try {{}}'.format(tries)
"""


JOB = re.compile(r'(FAIL|  ok) +[0-9.]+ s  (\S+): (.*)')
AGAIN = re.compile(r'AGAIN (\S+): .*: passed (\d) of 3')


class Package:
    """The runner with tests of its own beside it."""

    def __init__(self, folder):
        self.root = folder / 'mhri'
        shutil.copytree(str(REPO / 'test' / 'support'), str(self.root / 'test' / 'support'))
        for name in ('test/run.py', 'test/conftest.py', 'setup.cfg', 'package.xml'):
            shutil.copy(str(REPO / name), str(self.root / name))
        self.env = dict(os.environ, ROS_PACKAGE_PATH='{}:{}'.format(
            self.root, os.environ['ROS_PACKAGE_PATH']), MARK=str(folder))
        self.results = folder / 'results' / 'mhri'

    def write(self, tests):
        for name, text in tests.items():
            path = self.root / 'test' / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text)
            path.chmod(0o755)
        return self

    def start(self, *arguments, **env):
        """Start it with a folder of tests: what fails there does not run again."""
        return self.start_all(str(self.root / 'test'), *arguments, **env)

    def start_all(self, *arguments, **env):
        """Start it."""
        return subprocess.Popen(
            [sys.executable, str(self.root / 'test' / 'run.py'), '--results',
             str(self.results.parent), *arguments], stdout=subprocess.PIPE, encoding='utf-8',
            stderr=subprocess.STDOUT, env=dict(self.env, **env))

    def run(self, *arguments, **env):
        """Return (exit status, lines) of the tests in its folder."""
        return self.ends(self.start(*arguments, **env))

    def run_all(self, *arguments, **env):
        """Return (exit status, lines) of a run of everything."""
        return self.ends(self.start_all(*arguments, **env))

    @staticmethod
    def ends(process):
        """Return (exit status, lines)."""
        output = process.communicate(timeout=300)[0]
        print(output)
        return process.returncode, output.splitlines()


@pytest.fixture
def package(tmp_path):
    return Package(tmp_path)


# What each job ends with: (passed, failed).
ENDS = {
    'map/ros/test_pass.py': ('import rospy\n\n\n' + PASSES, (1, 0)),
    'map/ros/test_import.py': ('import no_such_module\n', (0, 1)),
    'map/ros/test_empty.py': ('', (0, 1)),
    'map/ros/test_crash.py': (CRASHES, (0, 1)),
    'map/ros/test_stop.py': (STOPS, (0, 1)),
    'map/ros/test_mark.py': (
        'import pytest\npytestmark = pytest.mark.tiemd\n' + PASSES, (0, 1)),
    'system/map/test_shows.py': (SHOWS, (1, 0)),
    'system/map/pass.test': (ROSTEST.format('timed', 'pass_node', 'pass'), (2, 0)),
    'system/map/fail.test': (ROSTEST.format('timed', 'fail_node', 'self.fail()'), (1, 1)),
    'system/map/exit.test': (ROSTEST.format('timed', 'exit_node', 'os._exit(3)'), (0, 1)),
}
PURE = {'map/test_a.py': PASSES + '\n\n' + FAILS, 'map/test_b.py': 'import rospy\n'}


def test_each_way_to_end_counts(package):
    status, lines = package.write(
        dict({name: text for name, (text, _) in ENDS.items()}, **PURE,
             **{'system/map/node.py': NODE})).run()
    counts = {name.replace('/', '-').rpartition('.')[0]: count
              for name, (_, count) in ENDS.items()}
    counts.update({'pure-1': (1, 1), 'pure-2': (0, 1)})
    said = {match.group(2): (match.group(1), match.group(3)) for match in map(JOB.match, lines)
            if match}
    assert said == {name: ('FAIL' if failed else '  ok', '{} passed, {} failed'.format(
        passed, failed)) for name, (passed, failed) in counts.items()}
    # So does what had to be done more than once, whether it is printed or in a file of results.
    assert sorted(line for line in lines if line.startswith('INSISTED ')) == [
        'INSISTED system-map-{}: 3 times: a node'.format(name) for name in ('fail', 'pass')]
    passes, failures = map(sum, zip(*counts.values()))
    assert (lines[-1], status) == ('{} passed, {} failed'.format(passes, failures), 1)
    assert len([line for line in lines if line.startswith('FAILED ')]) == failures
    # catkin_test_results finds the same: each file of results is whole.
    for path in package.results.glob('*.xml'):
        assert list(ElementTree.parse(str(path)).getroot().iter('testcase')), path


@pytest.mark.parametrize('tests, said, status', [
    ({}, '0 passed, 0 failed', 1),
    ({'map/ros/test_a.py': 'import pytest\n\n\n@pytest.mark.skip\n' + PASSES},
     '0 passed, 0 failed, 1 skipped', 1),
    ({'map/test_a.py': PASSES}, '1 passed, 0 failed', 0)])
def test_only_what_ran_and_passed_is_success(package, tests, said, status):
    done, lines = package.write(tests).run()
    assert (lines[-1], done) == (said, status)


def test_what_failed_is_printed_and_all_is_kept(package):
    status, lines = package.write({
        'map/ros/test_a.py': 'def test_a():\n    print("a figure: 42 ms")\n',
        'map/ros/test_b.py': 'def test_b():\n    print("why")\n    assert False\n'}).run()
    assert 'why' in '\n'.join(lines) and 'a figure' not in '\n'.join(lines)
    assert 'a figure: 42 ms' in (package.results / 'pytest-map-ros-test_a.log').read_text()
    # Those of the last run do not count.
    (package.root / 'test/map/ros/test_b.py').unlink()
    assert package.run()[1][-1] == '1 passed, 0 failed'


def test_what_failed_passes_three_times_of_three_alone_or_is_a_failure(package):
    """The others of its file do not run again; a failure elsewhere changes nothing."""
    status, lines = package.write({
        'map/ros/test_once.py': UNSOUND.format({1}) + '\n\n' + PASSES,
        'map/ros/test_twice.py': UNSOUND.format({1, 4}),
        'system/map/once.test': ROSTEST.format('timed', 'once_node', ''),
        'system/map/node.py': NODE.replace('exec(sys.argv[1])', 'test_unsound()').replace(
            'import unittest', 'import unittest\n' + UNSOUND.format({1})),
        'map/test_a.py': UNSOUND.format({1}), 'scripts/test_lint.py': FAILS}).run_all()
    assert (lines[-1], status) == ('4 passed, 3 failed', 1)
    again = dict(AGAIN.match(line).groups() for line in lines if line.startswith('AGAIN '))
    assert again == {'map-ros-test_once': '3', 'map-ros-test_twice': '2', 'system-map-once': '3'}
    for path, failures in (('pytest-map-ros-test_once.xml', 0), ('rosunit-once_node.xml', 0),
                           ('pytest-map-ros-test_twice.xml', 1)):
        root = ElementTree.parse(str(package.results / path)).getroot()
        assert sum(int(suite.get('failures')) for suite in root.iter('testsuite')) == failures, path
        # What it said at first is kept.
        assert 'try 1' in ElementTree.tostring(root, 'unicode')


MANY = '\n\n'.join('def test_{}():\n    assert False\n'.format(number) for number in range(11))


@pytest.mark.parametrize('tests, count', [
    ({'map/ros/test_a.py': MANY}, 11),
    ({'map/test_a.py': FAILS, 'map/ros/test_b.py': CRASHES,
      'map/ros/test_c.py': 'import no_such_module\n'}, 3)])
def test_what_is_pure_crashes_or_fails_often_does_not_run_again(package, tests, count):
    status, lines = package.write(tests).run_all()
    assert (lines[-1], status) == ('0 passed, {} failed'.format(count), 1)
    assert not [line for line in lines if line.startswith('AGAIN ')]


def test_a_leftover_process_is_ended(package):
    _, lines = package.write({'map/ros/test_leak.py': LEAKS}).run()
    assert lines[-1] == '1 passed, 0 failed'
    assert [line for line in lines if 'leftover process' in line and 'sleep 600' in line]
    assert children_with('MARK=' + package.env['MARK']) == []


def test_an_interrupted_run_leaves_nothing(package):
    package.write({'map/ros/test_a.py': 'import time\n\n\ndef test_a():\n    time.sleep(600)\n'})
    process = package.start()
    log = package.results / 'pytest-map-ros-test_a.log'
    wait_for(lambda: log.exists() and 'test_a.py::' in log.read_text())
    process.send_signal(signal.SIGINT)
    process.communicate(timeout=60)
    assert process.returncode and children_with('MARK=' + package.env['MARK']) == []


@pytest.mark.parametrize('marks, jobs, together', [
    (('paired', 'calm'), 3, True), (('timed', 'modest'), 6, True), (('timed', 'timed'), 6, False),
    (('timed', 'modest'), 3, False), (('paired', 'timed'), 6, False)])
def test_a_mark_says_what_runs_beside_it(package, marks, jobs, together):
    status, lines = package.write({
        'map/gui/test_{}.py'.format(number): MEETS.format(mark) if mark != 'calm' else
        MEETS.replace('pytestmark = ', '_ = ').format('modest')
        for number, mark in enumerate(marks)}).run(
            '--jobs', str(jobs), MEETING_S='100' if together else '0.5')
    assert lines[-1] == ('2 passed, 0 failed' if together else '1 passed, 1 failed')


def test_fast_tests_need_neither_ros_nor_a_screen(package):
    package.write({'scripts/test_lint.py': 'def test_flake8():\n    pass\n\n\n' + FAILS,
                   'map/test_a.py': PASSES, 'map/test_b.py': PASSES, 'map/ros/test_c.py': FAILS})
    assert package.run('--fast', DISPLAY='', PYTHONPATH='')[1][-1] == '3 passed, 0 failed'


@pytest.mark.parametrize('arguments, named', [
    (['--frobnicate'], '--frobnicate'), (['--jobs', '0'], '--jobs'), (['--mark', 'slow'], 'slow'),
    (['/etc'], '/etc')])
def test_wrong_arguments_are_refused_before_anything_is_installed(checkout, arguments, named):
    shutil.copytree(str(REPO / 'test'), str(checkout.root / 'test'))
    status, output = checkout.run(*arguments, script=checkout.script.with_name('mhri_test.sh'))
    assert status == 2 and named in output and checkout.calls == []


def test_mhri_test_runs_the_fast_tests_and_builds_nothing(checkout):
    small = Package(checkout.root.parent).write(
        {'scripts/test_lint.py': 'def test_flake8():\n    pass\n'})
    shutil.copytree(str(small.root / 'test'), str(checkout.root / 'test'))
    status, output = checkout.run('--fast', script=checkout.script.with_name('mhri_test.sh'))
    assert (status, output.splitlines()[-1]) == (0, '1 passed, 0 failed')
    assert checkout.calls == []


def test_path_with_a_space_is_refused(checkout):
    shutil.copytree(str(REPO / 'test'), str(checkout.root / 'test'))
    status, output = checkout.run(script=checkout.script.with_name('mhri_test.sh'))
    assert status == 1 and str(checkout.root) in output
    assert checkout.calls == []
