# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What is imported is named in package.xml, and what is named there is used."""
import ast
import functools
from pathlib import Path
import re
import sys
import xml.etree.ElementTree

import pytest

REPO = Path(__file__).resolve().parents[3]
ROOT = xml.etree.ElementTree.parse(str(REPO / 'package.xml')).getroot()
# Modules whose package, or rosdep key, has another name.
KEYS = {'aiohttp': 'python3-aiohttp', 'catkin_pkg': 'python3-catkin-pkg',
        'cryptography': 'python3-cryptography',
        'cv2': 'python3-opencv', 'evdev': 'python3-evdev',
        'jinja2': 'python3-jinja2', 'numpy': 'python3-numpy', 'psutil': 'python3-psutil',
        'pyaudio': 'python3-pyaudio', 'pygame': 'python3-pygame',
        'pyqtgraph': 'python3-pyqtgraph', 'pytest': 'python3-pytest',
        'qrcode': 'python3-qrcode',
        'PyQt5': 'python_qt_binding', 'rospkg': 'python3-rospkg',
        'setuptools': 'python3-setuptools', 'yaml': 'python3-yaml'}
# No key of rosdep; Python 2's names of modules; turtlesim, which tests have stand-ins of.
UNNAMED = {'pocketsphinx', 'SimpleXMLRPCServer', 'httplib', 'urlparse', 'xmlrpclib', 'turtlesim'}
# Used by other means than an import or a launch file.
USED = {
    'actionlib_msgs': 'our action',
    'libturbojpeg': 'loaded with ctypes', 'message_runtime': 'our messages',
    'openssl': 'makes keys',
    'roslaunch': 'starts everything', 'rqt_gui': 'the window of the panel'}
TOOLS = {'python3-pytest-timeout': 'ends a test that hangs',
         'ffmpeg': 'counts the pictures of a film',
         'python3-flake8': 'the linter', 'rosnode': 'a command',
         'rosparam': 'a command', 'rostest': 'runs them', 'rostopic': 'a command',
         'topic_tools': 'a relay'}
STDLIB = getattr(sys, 'stdlib_module_names', None)


def statements(node):
    """Yield all statements in a module or a statement; imports are nowhere else."""
    for part in ('body', 'orelse', 'handlers', 'finalbody'):
        for child in getattr(node, part, ()):
            yield child
            yield from statements(child)


def is_python(path):
    """Return whether a file is a Python program or module, by its ending or its first line."""
    if path.suffix == '.py':
        return True
    return path.suffix == '' and path.is_file() and re.match(
        rb'#!.*python', path.read_bytes()[:64]) is not None


@functools.lru_cache(None)
def imported(*trees):
    """Return the top names of all modules that the files of some folders import, but their own."""
    files = [path for tree in trees for path in sorted((REPO / tree).rglob('*'))
             if is_python(path) and 'example_robot_package' not in path.parts]
    found = set()
    for path in files:
        for node in statements(ast.parse(path.read_text(encoding='utf-8'))):
            if isinstance(node, ast.Import):
                found |= {alias.name.split('.')[0] for alias in node.names}
            elif isinstance(node, ast.ImportFrom) and not node.level:
                found.add(node.module.split('.')[0])
    own = {path.stem for path in files} | {path.name for tree in trees
                                           for path in (REPO / tree).rglob('*') if path.is_dir()}
    return found - own - {'mhri'} - UNNAMED - set(STDLIB or ())


def named(*tags):
    """Return what package.xml names in some kinds of dependencies."""
    return {entry.text for entry in ROOT if entry.tag in tags}


RUN = named('depend', 'exec_depend')


@pytest.mark.skipif(STDLIB is None, reason='this Python does not say which modules are its own')
@pytest.mark.parametrize('trees, wanted', [
    (('src', 'scripts', 'utils'), RUN),
    (('test',), RUN | named('test_depend', 'buildtool_depend')),
], ids=['run', 'test'])
def test_what_is_imported_is_named(trees, wanted):
    assert {KEYS.get(name, name) for name in imported(*trees)} - wanted == set()


def test_what_is_named_is_used():
    """Else everybody who installs mhri installs it in vain."""
    launched = {name for folder in ('launch', 'utils/remote')
                for path in (REPO / folder).glob('*.launch')
                for name in re.findall(r'pkg="(\w+)"', path.read_text(encoding='utf-8'))}
    run = {KEYS.get(name, name) for name in imported('src', 'scripts', 'utils')} | launched
    assert RUN - run - set(USED) == set()
    test = {KEYS.get(name, name) for name in imported('test')} | set(TOOLS)
    assert named('test_depend') - test == set()


def test_no_name_twice():
    """A test wants in addition what is not there to run."""
    assert named('test_depend') & RUN == set()
