# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The rules of the house that a machine can check, over every file; and over wrong samples."""
import ast
import functools
from pathlib import Path
import re
import sys

import pytest

REPO = Path(__file__).resolve().parents[3]
SOURCE = REPO / 'src' / 'mhri'
SPDX = ('# SPDX-FileCopyrightText: ', '# SPDX-License-Identifier: BSD-3-Clause')

ROSPY = {'rospy', 'roslib', 'roslaunch', 'actionlib', 'tf', 'tf2_ros', 'message_filters'}
QT = {'python_qt_binding', 'PyQt5', 'pyqtgraph', 'qt_gui', 'rqt_gui', 'rqt_gui_py'}
CLOCKS_AND_IO = {'threading', 'time', 'asyncio', 'concurrent', 'multiprocessing', 'queue', 'sched',
                 'socket', 'subprocess', 'os', 'io', 'pathlib', 'shutil', 'tempfile', 'glob',
                 'http', 'urllib', 'xmlrpc', 'select', 'signal', 'random', 'sys', 'logging'}
MESSAGES = {'mhri.msg', 'mhri.srv', 'cv_bridge', 'genpy', 'rosbag'}
# The order of subjects: each imports only from itself and from those before it.
ORDER = ('base', 'graph', 'recording', 'robots', 'camera', 'sensors', 'devices', 'driving',
         'accessories', 'events', 'map', 'tasks', 'sim', 'voice', 'link', 'session', 'drill',
         'doctor', 'screen', 'replay', 'web')
# Subjects that can be taken out, and those that go with each.
REMOVABLE = {'voice': (), 'link': ('doctor',), 'session': ('drill', 'replay', 'web'), 'drill': (),
             'doctor': (), 'replay': (), 'web': ()}
# Folders of a subject; what lies beside them is pure.
KINDS = ('io', 'ros', 'gui', 'presenters')
# What joins subjects and kinds: executables, the program, the plugin.
JOINING = {'mhri_plugin.py', 'standalone.py', 'nodes'}


# Qt's and Python's means to read and show numbers as the computer's language has them.
BY_LANGUAGE = {'locale', 'QLocale', 'QSpinBox', 'QDoubleSpinBox', 'QInputDialog', 'QIntValidator',
               'QDoubleValidator', 'QTextStream'}
# rospy's own modules, and three files that reach for them and look first what is there.
BENEATH = {'client', 'core', 'impl', 'msg', 'msproxy', 'names', 'service', 'timer', 'topics'}
INSIDE = ('graph/ros/rospy_inside.py', 'graph/ros/non_blocking.py', 'graph/ros/peers.py')
# They begin with an underscore and are offered all the same: by messages (AnyMsg has its bytes
# nowhere else), by Python.
OFFERED = {'_buff', '_full_text', '_has_header', '_md5sum', '_type', '_slot_types', '_exit',
           '_replace'}


@functools.lru_cache(2)
def nodes(text):
    """Return all that a text says, as Python 3.8 has it; each rule looks at it, one by one.

    :raises SyntaxError: newer versions alone understand it
    """
    return list(ast.walk(ast.parse(text, feature_version=(3, 8))))


def stdlib_modules():
    """Return the names of the standard library's modules; Python says them itself from 3.10 on."""
    folder = Path(ast.__file__).parent
    return getattr(sys, 'stdlib_module_names', None) or set(sys.builtin_module_names).union(
        path.name.partition('.')[0] for place in (folder, folder / 'lib-dynload')
        for path in place.iterdir())


STDLIB = stdlib_modules()


def is_message(module):
    """Return whether a module holds ROS messages or services."""
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
    """Return whether a module is one of mhri's of these kinds."""
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


def imports(text):
    """Yield (line, dotted module) of every import, ``from mhri.base import x`` as mhri.base.x."""
    for node in nodes(text):
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
            for line, module in imports(text) if not allowed(module)]


