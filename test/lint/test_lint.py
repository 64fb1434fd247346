# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Each linter over the whole package, and over a bad sample to see that it would speak up."""
import contextlib
import hashlib
import os
from pathlib import Path
import re
import shutil
import subprocess
import sys

import pytest

REPO = Path(__file__).resolve().parents[2]
# mhri_test.sh installs there what the system does not package.
TOOLS = REPO / 'build' / '.ws' / 'tools'
PASSED = REPO / 'build' / '.ws' / 'flake8'
INSTALLED = '''<package format="2">
  <name>{}</name>
  <version>1.0.0</version>
  <description>Stands for an installed package.</description>
  <maintainer email="lab@example.org">A lab</maintainer>
  <license>BSD-3-Clause</license>
</package>
'''
PYTHON_TREES = ('src', 'test', 'utils', 'scripts')


def run(command, cwd=REPO):
    """Return (exit status, all output) of a command."""
    path = os.pathsep.join([str(TOOLS), os.environ.get('PYTHONPATH', '')])
    done = subprocess.run([str(part) for part in command], cwd=str(cwd), stdin=subprocess.DEVNULL,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          universal_newlines=True, env=dict(os.environ, PYTHONPATH=path))
    return done.returncode, done.stdout


def python_files():
    """Return every Python file of the package, those without an ending in scripts/ too."""
    found = [REPO / 'setup.py']
    for tree in PYTHON_TREES:
        found += (REPO / tree).rglob('*.py')
    found += [path for path in (REPO / 'scripts').iterdir() if path.is_file()]
    return sorted(set(found))


def shell_files():
    """Return every shell file: by its ending, or by its first line."""
    def is_shell(path):
        return path.suffix == '.sh' or path.read_bytes()[:32].startswith(
            (b'#!/usr/bin/env bash', b'#!/bin/bash', b'#!/bin/sh'))
    return sorted(path for tree in ('utils', '.ci', 'test', 'scripts', 'doc')
                  for path in (REPO / tree).rglob('*') if path.is_file() and is_shell(path))


def flake8(files, cwd=REPO):
    return run([sys.executable, '-m', 'flake8', '--config', REPO / 'setup.cfg'] + files, cwd)


def vermin(files):
    """Return (exit status, output): whether all of it is Python 3.8, annotations included."""
    return run([sys.executable, '-c', 'import vermin; vermin.main()', '-t=3.8-', '--violations',
                '--no-tips', '--eval-annotations'] + files)


def test_flake8_with_docstrings():
    """Each file that has not passed as it is, by the same rules and versions, before."""
    rules = run([sys.executable, '-m', 'flake8', '--version'])[1] + (REPO / 'setup.cfg').read_text()
    assert 'flake8-docstrings' in rules
    passed = set(PASSED.read_text().split()) if PASSED.exists() else set()
    files = {}
    for name in (str(path.relative_to(REPO)) for path in python_files()):
        key = rules.encode() + name.encode() + (REPO / name).read_bytes()
        files[hashlib.sha256(key).hexdigest()] = name
    new = [name for key, name in files.items() if key not in passed]
    status, output = flake8(new) if new else (0, '')
    assert status == 0, output
    with contextlib.suppress(OSError):
        PASSED.parent.mkdir(parents=True, exist_ok=True)
        PASSED.write_text('\n'.join(files))


@pytest.mark.parametrize('code, text', [
    ('F401', '"""Text."""\nimport os\n'),
    ('D103', '"""Text."""\n\n\ndef public():\n    return 1\n'),
    ('E501', '"""Text."""\nX = "' + 'x' * 100 + '"\n'),
    ('C901', '"""Text."""\n\n\ndef branchy(x):\n    """Text."""\n' +
     ''.join('    if x == {0}:\n        return {0}\n'.format(n) for n in range(11))),
])
def test_flake8_would_speak_up(tmp_path, code, text):
    (tmp_path / 'sample.py').write_text(text)
    status, output = flake8(['sample.py'], tmp_path)
    assert status != 0 and code in output


def test_shellcheck():
    status, output = run(['shellcheck', '-x'] + shell_files())
    assert status == 0, output


