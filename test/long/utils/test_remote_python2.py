# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What runs on the robot, under the Python 2.7 of older robots."""
import glob
import os
import shutil
import subprocess

from support.checkout import REPO
import pytest
from test_remote_check import FakeMaster, HOST

REMOTE = REPO / 'utils' / 'remote'
PROGRAMS = sorted(path.name for path in REMOTE.iterdir() if path.is_file() and (
    path.suffix == '.py' or path.read_bytes().startswith(b'#!/usr/bin/env python')))
COMPILE = 'import sys; compile(open(sys.argv[1]).read(), sys.argv[1], "exec")'
SENTENCE = 'mhri: this computer has no IPv4 address'


def find_python2():
    """Return a Python 2.7 that runs, or None; pyenv has commands of that name that do not."""
    pyenv = os.environ.get('PYENV_ROOT') or os.path.expanduser('~/.pyenv')
    for path in [shutil.which('python2.7')] + sorted(glob.glob(
            pyenv + '/versions/2.7*/bin/python2.7')):
        if path and subprocess.run([path, '-c', ''], stderr=subprocess.DEVNULL).returncode == 0:
            return path
    return None


PYTHON2 = find_python2()
pytestmark = pytest.mark.skipif(PYTHON2 is None, reason='there is no Python 2.7 here')


def python2(*arguments):
    """Return (exit status, all output)."""
    done = subprocess.run([PYTHON2] + [str(argument) for argument in arguments], timeout=300,
                          env={'PATH': os.environ['PATH']}, stdin=subprocess.DEVNULL,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          universal_newlines=True)
    return done.returncode, done.stdout


@pytest.fixture
def master():
    fake = FakeMaster()
    yield fake
    fake.close()


def test_the_programs_are_found():
    assert {'mhri_guard', 'turtle_address.py', 'turtle_check.py'} <= set(PROGRAMS)


@pytest.mark.parametrize('program', PROGRAMS)
def test_it_compiles(program):
    assert python2('-c', COMPILE, REMOTE / program) == (0, '')


def test_the_compiler_would_speak_up(tmp_path):
    (tmp_path / 'sample').write_text('def f(*, a):\n    return f"{a}"\n')
    assert python2('-c', COMPILE, tmp_path / 'sample')[0] == 1


@pytest.mark.parametrize('own, status, said', [
    (['192.168.0.7', '10.0.0.5'], 0, '192.168.0.7\n'),
    ([], 1, SENTENCE),
])
def test_address(own, status, said):
    done, output = python2(REMOTE / 'turtle_address.py', '--ip', '192.168.0.103', *own)
    assert done == status and said in output and 'Traceback' not in output


def test_host_that_is_right(master):
    assert python2(REMOTE / 'turtle_check.py', 'host', HOST, master.port, HOST, 'bot1') == (0, '')


@pytest.mark.parametrize('nodes, said', [
    ({'/rosout': 'http://no-such-host.invalid:4711/'}, 'mhri: the host calls itself'),
])
def test_host_that_is_wrong(master, nodes, said):
    master.nodes.update(nodes)
    status, output = python2(REMOTE / 'turtle_check.py', 'host', HOST, master.port, HOST, 'bot1')
    assert status == 1 and output.startswith(said) and output.count('\n') == 1
