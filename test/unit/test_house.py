# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The rules of the house that a machine can check, over every file; and over wrong samples."""
import ast
import functools
from pathlib import Path
import sys

import mccabe
import pytest

REPO = Path(__file__).resolve().parents[2]
SOURCE = REPO / 'src' / 'mhri'
SPDX = ('# SPDX-FileCopyrightText: ', '# SPDX-License-Identifier: BSD-3-Clause')

ROSPY = {'rospy', 'roslib', 'roslaunch', 'actionlib', 'tf', 'tf2_ros', 'message_filters'}
QT = {'python_qt_binding', 'PyQt5', 'pyqtgraph', 'qt_gui', 'rqt_gui', 'rqt_gui_py'}
CLOCKS_AND_IO = {'threading', 'time', 'asyncio', 'concurrent', 'multiprocessing', 'queue', 'sched',
                 'socket', 'subprocess', 'os', 'io', 'pathlib', 'shutil', 'tempfile', 'glob',
                 'http', 'urllib', 'xmlrpc', 'select', 'signal', 'random', 'sys', 'logging'}
MESSAGES = {'mhri.msg', 'mhri.srv', 'cv_bridge', 'genpy', 'rosbag'}
# The files that join ROS and Qt; every other file keeps to its room.
JOINING = {'mhri_plugin.py', 'standalone.py'}
JOINING_ROOMS = {'nodes', 'presenters'}


# Each rule looks at the same text, one after the other.
parsed = functools.lru_cache(4)(ast.parse)


def stdlib_modules():
    """Return the names of the standard library's modules; Python says them itself from 3.10 on."""
    folder = Path(ast.__file__).parent
    return getattr(sys, 'stdlib_module_names', None) or set(sys.builtin_module_names).union(
        path.name.partition('.')[0] for place in (folder, folder / 'lib-dynload')
        for path in place.iterdir())


STDLIB = stdlib_modules()


def is_message(module):
    """Tell whether a module holds ROS messages or services."""
    parts = module.split('.')
    return module in MESSAGES or parts[0] in MESSAGES or parts[0].endswith(('_msgs', '_srvs'))


def in_rooms(module, *rooms):
    """Tell whether a module is one of mhri's rooms, or in it."""
    return any(module == 'mhri.' + room or module.startswith('mhri.' + room + '.')
               for room in rooms)


def core_may(module):
    top = module.split('.')[0]
    return (in_rooms(module, 'core') or top in {'numpy', 'cv2', 'yaml'}
            or (top in STDLIB and top not in CLOCKS_AND_IO))


def opencv_may(module):
    """The loader of OpenCV, which holds an interrupt back meanwhile."""
    return core_may(module) or module == 'signal'


def inputs_may(module):
    top = module.split('.')[0]
    own = in_rooms(module, 'core', 'inputs') or not top == 'mhri'
    return own and top not in ROSPY | QT and not is_message(module)


def ros_may(module):
    return module.split('.')[0] not in QT and not in_rooms(module, 'gui', 'nodes', 'sim')


def gui_may(module):
    top = module.split('.')[0]
    return (in_rooms(module, 'core', 'gui') or top in STDLIB
            or top in {'python_qt_binding', 'pyqtgraph', 'numpy'})


def forms_may(module):
    """The loader of forms: python_qt_binding has none that reads a form once for all robots."""
    return gui_may(module) or module == 'PyQt5'


def sim_may(module):
    """Plain modules of the simulator; its nodes, sim/*node.py, may be on the graph as well."""
    return (in_rooms(module, 'core', 'sim') or module.split('.')[0] in {'numpy', 'cv2', 'yaml'}
            or module.split('.')[0] in STDLIB)


def sim_node_may(module):
    return in_rooms(module, 'sim') or ros_may(module)


