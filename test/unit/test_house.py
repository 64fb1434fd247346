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
# The order of subjects: each imports only from itself and from those before it.
ORDER = ('base', 'graph', 'recording', 'robots', 'camera', 'sensors', 'devices', 'driving', 'map',
         'tasks', 'events', 'sim', 'voice', 'link', 'session', 'drill', 'doctor', 'screen',
         'replay')
# Subjects that can be taken out, and those that go with each.
REMOVABLE = {'voice': (), 'link': ('doctor',), 'session': ('drill', 'replay'), 'drill': (),
             'doctor': (), 'replay': ()}
# Folders of a subject; what lies beside them is pure.
KINDS = ('io', 'ros', 'gui', 'presenters')
# What joins subjects and kinds: executables, the program, the plugin.
JOINING = {'mhri_plugin.py', 'standalone.py', 'nodes'}


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


def place_of(module):
    """Return (subject, kind) of a module of mhri, e.g. ('camera', 'ros'); kind '' for a pure one.

    Of any other module, and of messages: (None, None).
    """
    parts = module.split('.')
    if parts[0] != 'mhri' or is_message(module):
        return None, None
    return ('.'.join(parts[1:2]), parts[2] if len(parts) > 2 and parts[2] in KINDS else '')


def of_kind(module, *kinds):
    """Tell whether a module is one of mhri's of these kinds."""
    subject, kind = place_of(module)
    return subject in ORDER and kind in kinds


def pure_may(module):
    top = module.split('.')[0]
    return (of_kind(module, '') or top in {'numpy', 'cv2', 'yaml'}
            or (top in STDLIB and top not in CLOCKS_AND_IO))


def opencv_may(module):
    """The loader of OpenCV, which holds an interrupt back meanwhile."""
    return pure_may(module) or module == 'signal'


def io_may(module):
    top = module.split('.')[0]
    own = of_kind(module, '', 'io') or not top == 'mhri'
    return own and top not in ROSPY | QT and not is_message(module)


def ros_may(module):
    top = module.split('.')[0]
    return top not in QT and (top != 'mhri' or module == top or is_message(module)
                              or of_kind(module, '', 'io', 'ros'))


def gui_may(module):
    top = module.split('.')[0]
    return (of_kind(module, '', 'gui') or top in STDLIB
            or top in {'python_qt_binding', 'pyqtgraph', 'numpy'})


def forms_may(module):
    """The loader of forms: python_qt_binding has none that reads a form once for all robots."""
    return gui_may(module) or module == 'PyQt5'


def sim_may(module):
    """The simulator beside ROS: it has clocks and files."""
    return (of_kind(module, '') or module.split('.')[0] in {'numpy', 'cv2', 'yaml'}
            or module.split('.')[0] in STDLIB)


# Files and folders with a rule of their own.
LODGERS = {'screen/presenters/demo.py': gui_may, 'base/gui/forms.py': forms_may,
           'base/opencv.py': opencv_may, 'drill/rehearsal.py': sim_may}
KIND_RULES = {'io': io_may, 'ros': ros_may, 'gui': gui_may, 'presenters': None, '': pure_may}


def kind_of(relative):
    """Return the kind of a file (path below src/mhri): its folder in the subject, '' for none."""
    parts = relative.parts
    return parts[1] if len(parts) > 2 else ''


def rule_for(relative):
    """Return the rule of imports for a file (path below src/mhri); None for the joining files."""
    if relative.as_posix() in LODGERS:
        return LODGERS[relative.as_posix()]
    if relative.parts[0] in JOINING:
        return None
    kind = kind_of(relative)
    return sim_may if (relative.parts[0], kind) == ('sim', '') else KIND_RULES[kind]


def imports(tree):
    """Yield (line, dotted module) of every import, ``from mhri.base import x`` as mhri.base.x."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            for alias in node.names:
                yield node.lineno, alias.name
        elif isinstance(node, ast.ImportFrom):
            parts = (node.module or '').split('.')
            if node.level:
                yield node.lineno, 'relative import'
            elif node.module == 'rospy' or parts[0] == 'mhri' and (
                    len(parts) < 3 and not is_message(node.module) or parts[-1] in KINDS):
                for alias in node.names:
                    yield node.lineno, '{}.{}'.format(node.module, alias.name)
            else:
                yield node.lineno, node.module


def import_problems(relative, text):
    """Imports that a file's kind may not have."""
    allowed = rule_for(relative)
    if allowed is None:
        return []
    return ['line {}: {} may not import {}'.format(line, relative.parent, module)
            for line, module in imports(parsed(text)) if not allowed(module)]