def test_shellcheck_would_speak_up(tmp_path):
    sample = tmp_path / 'sample.sh'
    sample.write_text('#!/bin/bash\nrm -rf $1/x\n')
    status, output = run(['shellcheck', sample])
    assert status != 0 and 'SC2086' in output


def test_shell_files_parse():
    for path in shell_files():
        assert run(['bash', '-n', path]) == (0, '')


def catkin_lint(tmp_path, manifest=None):
    """Return (exit status, output): judged as where every package that mhri names is installed.

    What is installed here, what rosdep knows and what was looked up before makes no difference: of
    an unknown package nothing is asked, so that a lint without these passes where others fail.
    """
    manifest = manifest or (REPO / 'package.xml').read_text(encoding='utf-8')
    installed = tmp_path / 'installed'
    # Those of the system have a hyphen in their names, or no manifest.
    for name in set(re.findall(r'depend[^>]*>([a-z_0-9]+)<', manifest)) | {'nodelet'}:
        (installed / name).mkdir(parents=True)
        (installed / name / 'package.xml').write_text(INSTALLED.format(name))
    # It wants the folder to be called as the package is, which a checkout need not be.
    package = tmp_path / 'mhri'
    shutil.copytree(str(REPO), str(package), ignore=shutil.ignore_patterns('build', '.*'))
    (package / 'package.xml').write_text(manifest, encoding='utf-8')
    return run(['env', 'ROS_HOME={}'.format(tmp_path), 'ROS_PACKAGE_PATH={}'.format(installed),
                'ROS_DISTRO=noetic', 'catkin_lint', '--offline', '--strict', '-W2', package])


def test_catkin_lint(tmp_path):
    status, output = catkin_lint(tmp_path)
    assert status == 0, output
    assert 'checked 1 packages and found 0 problems' in output


def test_catkin_lint_would_speak_up(tmp_path):
    """Of a package that a launch file needs and package.xml does not name, installed or not."""
    manifest = (REPO / 'package.xml').read_text(encoding='utf-8')
    status, output = catkin_lint(tmp_path, manifest.replace(
        '<exec_depend>nodelet</exec_depend>', ''))
    assert status != 0 and "needs exec_depend on 'nodelet'" in output


def test_python_3_8_library():
    status, output = vermin(python_files())
    assert "No module named 'vermin'" not in output, (
        'vermin is not there: mhri_test.sh installs it with pip and could not, see above')
    assert status == 0, output


@pytest.mark.parametrize('text', [
    'match = 1\nmatch match:\n    case 1:\n        pass\n',
    'from functools import cache\n',
    'import math\nmath.lcm(1, 2)\n',
    'def f(x: list[int]):\n    return x\n',
    '{} | dict()\n',
])
def test_python_3_8_check_would_speak_up(tmp_path, text):
    sample = tmp_path / 'sample.py'
    sample.write_text(text)
    status, output = vermin([sample])
    assert status != 0 and 'sample.py' in output


@pytest.fixture(scope='module')
def mypy(tmp_path_factory):
    """Return a function that gives (exit status, output) of the strict check.

    What the files import is not judged; what the standard library has is read once.
    """
    cache = tmp_path_factory.mktemp('mypy')
    return lambda files: run([sys.executable, '-m', 'mypy', '--config-file', REPO / 'setup.cfg',
                              '--cache-dir', cache] + files, cache)


def test_types_of_pure_files(mypy):
    """What lies in a subject's folder itself; most of the simulator has clocks, and no types."""
    files = [path for path in sorted((REPO / 'src' / 'mhri').glob('*/*.py'))
             if path.parent.name not in ('nodes', 'sim') and path.stem != 'rehearsal'
             or path.stem in ('faults', 'delay_line')]
    status, output = mypy(files)
    assert len(files) > 100
    assert 'No module named mypy' not in output, (
        'mypy is not there: mhri_test.sh installs it with pip and could not, see above')
    assert status == 0, output


@pytest.mark.parametrize('text, said', [
    ('def f(x):\n    return x\n', 'no-untyped-def'),
    ('def f(x: int) -> str:\n    return x\n', 'return-value'),
])
def test_mypy_would_speak_up(mypy, tmp_path, text, said):
    (tmp_path / 'sample.py').write_text(text)
    status, output = mypy([tmp_path / 'sample.py'])
    assert status != 0 and said in output