# Files whose rule is not that of the folder they are in.
LODGERS = {'sim/node.py': sim_node_may, 'sim/camera_node.py': sim_node_may,
           'sim/fault_node.py': sim_node_may,
           'presenters/demo.py': gui_may, 'gui/screen/forms.py': forms_may,
           'core/opencv.py': opencv_may}
ROOMS = {'core': core_may, 'inputs': inputs_may, 'ros': ros_may, 'gui': gui_may, 'sim': sim_may}


def rule_for(relative):
    """Return the rule of imports for a file (path below src/mhri); None for the joining files."""
    room, path = relative.parts[0], relative.as_posix()
    if path in LODGERS:
        return LODGERS[path]
    return None if path in JOINING or room in JOINING_ROOMS else ROOMS.get(room, core_may)


def imports(tree):
    """Yield (line, dotted module) of every import, ``from mhri.core import x`` as mhri.core.x."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            for alias in node.names:
                yield node.lineno, alias.name
        elif isinstance(node, ast.ImportFrom):
            if node.level:
                yield node.lineno, 'relative import'
            elif node.module in ('mhri', 'mhri.core', 'mhri.ros', 'mhri.gui', 'mhri.sim', 'rospy'):
                for alias in node.names:
                    yield node.lineno, '{}.{}'.format(node.module, alias.name)
            else:
                yield node.lineno, node.module


def import_problems(relative, text):
    """Imports that a file's room may not have."""
    allowed = rule_for(relative)
    if allowed is None:
        return []
    return ['line {}: {} may not import {}'.format(line, relative.parts[0], module)
            for line, module in imports(parsed(text)) if not allowed(module)]


def call_problems(relative, text):
    """Calls that do I/O in core/: time, files and the terminal belong to others."""
    if relative.parts[0] != 'core':
        return []
    return ['line {}: core does no I/O: {}()'.format(node.lineno, node.func.id)
            for node in ast.walk(parsed(text)) if isinstance(node, ast.Call)
            and isinstance(node.func, ast.Name) and node.func.id in {'open', 'print', 'input'}]


def functions(tree):
    return [node for node in ast.walk(tree)
            if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef))]


def size_problems(relative, text):
    """Files over 600 lines, functions over 60."""
    lines = len(text.splitlines())
    found = ['{} lines, more than 600'.format(lines)] if lines > 600 else []
    for node in functions(parsed(text)):
        length = node.end_lineno - node.lineno + 1
        if length > 60:
            found.append('line {}: {}() has {} lines, more than 60'.format(
                node.lineno, node.name, length))
    return found


def complexity_problems(relative, text):
    """Functions with a cyclomatic complexity over 10."""
    visitor = mccabe.PathGraphingAstVisitor()
    visitor.preorder(parsed(text), visitor)
    return ['line {}: {} has complexity {}, more than 10'.format(
        graph.lineno, graph.entity, graph.complexity())
        for graph in visitor.graphs.values() if graph.complexity() > 10]


def spdx_problems(relative, text):
    """The two SPDX lines at the top (or below ``#!``), in every file with anything in it."""
    lines = [line for line in text.splitlines()[:3] if not line.startswith('#!')][:2]
    good = len(lines) == 2 and lines[0].startswith(SPDX[0]) and lines[1] == SPDX[1]
    return [] if good or not text else ['does not begin with the two SPDX lines']


def swallow_problems(relative, text):
    """Exceptions of every kind that are caught and forgotten."""
    return ['line {}: catches everything and says nothing'.format(node.lineno)
            for node in ast.walk(parsed(text)) if isinstance(node, ast.ExceptHandler)
            and (not node.type or getattr(node.type, 'id', '') in {'Exception', 'BaseException'})
            and all(isinstance(item, ast.Pass) for item in node.body)]