def order_problems(relative, text):
    """Imports of a subject that comes later, and of executables by anything else."""
    own = relative.parts[0]
    if own in JOINING or relative.as_posix() == '__init__.py':
        return []
    if own not in ORDER:
        return ['is in no subject']
    missed = [subject for subject, more in REMOVABLE.items() if own not in (subject, *more)]
    later = ORDER[ORDER.index(own) + 1:] + ('nodes', 'standalone', 'mhri_plugin')
    found = [(line, place_of(module)[0]) for line, module in imports(parsed(text))]
    return ['line {}: {} comes before {}'.format(line, own, other)
            for line, other in found if other in later] + [
        'line {}: {} must do without {}'.format(line, own, other)
        for line, other in found if other in missed and other not in later]


def call_problems(relative, text):
    """Calls that do I/O in a pure file: time, files and the terminal belong to others."""
    if rule_for(relative) is not pure_may:
        return []
    return ['line {}: a pure file does no I/O: {}()'.format(node.lineno, node.func.id)
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
        if not isinstance(node, ast.ClassDef) or kind_of(relative) != 'gui':
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
    if relative.as_posix() == 'recording/ros/bag_set.py':
        return []
    return ['line {}: opens a bag to read it'.format(node.lineno) for node in ast.walk(parsed(text))
            if isinstance(node, ast.Call) and getattr(node.func, 'attr', '') == 'Bag'
            and not any(getattr(one, 'value', '') in ('w', 'a') for one in node.args)]


RULES = (import_problems, order_problems, call_problems, size_problems, complexity_problems,
         spdx_problems, swallow_problems, constructor_problems, bag_problems)


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
    many = [Path('map/{}.py'.format(number)) for number in range(31)]
    assert crowded(many) == {Path('map')} and not crowded(many[1:])


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
    ('map/a.py', 'import rospy\n', 'may not import rospy'),
    ('map/a.py', 'from rospy import Time\n', 'may not import rospy'),
    ('map/a.py', 'import time\n', 'may not import time'),
    ('map/a.py', 'import threading\n', 'may not import threading'),
    ('map/a.py', 'import os.path\n', 'may not import os.path'),
    ('map/a.py', 'def f():\n    import time\n', 'may not import time'),
    ('map/a.py',
     'from mhri.robots.ros import convert\n', 'may not import mhri.robots.ros.convert'),
    ('map/a.py', 'from mhri.msg import ControlMode\n', 'may not import mhri.msg'),
    ('map/a.py', 'import requests\n', 'may not import requests'),
    ('map/a.py', 'from . import b\n', 'may not import relative import'),
    ('map/a.py', 'open("x")\n', 'no I/O: open()'),
    ('map/a.py', 'print("x")\n', 'no I/O: print()'),
    ('map/ros/a.py', 'import rosbag\nrosbag.Bag(path)\n', 'opens a bag'),
    ('voice/io/a.py', 'import rospy\n', 'may not import rospy'),
    ('voice/io/a.py', 'from python_qt_binding import QtCore\n', 'may not import python_qt_binding'),
    ('voice/io/a.py',
     'from mhri.robots.ros.convert import x\n', 'may not import mhri.robots.ros.convert'),
    ('map/ros/a.py', 'from python_qt_binding.QtCore import QTimer\n', 'python_qt_binding.QtCore'),
    ('map/ros/a.py', 'import pyqtgraph\n', 'may not import pyqtgraph'),
    ('map/ros/a.py',
     'from mhri.screen.gui.screen import Panel\n', 'may not import mhri.screen.gui.screen'),
    ('map/gui/a.py', 'import rospy\n', 'may not import rospy'),
    ('map/gui/a.py', 'from geometry_msgs.msg import Twist\n', 'may not import geometry_msgs.msg'),
    ('map/gui/a.py',
     'from mhri.msg import ControlMode\n', 'may not import mhri.msg'),
    ('map/gui/a.py', 'from mhri.robots.ros.fleet import Fleet\n',
     'may not import mhri.robots.ros.fleet'),
    ('sim/body.py', 'import rospy\n', 'may not import rospy'),
    ('sim/body.py', 'from std_msgs.msg import Bool\n', 'may not import std_msgs.msg'),
    ('sim/ros/node.py',
     'from python_qt_binding import QtCore\n', 'may not import python_qt_binding'),
    ('sim/body.py', 'from mhri.base.gui import theme\n', 'may not import mhri.base.gui.theme'),
    ('screen/presenters/demo.py', 'import rospy\n', 'may not import rospy'),
    ('other.py', 'import rospy\n', 'may not import rospy'),
    ('other/a.py', 'import math\n', 'is in no subject'),
    ('robots/a.py', 'from mhri.map.places import Place\n', 'robots comes before map'),
    ('robots/a.py', 'from mhri.map import places\n', 'robots comes before map'),
    ('robots/ros/a.py', 'import mhri.map.ros.map_feed\n', 'robots comes before map'),
    ('screen/gui/a.py', 'from mhri.drill.gui import drill_line\n', 'must do without drill'),
    ('screen/presenters/a.py', 'from mhri.standalone import x\n', 'screen comes before standalone'),
    ('map/a.py', '#\n' * 598, '601 lines, more than 600'),
    ('map/a.py', 'def f():\n' + '    f()\n' * 60, 'f() has 61 lines'),
    ('map/a.py', 'def f(x):\n' + '    if x:\n        x()\n' * 10, 'complexity 11'),
    ('map/a.py', '"""Text."""\n', 'two SPDX lines'),
    ('map/a.py', SPDX[0] + 'x\n"""Text."""\n', 'two SPDX lines'),
    ('map/ros/a.py', 'try:\n    f()\nexcept Exception:\n    pass\n', 'says nothing'),
    ('map/ros/a.py', 'try:\n    f()\nexcept:\n    pass\n', 'says nothing'),
    ('map/gui/a.py', 'class A:\n    def __init__(self):\n        self._build()\n'
     '    def _build(self):\n        pass\n    def _connect(self):\n        pass\n',
     'call _connect'),
], ids=lambda value: value.splitlines()[0][:40])
def test_wrong_sample_is_refused(relative, text, said):
    if 'SPDX' not in said:
        text = GOOD + text
    found = [problem for rule in RULES for problem in rule(Path(relative), text)]
    assert len([problem for problem in found if said in problem]) == 1, found


