# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""mhri_test.sh on a package with small tests that fail in every way: its count is right.

The package is built and its tests are run by catkin, for real.
"""
import re
import shutil
import signal
import time

from conftest import Checkout, children_with, REPO
import pytest

ROSTEST = """<launch>
  <test test-name="{name}" pkg="mhri" type="{name}.py" time-limit="20"/>
</launch>
"""
NODE_TEST = """#!/usr/bin/env python3
import os
import unittest
import rosunit


class Case(unittest.TestCase):
    def test_one(self):
        {}

    def test_two(self):
        pass


rosunit.unitrun('mhri', '{}', Case)
"""
SMALL_TESTS = {
    'unit/test_good.py': 'import pytest\n\n\ndef test_a():\n    print("a figure: 42 ms")\n\n\n'
                         '@pytest.mark.skip\ndef test_b():\n    pass\n',
    'ros/test_ros.py': 'from mhri.msg import RobotSelect\n\n\ndef test_it():\n    RobotSelect()\n',
    'gui/test_screen.py': 'import subprocess\n\n\ndef test_display():\n'
                          '    subprocess.check_call(["xdpyinfo"], stdout=subprocess.DEVNULL)\n',
    'rostest/good.test': ROSTEST.format(name='good'),
    'rostest/good.py': NODE_TEST.format('pass', 'good'),
}
BAD_TESTS = {
    'unit/test_bad.py': 'def test_bad():\n    assert 1 == 2\n',
    'gui/test_crash.py': 'import os\n\n\ndef test_a():\n    os.abort()\n\n\n'
                         'def test_b():\n    pass\n',
    'faults/test_import.py': 'import no_such_module\n',
    'faults/test_none.py': '',
    'faults/test_leak.py': 'import subprocess\n\n\ndef test_leak():\n'
                           '    subprocess.Popen(["sleep", "600"], start_new_session=True)\n',
    'rostest/bad.test': ROSTEST.format(name='bad'),
    'rostest/bad.py': NODE_TEST.format('self.fail("so")', 'bad'),
    'rostest/crash.test': ROSTEST.format(name='crash'),
    'rostest/crash.py': NODE_TEST.format('os._exit(3)', 'crash'),
}
# Each run compiles anew what it imports, into a folder of its own: here all runs share one.
COMPILED_ONCE = 'import sys\n\nif sys.pycache_prefix:\n    sys.pycache_prefix = {!r}\n'
GROUPS = [word for group in ('unit', 'rostest', 'gui', 'faults') for word in ('--only', group)]


@pytest.fixture(scope='module')
def package(tmp_path_factory):
    """Return a checkout with the small tests; only what would change this machine is a stand-in."""
    made = Checkout(tmp_path_factory.mktemp('package'), 'mhri',
                    stand_ins=('dpkg-query', 'apt-get', 'sudo'))
    shutil.copytree(str(REPO / 'src'), str(made.root / 'src'))
    shutil.copy(str(REPO / 'plugin.xml'), str(made.root))
    cmake = made.root / 'CMakeLists.txt'
    cmake.write_text(with_one_message(cmake.read_text()))
    made.environment['DISPLAY'] = ''
    made.environment['CI'] = 'true'
    start = tmp_path_factory.mktemp('python')
    (start / 'sitecustomize.py').write_text(COMPILED_ONCE.format(str(start / 'compiled')))
    made.environment['PYTHONPATH'] = str(start)
    # The library of the link, which the small tests do not need.
    library = re.search('eclipse-zenoh==[0-9.]+', (REPO / 'utils/host/common.sh').read_text())
    (made.root / 'build/.ws/link').mkdir(parents=True)
    (made.root / 'build/.ws/link/installed').write_text(library.group())
    write_tests(made, SMALL_TESTS)
    return made


def with_one_message(text):
    """Return a CMakeLists.txt with the one message of the small tests: others only take time."""
    text, cut = re.subn(r'add_(message|service|action)_files\([^)]*\)\n', '', text)
    assert cut == 3 and text.count('generate_messages(') == 1
    return text.replace('generate_messages(',
                        'add_message_files(FILES RobotSelect.msg)\ngenerate_messages(')


def write_tests(package, tests):
    for name, text in tests.items():
        path = package.root / 'test' / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
        path.chmod(0o755)


def run_tests(package, *arguments):
    """Return (exit status, output) of mhri_test.sh."""
    return package.run(*arguments, script=package.script.with_name('mhri_test.sh'), limit_s=900)


def test_good_tests(package):
    status, output = run_tests(package, *GROUPS[:-2])
    assert output.splitlines()[-1] == '5 passed, 0 failed, 1 skipped', output
    assert status == 0
    assert 'a figure: 42 ms' in output
    assert package.called('apt-get', 'sudo') == []


def test_bad_tests_are_all_counted(package):
    write_tests(package, BAD_TESTS)
    status, output = run_tests(package, *GROUPS)
    assert status == 1
    failed = [line for line in output.splitlines() if line.startswith('FAILED')
              and '.xml: ' in line]
    for name in ('test_bad', 'MISSING-pytest-gui_calm-test_crash', 'faults_calm-test_import',
                 'pytest-faults_calm-test_none.xml: no test ran', 'rosunit-bad',
                 'rosunit-crash.xml: is not a complete result file'):
        assert [line for line in failed if name in line], (name, output)
    assert output.splitlines()[-1] == '7 passed, 6 failed, 1 skipped', output
    assert 'ending a leftover process' in output and 'sleep 600' in output


def test_results_of_the_last_run_do_not_count(package):
    shutil.rmtree(str(package.root / 'test' / 'unit'))
    status, output = run_tests(package, '--only', 'gui', '--only', 'unit', '--once')
    assert output.splitlines()[-1] == '2 passed, 2 failed', output


FAILS_AT_FIRST = '''import pathlib


def test_it():
    before = pathlib.Path(__file__ + '.ran')
    assert before.exists() or before.touch()
'''


def test_what_failed_runs_once_more_and_stays_in_the_count(package):
    for folder in ('gui', 'rostest'):
        shutil.rmtree(str(package.root / 'test' / folder), ignore_errors=True)
    node = NODE_TEST.format('p = __file__ + ".ran"\n'
                            '        assert os.path.exists(p) or open(p, "w").close()', 'node')
    write_tests(package, {'gui/test_one.py': FAILS_AT_FIRST, 'rostest/node.py': node,
                          'rostest/node.test': ROSTEST.format(name='node')})
    arguments = ('--only', 'gui', '--only', 'rostest')
    status, output = run_tests(package, *arguments)
    assert (output.splitlines()[-1], status) == ('3 passed, 0 failed, 2 failed at first', 0)
    assert len([line for line in output.splitlines() if line.startswith('FAILED AT FIRST')]) == 2
    write_tests(package, {'gui/test_one.py': 'def test_it():\n    assert False\n'})
    status, output = run_tests(package, *arguments)
    assert (output.splitlines()[-1], status) == ('2 passed, 1 failed, 1 failed at first', 1)


def test_interrupted_run_leaves_nothing(package):
    write_tests(package, {
        'gui/test_one.py': 'import time\n\n\ndef test_long():\n'
                           '    print("up", flush=True)\n    time.sleep(600)\n'})
    # Several at once print what they say when they have ended.
    process = package.start('--only', 'gui', '--jobs', '1',
                            script=package.script.with_name('mhri_test.sh'))
    for line in process.stdout:
        if line.strip().endswith('up'):
            break
    process.send_signal(signal.SIGINT)
    process.communicate(timeout=60)
    assert process.returncode == 130
    end = time.monotonic() + 60.0
    while children_with(str(package.calls_file)):
        assert time.monotonic() < end
        time.sleep(0.02)


MEETING = '''import os
import pathlib
import time


def test_meeting():
    here = pathlib.Path(__file__).resolve()
    (here.parent / (here.stem + '.came')).touch()
    end = time.monotonic() + float(os.environ['MEETING_S'])
    while len(list(here.parent.glob('*.came'))) < 2:
        assert time.monotonic() < end, 'nobody else came'
        time.sleep(0.02)
'''


@pytest.mark.parametrize('names, jobs, together', [
    ('one two', '2', True), ('one two', '1', False), ('one drive', '3', True),
    ('killed key_held', '4', False)])
def test_files_that_measure_no_times_run_together(package, names, jobs, together):
    for folder in ('scripts', 'gui'):
        shutil.rmtree(str(package.root / 'test' / folder), ignore_errors=True)
    write_tests(package, {'gui/test_{}.py'.format(name): MEETING for name in names.split()})
    status, output = package.run(
        '--only', 'gui', '--jobs', jobs, '--once', script=package.script.with_name('mhri_test.sh'),
        limit_s=900, MEETING_S='600' if together else '0.5')
    assert output.splitlines()[-1] == ('2 passed, 0 failed' if together else '1 passed, 1 failed')
    assert re.search(r'^mhri: times: gui\w* \d+ s', output, re.M), output


@pytest.fixture
def fast(checkout):
    """Return a function that runs the fast group with a unit test; nothing is built."""
    def go(text):
        write_tests(checkout, {'scripts/test_lint.py': 'def test_flake8():\n    pass\n',
                               'unit/test_rule.py': text})
        shutil.copy(str(REPO / 'test' / 'run_fast.sh'), str(checkout.root / 'test'))
        status, output = run_tests(checkout, '--only', 'fast')
        assert checkout.calls == [], output
        return status, output
    return go


@pytest.mark.parametrize('text, status, count', [
    ('def test_rule():\n    assert True\n', 0, '2 passed, 0 failed'),
    ('def test_rule():\n    assert False\n', 1, '1 passed, 1 failed'),
    ('import os\n\n\ndef test_rule():\n    os._exit(0)\n', 1, '1 passed, 1 failed'),
    ('import no_such_module\n', 1, '1 passed, 2 failed'),
])
def test_fast_group_builds_and_installs_nothing(fast, text, status, count):
    done, output = fast(text)
    assert output.splitlines()[-1] == count, output
    assert done == status and 'mhri: times: fast ' in output


@pytest.mark.parametrize('arguments, said', [
    (['--frobnicate'], 'there is no option --frobnicate'),
    (['--only'], "there is no group ''"),
    (['--only', 'nothing'], "there is no group 'nothing'"),
    (['--only', 'unit gui'], "there is no group 'unit gui'"),
    (['--jobs'], "--jobs: '' is not a number"),
    (['--jobs', '0'], "--jobs: '0' is not a number"),
    (['unit'], "'unit' is not an option"),
])
def test_wrong_arguments_are_refused(checkout, arguments, said):
    status, output = run_tests(checkout, *arguments)
    assert status == 2 and said in output
    assert checkout.calls == []


def test_path_with_a_space_is_refused(checkout):
    status, output = run_tests(checkout)
    assert status == 1 and 'path with a space' in output and str(checkout.root) in output
    assert checkout.calls == []


def test_help_is_the_manual(checkout):
    status, output = run_tests(checkout, '--help')
    assert status == 0 and checkout.calls == []
    assert '--only' in output and '--bench' in output and 'exit status' in output