def constructor_problems(relative, text):
    """A widget's constructor that does not call ``_build``, ... where the class has one."""
    found = []
    for node in ast.walk(parsed(text)):
        if not isinstance(node, ast.ClassDef) or relative.parts[0] != 'gui':
            continue
        methods = {item.name: item for item in node.body if isinstance(item, ast.FunctionDef)}
        called = {item.func.attr for item in ast.walk(methods.get('__init__', node))
                  if isinstance(item, ast.Call) and isinstance(item.func, ast.Attribute)}
        for step in ('_build', '_connect', '_restore'):
            if step in methods and '__init__' in methods and step not in called:
                found.append('line {}: the constructor of {} does not call {}'.format(
                    node.lineno, node.name, step))
    return found


def bag_problems(relative, text):
    """A bag that is opened to be read anywhere but in the one reader: rosbag runs what is in it."""
    if relative.as_posix() == 'ros/session/bag_set.py':
        return []
    return ['line {}: opens a bag to read it'.format(node.lineno) for node in ast.walk(parsed(text))
            if isinstance(node, ast.Call) and getattr(node.func, 'attr', '') == 'Bag'
            and not any(getattr(one, 'value', '') in ('w', 'a') for one in node.args)]


RULES = (import_problems, call_problems, size_problems, complexity_problems, spdx_problems,
         swallow_problems, constructor_problems, bag_problems)


def public_docstrings(text):
    """Return (names with a docstring, public names) of a module: itself, classes, functions.

    A function inside a function is no public name; neither is what begins with an underscore.
    """
    tree = parsed(text)
    nodes = [tree]
    for parent in [tree] + [node for node in tree.body if isinstance(node, ast.ClassDef)
                            and not node.name.startswith('_')]:
        nodes += [node for node in parent.body
                  if isinstance(node, (ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef))
                  and not node.name.startswith('_')]
    return sum(1 for node in nodes if ast.get_docstring(node)), len(nodes)


def script_problems(name, text):
    """An executable is three lines without an ending, calling ``mhri.nodes.<name>.main``."""
    wanted = '#!/usr/bin/env python3\nfrom mhri.nodes.{} import main\nmain()\n'.format(name)
    return [] if text == wanted else ['scripts/{} is not the three lines that call '
                                      'mhri.nodes.{}.main'.format(name, name)]


def crowded(paths):
    """Return the folders of these files with more than 30 of them."""
    folders = [path.parent for path in paths]
    return {folder for folder in folders if folders.count(folder) > 30}


def source_files():
    return sorted(SOURCE.rglob('*.py'))


@pytest.mark.parametrize('path', source_files(), ids=lambda path: str(path.relative_to(SOURCE)))
def test_file_keeps_the_rules(path):
    text = path.read_text(encoding='utf-8')
    relative = path.relative_to(SOURCE)
    assert [problem for rule in RULES for problem in rule(relative, text)] == []


@pytest.mark.parametrize(
    'path', sorted(set((REPO / 'test').rglob('*.py')) | {REPO / 'setup.py'}
                   | set((REPO / 'utils').rglob('*.py'))),
    ids=lambda path: str(path.relative_to(REPO)))
def test_file_outside_src_keeps_size_and_licence(path):
    text = path.read_text(encoding='utf-8')
    rules = (size_problems, complexity_problems, spdx_problems)
    assert [problem for rule in rules for problem in rule(path, text)] == []


def test_no_folder_has_more_than_30_files():
    assert crowded(path for path in SOURCE.rglob('*')
                   if path.is_file() and path.suffix != '.pyc') == set()
    many = [Path('core/{}.py'.format(number)) for number in range(31)]
    assert crowded(many) == {Path('core')} and not crowded(many[1:])


def test_public_docstrings():
    counts = [public_docstrings(path.read_text(encoding='utf-8'))
              for path in source_files() if path != SOURCE / '__init__.py']
    written, names = (sum(column) for column in zip(*counts))
    print('\npublic docstrings: {} of {} names, {:.0f} %'.format(
        written, names, 100.0 * written / names))
    assert written >= 0.9 * names


