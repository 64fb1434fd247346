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

REPO = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(REPO / 'test'), str(REPO / 'test' / 'unit')]

from support.ros_system import System  # noqa: E402
from test_house import imports, place_of, REMOVABLE  # noqa: E402

START_S = 600.0
COPIED = ('src', 'scripts', 'resource', 'launch', 'test', 'utils', 'doc', 'msg', 'srv', 'action',
          'package.xml', 'setup.py', 'setup.cfg', 'plugin.xml', 'CMakeLists.txt', 'README.md')
IMPORT_ALL = '''
import importlib, pathlib, sys
import pytest
from support import rqt_stand_in
rqt_stand_in.plugin_class(pytest.MonkeyPatch())
for path in sorted(pathlib.Path(sys.argv[1]).rglob('*.py')):
    parts = path.relative_to(sys.argv[1]).with_suffix('').parts
    importlib.import_module('.'.join(('mhri',) + parts).replace('.__init__', ''))
print('imported', len([name for name in sys.modules if name.startswith('mhri.')]))
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
            files.add(path.parents[1].joinpath(*module.split('.')).with_suffix('.py'))
        files.add(path.parent / (module + '.py'))
    return subjects, {found for found in files if found.is_file()}


def needs(path, gone, seen=()):
    """Tell whether a test needs one of the subjects that have gone."""
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
        rows = package / 'screen' / 'parts.py'
        rows.write_text(''.join(
            line for line in rows.read_text().splitlines(True)
            if not any("'mhri.{}.".format(subject) in line for subject in self.gone)))
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
                              stderr=subprocess.STDOUT, universal_newlines=True, timeout=START_S,
                              cwd=str(self.folder), env=system.env)
        assert done.returncode == 0, done.stdout[-3000:]
        return done.stdout


@pytest.fixture
def system():
    with System(adopt=False) as running:
        running.screen()
        running.start_master()
        yield running


@pytest.fixture
def copy_without(tmp_path, system):
    """Return the function that makes a copy without some subjects, in the system's environment."""
    def make(*subjects):
        copy = Copy(tmp_path, with_what_needs_them(subjects))
        system.env.update(copy.env)
        return copy
    return make


@pytest.mark.parametrize('subjects', [(one,) for one in REMOVABLE] + [tuple(REMOVABLE)],
                         ids='-'.join)
def test_all_else_runs(system, copy_without, subjects):
    copy = copy_without(*subjects)
    print(copy.python(system, '-c', IMPORT_ALL, copy.folder / 'src' / 'mhri'))
    for node in ('mux', 'gates'):
        system.node(node, '__name:=' + ('mhri_gates' if node == 'gates' else node))
    # It ends once mux and gates have answered.
    copy.python(system, copy.folder / 'test' / 'support' / 'start_up.py', 'screen')


def test_fast_tests_pass_without_any(system, copy_without):
    copy = copy_without(*REMOVABLE)
    tests = sorted((copy.folder / 'test' / 'unit').glob('test_*.py'))
    # The rules for single files hold already; the manifest names what all subjects need.
    left = [path for path in tests if not needs(path, copy.gone)
            and path.stem not in ('test_house', 'test_house_rospy', 'test_manifest')]
    assert len(left) > len(tests) / 2
    print(copy.python(system, '-m', 'pytest', '-q', '-p', 'no:cacheprovider', *left)[-300:])