def order_problems(relative, text):
    """Imports of a subject that comes later, and of executables by anything else."""
    own = relative.parts[0]
    if own in JOINING or relative.as_posix() == '__init__.py':
        return []
    if own not in ORDER:
        return ['is in no subject']
    missed = [subject for subject, more in REMOVABLE.items() if own not in (subject, *more)]
    later = ORDER[ORDER.index(own) + 1:] + ('nodes', 'standalone', 'mhri_plugin')
    found = [(line, place_of(module)[0]) for line, module in imports(text)]
    return ['line {}: {} comes before {}'.format(line, own, other)
            for line, other in found if other in later] + [
        'line {}: {} must do without {}'.format(line, own, other)
        for line, other in found if other in missed and other not in later]


def call_problems(relative, text):
    """Calls that do I/O in a pure file: time, files and the terminal belong to others."""
    if rule_for(relative) is not pure_may:
        return []
    return ['line {}: a pure file does no I/O: {}()'.format(node.lineno, node.func.id)
            for node in nodes(text) if isinstance(node, ast.Call)
            and isinstance(node.func, ast.Name) and node.func.id in {'open', 'print', 'input'}]


def size_problems(relative, text):
    """Files over 600 lines, functions over 60."""
    lines = len(text.splitlines())
    found = ['{} lines, more than 600'.format(lines)] if lines > 600 else []
    return found + [
        'line {}: {}() has {} lines, more than 60'.format(
            node.lineno, node.name, node.end_lineno - node.lineno + 1)
        for node in nodes(text) if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef))
        and node.end_lineno - node.lineno >= 60]


def spdx_problems(relative, text):
    """The two SPDX lines at the top (or below ``#!``), in every file with anything in it."""
    lines = [line for line in text.splitlines()[:3] if not line.startswith('#!')][:2]
    good = len(lines) == 2 and lines[0].startswith(SPDX[0]) and lines[1] == SPDX[1]
    return [] if good or not text else ['does not begin with the two SPDX lines']


def swallow_problems(relative, text):
    """Exceptions of every kind that are caught and forgotten."""
    return ['line {}: catches everything and says nothing'.format(node.lineno)
            for node in nodes(text) if isinstance(node, ast.ExceptHandler)
            and (not node.type or getattr(node.type, 'id', '') in {'Exception', 'BaseException'})
            and all(isinstance(item, ast.Pass) for item in node.body)]


def constructor_problems(relative, text):
    """A widget's constructor that does not call ``_build``, ... where the class has one."""
    found = []
    for node in nodes(text):
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
    return ['line {}: opens a bag to read it'.format(node.lineno) for node in nodes(text)
            if isinstance(node, ast.Call) and getattr(node.func, 'attr', '') == 'Bag'
            and not any(getattr(one, 'value', '') in ('w', 'a') for one in node.args)]


def is_beneath(node):
    """Return whether an attribute is rospy's own affair."""
    owner = getattr(node.value, 'id', '') or getattr(getattr(node.value, 'func', None), 'id', '')
    private = node.attr.startswith('_') and not node.attr.startswith('__') \
        and node.attr not in OFFERED and owner not in ('self', 'cls', 'super')
    return private or node.attr == 'impl' or owner == 'rospy' and node.attr in BENEATH


def beneath(text):
    """Return what a file reaches for beneath rospy, as a list; [] where it does not import it."""
    modules = [module for _, module in imports(text) if module.split('.')[0] == 'rospy']
    found = [module for module in modules if BENEATH & set(module.split('.'))]
    return found + [node.attr for node in nodes(text) if modules
                    and isinstance(node, ast.Attribute) and is_beneath(node)]


def rospy_problems(relative, text):
    """What reaches beneath rospy's public interface, outside of the files that look it over."""
    return [] if relative.as_posix() in INSIDE else [
        'reaches beneath rospy: ' + name for name in beneath(text)]


def language_problems(relative, text):
    """What reads or shows numbers in the computer's language: 1.5 would be 15."""
    return ['line {}: {} goes by the language: take NumberField, or format()'.format(line, name)
            for line, name in sorted(
                (node.lineno, name) for node in nodes(text)
                for name in [getattr(node, 'attr', ''), getattr(node, 'id', '')] + [
                    alias.name for alias in getattr(node, 'names', ()) if hasattr(alias, 'name')]
                if name in BY_LANGUAGE)]