def test_package_file_is_empty():
    # It is executed on every "import mhri.msg".
    assert (SOURCE / '__init__.py').read_text() == ''


@pytest.mark.parametrize('path', sorted((REPO / 'scripts').iterdir()), ids=lambda path: path.name)
def test_script_is_three_lines(path):
    assert script_problems(path.name, path.read_text()) == []
    assert path.stat().st_mode & 0o111, 'is not executable'
    assert (SOURCE / 'nodes' / (path.name + '.py')).is_file()


def test_every_script_is_installed():
    text = (REPO / 'CMakeLists.txt').read_text().replace('${PROJECT_NAME}', 'mhri')
    for path in (REPO / 'scripts').iterdir():
        assert 'scripts/{}'.format(path.name) in text.split(), path.name


GOOD = '{}x\n{}\n"""Text."""\n'.format(*SPDX)


@pytest.mark.parametrize('relative, text, said', [
    ('core/a.py', 'import rospy\n', 'may not import rospy'),
    ('core/a.py', 'from rospy import Time\n', 'may not import rospy'),
    ('core/a.py', 'import time\n', 'may not import time'),
    ('core/a.py', 'import threading\n', 'may not import threading'),
    ('core/a.py', 'import os.path\n', 'may not import os.path'),
    ('core/a.py', 'def f():\n    import time\n', 'may not import time'),
    ('core/a.py', 'from mhri.ros import convert\n', 'may not import mhri.ros.convert'),
    ('core/a.py', 'from mhri.msg import ControlMode\n', 'may not import mhri.msg'),
    ('core/a.py', 'import requests\n', 'may not import requests'),
    ('core/a.py', 'from . import b\n', 'may not import relative import'),
    ('core/a.py', 'open("x")\n', 'no I/O: open()'),
    ('core/a.py', 'print("x")\n', 'no I/O: print()'),
    ('ros/a.py', 'import rosbag\nrosbag.Bag(path)\n', 'opens a bag'),
    ('inputs/a.py', 'import rospy\n', 'may not import rospy'),
    ('inputs/a.py', 'from python_qt_binding import QtCore\n', 'may not import python_qt_binding'),
    ('inputs/a.py', 'from mhri.ros.convert import x\n', 'may not import mhri.ros.convert'),
    ('ros/a.py', 'from python_qt_binding.QtCore import QTimer\n', 'python_qt_binding.QtCore'),
    ('ros/a.py', 'import pyqtgraph\n', 'may not import pyqtgraph'),
    ('ros/a.py',
     'from mhri.gui.screen.screen import Panel\n', 'may not import mhri.gui.screen.screen'),
    ('gui/a.py', 'import rospy\n', 'may not import rospy'),
    ('gui/a.py', 'from geometry_msgs.msg import Twist\n', 'may not import geometry_msgs.msg'),
    ('gui/a.py',
     'from mhri.msg import ControlMode\n', 'may not import mhri.msg'),
    ('gui/a.py', 'from mhri.ros.robots.fleet import Fleet\n',
     'may not import mhri.ros.robots.fleet'),
    ('sim/body.py', 'import rospy\n', 'may not import rospy'),
    ('sim/body.py', 'from std_msgs.msg import Bool\n', 'may not import std_msgs.msg'),
    ('sim/node.py', 'from python_qt_binding import QtCore\n', 'may not import python_qt_binding'),
    ('sim/body.py', 'from mhri.gui import theme\n', 'may not import mhri.gui.theme'),
    ('presenters/demo.py', 'import rospy\n', 'may not import rospy'),
    ('other.py', 'import rospy\n', 'may not import rospy'),
    ('core/a.py', '#\n' * 598, '601 lines, more than 600'),
    ('core/a.py', 'def f():\n' + '    f()\n' * 60, 'f() has 61 lines'),
    ('core/a.py', 'def f(x):\n' + '    if x:\n        x()\n' * 10, 'complexity 11'),
    ('core/a.py', '"""Text."""\n', 'two SPDX lines'),
    ('core/a.py', SPDX[0] + 'x\n"""Text."""\n', 'two SPDX lines'),
    ('ros/a.py', 'try:\n    f()\nexcept Exception:\n    pass\n', 'says nothing'),
    ('ros/a.py', 'try:\n    f()\nexcept:\n    pass\n', 'says nothing'),
    ('gui/a.py', 'class A:\n    def __init__(self):\n        self._build()\n'
     '    def _build(self):\n        pass\n    def _connect(self):\n        pass\n',
     'call _connect'),
], ids=lambda value: value.splitlines()[0][:40])
def test_wrong_sample_is_refused(relative, text, said):
    if 'SPDX' not in said:
        text = GOOD + text
    found = [problem for rule in RULES for problem in rule(Path(relative), text)]
    assert len([problem for problem in found if said in problem]) == 1, found