@pytest.mark.parametrize('relative, text', [
    ('map/a.py', 'import math\nimport numpy as np\nimport cv2, yaml\nfrom mhri.base import text\n'),
    ('voice/io/a.py', 'import pygame\nimport threading\n'
     'from mhri.devices.profile import Profile\n'),
    ('map/ros/a.py', 'import rospy, threading\nfrom nav_msgs.msg import Odometry\n'
     'from mhri.msg import RobotSelect\nfrom mhri.robots import link\n'),
    ('map/gui/a.py', 'import time\nimport pyqtgraph\nfrom python_qt_binding.QtCore import Qt\n'
     'from mhri.base.views import LIVE\nfrom mhri.base.gui import theme\n'),
    ('sim/body.py', 'import random\nimport numpy\nfrom mhri.base import limits\n'),
    ('sim/ros/node.py', 'import rospy\nfrom sensor_msgs.msg import Imu\n'
     'from mhri.sim.body import B\nfrom mhri.robots.ros import convert\n'),
    ('nodes/panel.py', 'import rospy\nfrom mhri.screen.gui.screen import Panel\n'),
    ('mhri_plugin.py', 'import rospy\nfrom rqt_gui_py.plugin import Plugin\n'),
    ('map/a.py', 'def f(x):\n' + '    if x:\n        x()\n' * 9),
    ('map/a.py', 'def f():\n' + '    f()\n' * 59),
    ('map/ros/a.py', 'try:\n    f()\nexcept OSError:\n    pass\n'),
    ('map/ros/a.py', 'try:\n    f()\nexcept (OSError, ValueError):\n    pass\n'),
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