RULES = (import_problems, order_problems, call_problems, size_problems, spdx_problems,
         swallow_problems, constructor_problems, bag_problems, rospy_problems, language_problems)


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


def problems(paths, root, rules):
    """Return ['path: problem'] of these files."""
    return ['{}: {}'.format(path.relative_to(root), problem) for path in paths for rule in rules
            for problem in rule(path.relative_to(root), path.read_text(encoding='utf-8'))]


def test_files_keep_the_rules():
    assert problems(source_files(), SOURCE, RULES) == []


def test_forms_have_no_number_widgets():
    for form in (REPO / 'resource').rglob('*.ui'):
        assert [name for name in BY_LANGUAGE if name in form.read_text()] == []


def test_scripts_do_not_go_by_the_language():
    """Whoever runs a script gets the settings of turtle_arguments.sh, by common.sh or directly."""
    wants = re.compile(r'printf .*%[0-9.]*[efg]|\b(sort|awk|seq|date|tr|comm|bc)\b|=~|\[a-z')
    scripts = [path.read_text() for path in (REPO / 'utils').rglob('*.sh')]
    assert [text[:300] for text in scripts if text.startswith('#!') and wants.search(text)
            and not re.search(r'^\. .*/(common|turtle_arguments)\.sh"$', text, re.M)] == []


def test_files_outside_src_keep_size_and_licence():
    paths = {REPO / 'setup.py', *(REPO / 'test').rglob('*.py'), *(REPO / 'utils').rglob('*.py')}
    assert problems(sorted(paths), REPO, (size_problems, spdx_problems)) == []


def names_in(path):
    """Return the names that a module may offer: what it defines, assigns or imports."""
    found = nodes(path.read_text(encoding='utf-8'))
    return ({node.name for node in found if isinstance(node, (ast.FunctionDef, ast.ClassDef))}
            | {node.id for node in found
               if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store)}
            | {(name.asname or name.name).split('.')[0] for node in found
               if isinstance(node, (ast.Import, ast.ImportFrom)) for name in node.names})


@functools.lru_cache(None)
def offers(module, name):
    """Return whether a module of mhri or of the tests' support has a name; True for any other."""
    root = {'mhri': REPO / 'src', 'support': REPO / 'test'}.get(module.split('.')[0])
    if root is None or is_message(module):
        return True
    place = root.joinpath(*module.split('.'))
    file = place.with_suffix('.py')
    file = file if file.exists() else place / '__init__.py'
    return (place / name).is_dir() or (place / (name + '.py')).exists() or (
        file.exists() and name in names_in(file))


def absent_problems(relative, text):
    """A name that no longer exists is found here, not in the first test that happens to run it."""
    return ['{} has no {}'.format(node.module, name.name) for node in nodes(text)
            if isinstance(node, ast.ImportFrom) and node.module and not node.level
            for name in node.names if not offers(node.module, name.name)]


def test_every_imported_name_exists():
    paths = [*SOURCE.rglob('*.py'), *(REPO / 'test').rglob('*.py')]
    assert problems(sorted(paths), REPO, (absent_problems,)) == []
    assert absent_problems('a.py', 'from mhri.base.names import NO_SUCH, NUMBERS') == [
        'mhri.base.names has no NO_SUCH']
    assert absent_problems('a.py', 'from support.no_such import a') and not absent_problems(
        'a.py', 'from rospy import no_such; from mhri.base import names; from mhri.msg import X')


def closure(module, found):
    """Add the modules of mhri that a module imports, and those that these import."""
    path = SOURCE.joinpath(*module.split('.')[1:])
    path = path / '__init__.py' if path.is_dir() else path.with_suffix('.py')
    if module in found or is_message(module) or not path.exists():
        return found
    found.add(module)
    for _, name in imports(path.read_text(encoding='utf-8')):
        parts = name.split('.')
        for number in range(2, len(parts) + 1) if parts[0] == 'mhri' else ():
            closure('.'.join(parts[:number]), found)
    return found