@pytest.mark.parametrize('relative, text', [
    ('core/a.py', 'import math\nimport numpy as np\nimport cv2, yaml\nfrom mhri.core import b\n'),
    ('inputs/a.py', 'import pygame\nimport threading\n'
     'from mhri.core.driving.profile import Profile\n'),
    ('ros/a.py', 'import rospy, threading\nfrom nav_msgs.msg import Odometry\n'
     'from mhri.msg import RobotSelect\nfrom mhri.core import link\n'),
    ('gui/a.py', 'import time\nimport pyqtgraph\nfrom python_qt_binding.QtCore import Qt\n'
     'from mhri.core.screen.views import LIVE\nfrom mhri.gui import theme\n'),
    ('sim/body.py', 'import random\nimport numpy\nfrom mhri.core import limits\n'),
    ('sim/node.py', 'import rospy\nfrom sensor_msgs.msg import Imu\nfrom mhri.sim.body import B\n'
     'from mhri.ros import convert\n'),
    ('nodes/panel.py', 'import rospy\nfrom mhri.gui.screen.screen import Panel\n'),
    ('mhri_plugin.py', 'import rospy\nfrom rqt_gui_py.plugin import Plugin\n'),
    ('core/a.py', 'def f(x):\n' + '    if x:\n        x()\n' * 9),
    ('core/a.py', 'def f():\n' + '    f()\n' * 59),
    ('ros/a.py', 'try:\n    f()\nexcept OSError:\n    pass\n'),
    ('ros/a.py', 'try:\n    f()\nexcept (OSError, ValueError):\n    pass\n'),
], ids=lambda value: value.splitlines()[0][:40])
def test_right_sample_is_accepted(relative, text):
    assert [p for rule in RULES for p in rule(Path(relative), GOOD + text)] == []


@pytest.mark.parametrize('name, text, good', [
    ('mux', '#!/usr/bin/env python3\nfrom mhri.nodes.mux import main\nmain()\n', True),
    ('mux', '#!/usr/bin/env python3\nfrom mhri.nodes.panel import main\nmain()\n', False),
    ('mux', '#!/usr/bin/env python3\nimport rospy\nrospy.spin()\n', False),
    ('mux.py', '#!/usr/bin/env python3\nfrom mhri.nodes.mux import main\nmain()\n', False),
])
def test_script_samples(name, text, good):
    assert (script_problems(name, text) == []) == good


@pytest.mark.parametrize('text, written, names', [
    ('"""Text."""\n', 1, 1),
    ('def f():\n    pass\n', 0, 2),
    ('"""T."""\nclass A:\n    """T."""\n    def g(self):\n        pass\n', 2, 3),
    ('"""T."""\ndef _f():\n    pass\n', 1, 1),
    ('"""T."""\nclass _A:\n    def g(self):\n        pass\n', 1, 1),
    ('"""T."""\ndef f():\n    """T."""\n    def g():\n        pass\n', 2, 2),
])
def test_docstring_samples(text, written, names):
    assert public_docstrings(text) == (written, names)
