# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Robot types of other packages, found by what their package.xml exports."""
import os

import pytest
import rospkg

from mhri.base.robot_types import load_robot_types
from mhri.graph.ros.resources import exported_types

TEMPLATE = 'name: {}\nlimits: {{linear_mps: 0.3, angular_rad_s: 1.0}}\ncommand: cmd_vel\n'
MANIFEST = '''<?xml version="1.0"?>
<package format="2">
  <name>{name}</name>
  <version>0.1.0</version>
  <description>A robot.</description>
  <maintainer email="lab@example.org">A lab</maintainer>
  <license>BSD-3-Clause</license>
  <buildtool_depend>catkin</buildtool_depend>
  <export>{export}</export>
</package>
'''
EXPORT = '<mhri robot_type="${prefix}/robot.yaml"/>'


@pytest.fixture
def workspace(tmp_path):
    """Return a function that writes a package and its template; and the folder of them all."""
    def package(name, export=EXPORT, template=TEMPLATE):
        folder = tmp_path / name
        folder.mkdir()
        (folder / 'package.xml').write_text(MANIFEST.format(name=name, export=export))
        if template is not None:
            (folder / 'robot.yaml').write_bytes(
                template if isinstance(template, bytes) else template.format(name).encode())
        return folder
    package.path = tmp_path
    return package


def exported(workspace):
    """Return what the packages of a workspace export."""
    return exported_types(rospkg.RosPack([str(workspace.path)]))


def test_packages_that_export_nothing_of_ours(workspace):
    workspace('plain', '')
    workspace('plugin', '<rqt_gui plugin="${prefix}/plugin.xml"/>')
    assert exported(workspace) == ([], [])


def test_an_export(workspace):
    folder = workspace('crawler', '<mhri robot_type="${prefix}/robot.yaml" window="a.b.C"/>')
    (export,), errors = exported(workspace)
    assert errors == []
    assert (export.package, export.origin, export.text, export.window) == (
        'crawler', str(folder / 'robot.yaml'), TEMPLATE.format('crawler'), 'a.b.C')


def test_several_exports_of_a_package_in_the_order_of_the_packages(workspace):
    workspace('b')
    folder = workspace('a', EXPORT + '<mhri robot_type="more.yaml"/>')
    (folder / 'more.yaml').write_text(TEMPLATE.format('more'))
    exports, errors = exported(workspace)
    assert errors == [] and [export.package for export in exports] == ['a', 'a', 'b']
    assert sorted(load_robot_types([], exports)[0]) == ['a', 'b', 'more']


BROKEN = {
    'no_file': ((EXPORT, None), 'robot.yaml: cannot be read (No such file or directory), though '),
    'a_folder': (('<mhri robot_type="${prefix}"/>',), 'cannot be read (Is a directory)'),
    'not_text': ((EXPORT, b'\xff\xfe'), 'robot.yaml: is not UTF-8 text'),
    'no_attribute': (('<mhri/>',), '<mhri>: names no template; write <mhri robot_type="${prefix}'),
    'empty_attribute': (('<mhri robot_type=""/>',), '<mhri>: names no template'),
    'misspelt': (('<mhri robot_typ="${prefix}/robot.yaml"/>',), 'unknown attribute robot_typ; '),
}


@pytest.mark.parametrize('case', sorted(BROKEN))
def test_broken_export_is_named_and_hides_no_other(workspace, case):
    arguments, said = BROKEN[case]
    workspace('a_good')
    folder = workspace('broken', *arguments)
    workspace('z_good')
    exports, errors = exported(workspace)
    assert [export.package for export in exports] == ['a_good', 'z_good']
    text, = map(str, errors)
    assert text.startswith('package broken: {}'.format(folder)) and said in text


def test_manifest_that_cannot_be_understood(workspace):
    """It has a name, so that ROS finds it, and not all that a package has to have."""
    folder = workspace('broken')
    text = (folder / 'package.xml').read_text()
    (folder / 'package.xml').write_text(text.replace('<license>BSD-3-Clause</license>', ''))
    workspace('good')
    exports, errors = exported(workspace)
    assert [export.package for export in exports] == ['good']
    assert str(errors[0]).startswith('package broken: {}: '.format(folder / 'package.xml'))


def test_manifest_that_cannot_be_read(workspace, monkeypatch):
    """It went while it was looked at."""
    folder = workspace('gone')
    rospack = rospkg.RosPack([str(workspace.path)])
    assert list(rospack.list()) == ['gone']
    os.remove(str(folder / 'package.xml'))
    assert exported_types(rospack) == ([], [])


WRONG = {
    'too_large': ('is larger than 250 kB', lambda path: path.write_bytes(b'#' * 10000000)),
    'endless': ('is not a regular file', lambda path: path.symlink_to('/dev/zero')),
    'pipe': ('is not a regular file', os.mkfifo),
    'tag': ("line 1: 'maybe'", lambda path: path.write_text('name: !!bool maybe')),
    'bytes': ('is not UTF-8', lambda path: path.write_bytes(b'name: \xff')),
}


@pytest.mark.parametrize('case', sorted(WRONG))
def test_a_hostile_template_hides_no_other(workspace, case):
    """Neither by its tags and size, nor by never ending."""
    said, write = WRONG[case]
    workspace('good')
    write(workspace('wrong', template=None) / 'robot.yaml')
    exports, errors = exported(workspace)
    types, unusable = load_robot_types([], exports)
    assert sorted(types) == ['good'] and len(errors + unusable) == 1
    message = str((errors + unusable)[0])
    assert said in message and message.count('robot.yaml') == 1 and len(message) <= 300