def test_what_is_sent_to_a_robot_has_all_that_its_link_imports():
    script = (REPO / 'utils/host/turtlebot_deploy.sh').read_text(encoding='utf-8')
    sent = set(re.search(r'cp -r __init__.py ([a-z \\\n]+) "', script).group(1).split()) - {'\\'}
    needed = {name.split('.')[1] for name in closure('mhri.nodes.mhri_link', set())}
    assert sent == needed and 'link' in needed


def test_no_folder_has_more_than_30_files():
    assert crowded(path for path in SOURCE.rglob('*')
                   if path.is_file() and path.suffix != '.pyc') == set()
    many = [Path('map/{}.py'.format(number)) for number in range(31)]
    assert crowded(many) == {Path('map')} and not crowded(many[1:])


def test_every_folder_is_a_package():
    """Only those are installed."""
    folders = {path.parent for path in source_files()}
    assert {folder for folder in folders if not (folder / '__init__.py').exists()} == set()


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
    ('map/gui/a.py', 'from mhri.robots.ros.robot_monitors import RobotMonitors\n',
     'may not import mhri.robots.ros.robot_monitors'),
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
    ('robots/ros/a.py', 'import mhri.map.ros.map_source\n', 'robots comes before map'),
    ('screen/gui/a.py', 'from mhri.drill.gui import drill_line\n', 'must do without drill'),
    ('screen/presenters/a.py', 'from mhri.standalone import x\n', 'screen comes before standalone'),
    ('map/a.py', '#\n' * 598, '601 lines, more than 600'),
    ('map/a.py', 'def f():\n' + '    f()\n' * 60, 'f() has 61 lines'),
    ('map/a.py', '"""Text."""\n', 'two SPDX lines'),
    ('map/a.py', SPDX[0] + 'x\n"""Text."""\n', 'two SPDX lines'),
    ('map/ros/a.py', 'try:\n    f()\nexcept Exception:\n    pass\n', 'says nothing'),
    ('map/ros/a.py', 'try:\n    f()\nexcept:\n    pass\n', 'says nothing'),
    ('map/gui/a.py', 'from python_qt_binding.QtWidgets import QLabel, QSpinBox\n', 'QSpinBox goes'),
    ('map/ros/a.py', 'import locale\n', 'locale goes by the language'),
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


@pytest.mark.parametrize('name', INSIDE)
def test_who_reaches_beneath_rospy_looks_at_import_whether_all_is_there(name):
    text = (SOURCE / name).read_text(encoding='utf-8')
    calls = [node.value.func.id for node in nodes(text)[0].body if isinstance(node, ast.Expr)
             and isinstance(getattr(node.value, 'func', None), ast.Name)]
    assert beneath(text) and set(calls) & {'require', '_check'}


@pytest.mark.parametrize('text, found', [
    ('import rospy\nfrom rospy.impl import tcpros_base', ['rospy.impl']),
    ('from rospy import topics', ['rospy.topics']),
    ('import rospy.msproxy', ['rospy.msproxy']),
    ('import rospy\nrospy.core.is_initialized()', ['core']),
    ('import rospy\nprint(message._connection_header)', ['_connection_header']),
    ('import rospy\nself._publisher.impl.seq = 0', ['impl']),
    ('import rospy\nself._hear(message._buff)\nsuper()._build()\nrospy.get_name()', []),
    ('from rospy.numpy_msg import numpy_msg\nfrom rospy import AnyMsg, Time', []),
    ('import rosbag\nbag._chunks', [])])
def test_samples_of_what_is_beneath_rospy(text, found):
    assert beneath(text) == found


def test_a_file_that_newer_versions_alone_understand_is_refused():
    with pytest.raises(SyntaxError):
        nodes('match = 1\nmatch match:\n    case 1:\n        pass\n')
