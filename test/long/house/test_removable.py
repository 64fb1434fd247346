# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Each removable subject is deleted in a copy, with its row and its executables: all else runs."""
import ast
import os
from pathlib import Path
import shutil
import subprocess
import sys

import pytest

REPO = Path(__file__).resolve().parents[3]
sys.path.insert(0, str(REPO / 'test' / 'unit' / 'house'))

from support.ros_system import System  # noqa: E402
from test_house import imports, place_of, REMOVABLE  # noqa: E402

TIMEOUT_S = 600.0
# The subjects that look up modules by a row of a table, which no import shows.
BY_NAME = ('base', 'devices', 'graph', 'screen')
# It looks up those that other packages export.
OF_OTHERS = 'tasks'
COPIED = ('src', 'scripts', 'resource', 'launch', 'test', 'utils', 'doc', 'msg', 'srv', 'action',
          'package.xml', 'setup.py', 'setup.cfg', 'plugin.xml', 'CMakeLists.txt', 'README.md')
# Import every module, and whatever the rows of the tables name.
IMPORT_ALL = '''
import importlib, pathlib, sys
import pytest
import yaml
from support import rqt_stand_in
rqt_stand_in.plugin_class(pytest.MonkeyPatch())
src = pathlib.Path(sys.argv[1])
for path in sorted((src / 'mhri').rglob('*.py')):
    parts = path.relative_to(src).with_suffix('').parts
    importlib.import_module('.'.join(parts).replace('.__init__', ''))
from mhri.base import view_rows
from mhri.screen.parts import PARTS
devices = yaml.safe_load((src.parent / 'resource' / 'inputs.yaml').read_text())
rows = [name for _, name in PARTS] + [row['device'] for row in devices.values()]
for name in rows:
    view_rows.load(name)
print('imported', len([name for name in sys.modules if name.startswith('mhri.')]), *rows)
'''


def with_what_needs_them(subjects):
    """Return these subjects and those that go with them."""
    gone = set(subjects)
    for subject in subjects:
        gone |= set(REMOVABLE[subject])
    return gone


def known(path):
    """Return the subjects that a file imports, and the files beside it that it does."""
    subjects, files = set(), set()
    for _, module in imports(ast.parse(path.read_text(encoding='utf-8'))):
        subjects.add(place_of(module)[0])
        if module.split('.')[0] in ('support', 'bench'):
            tests = next(folder for folder in path.parents if folder.name == 'test')
            files.add(tests.joinpath(*module.split('.')).with_suffix('.py'))
        files.add(path.parent / (module + '.py'))
    return subjects, {found for found in files if found.is_file()}


def needs(path, gone, seen=()):
    """Return whether a test needs one of the subjects that have gone."""
    subjects, files = known(path)
    return bool(subjects & gone) or any(
        needs(other, gone, (*seen, path)) for other in files - {path, *seen})


class Copy:
    """A copy of the package without some subjects."""

    def __init__(self, folder, gone):
        self.gone = gone
        self.folder = folder
        for name in COPIED:
            if (REPO / name).is_dir():
                shutil.copytree(str(REPO / name), str(folder / name), ignore=shutil.
                                ignore_patterns('__pycache__', 'images'))
            else:
                shutil.copy(str(REPO / name), str(folder / name))
        self._remove()
        self.env = self._environment()

    def _remove(self):
        package = self.folder / 'src' / 'mhri'
        for subject in self.gone:
            shutil.rmtree(str(package / subject))
            for tests in (self.folder / 'test').glob('*/' + subject):
                shutil.rmtree(str(tests))
        for rows in (package / 'screen' / 'parts.py', self.folder / 'resource' / 'inputs.yaml'):
            rows.write_text(''.join(
                line for line in rows.read_text().splitlines(True)
                if not any('mhri.{}.'.format(subject) in line for subject in self.gone)))
        for path in (package / 'nodes').glob('*.py'):
            if known(path)[0] & self.gone:
                path.unlink()
                (self.folder / 'scripts' / path.stem).unlink()

    def _environment(self):
        """Return the variables by which Python and ROS find this mhri, and no other."""
        import mhri.msg
        built = Path(mhri.msg.__file__).parents[1]
        shutil.copytree(str(built), str(self.folder / 'built' / 'mhri'))
        entry = self.folder / 'built' / 'mhri' / '__init__.py'
        entry.write_text(entry.read_text().replace(str(REPO / 'src'), str(self.folder / 'src')))
        paths = [path for path in os.environ['PYTHONPATH'].split(os.pathsep)
                 if path and Path(path) not in (built.parent, REPO / 'src')]
        packages = [path for path in os.environ['ROS_PACKAGE_PATH'].split(os.pathsep)
                    if Path(path) != REPO]
        return {'ROS_PACKAGE_PATH': os.pathsep.join([str(self.folder), *packages]),
                'PYTHONPATH': os.pathsep.join([str(self.folder / 'built'),
                                               str(self.folder / 'test'), *paths])}

    def python(self, system, *arguments):
        """Run Python in it; return what it printed."""
        done = subprocess.run([sys.executable, *map(str, arguments)], stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, universal_newlines=True, timeout=TIMEOUT_S,
                              cwd=str(self.folder), env=system.env)
        assert done.returncode == 0, done.stdout[-3000:]
        return done.stdout


@pytest.fixture(scope='module')
def running():
    with System(adopt=False) as system:
        system.screen()
        system.start_master()
        yield system


@pytest.fixture
def system(running):
    """Return the running master and screen, in an environment that each test may change."""
    before = dict(running.env)
    yield running
    running.env.clear()
    running.env.update(before)


@pytest.fixture
def copy_without(tmp_path, system):
    """Return the function that makes a copy without some subjects, in the system's environment."""
    def make(*subjects):
        copy = Copy(tmp_path, with_what_needs_them(subjects))
        system.env.update(copy.env)
        return copy
    return make


@pytest.mark.parametrize('subject', REMOVABLE)
def test_all_else_is_there(system, copy_without, subject):
    copy = copy_without(subject)
    print(copy.python(system, '-c', IMPORT_ALL, copy.folder / 'src'))


def test_without_any_all_else_runs(system, copy_without):
    copy = copy_without(*REMOVABLE)
    print(copy.python(system, '-c', IMPORT_ALL, copy.folder / 'src'))
    mux = system.node('mux', '__name:=mux')
    # It ends once the mux has answered.
    copy.python(system, copy.folder / 'test' / 'support' / 'start_up.py', 'screen')
    system.kill(mux)
    tests = [path for subject in BY_NAME
             for path in sorted((copy.folder / 'test/unit' / subject).glob('test_*.py'))]
    # The search for states takes minutes.
    left = [path for path in tests
            if not needs(path, copy.gone) and not path.name.startswith('test_every_state')]
    assert len(left) > len(tests) / 2
    print(copy.python(system, '-m', 'pytest', '-q', '-p', 'no:cacheprovider', *left)[-300:])


def test_modules_are_looked_up_by_name_in_these_subjects_alone():
    users = {path.relative_to(REPO / 'src' / 'mhri').parts[0]
             for path in (REPO / 'src' / 'mhri').rglob('*.py')
             if 'import_module' in path.read_text(encoding='utf-8')}
    assert users - set(REMOVABLE) - {OF_OTHERS} <= set(BY_NAME)
