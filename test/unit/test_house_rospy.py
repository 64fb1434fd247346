# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What reaches beneath rospy's public interface is in three files, which look first what is there.

Only as far as the source tells: by the names of modules, and by those of attributes.
"""
import ast

import pytest

from test_house import imports, SOURCE, source_files

INSIDE = ('graph/ros/rospy_inside.py', 'graph/ros/prompt.py', 'graph/ros/peers.py')
BENEATH = {'client', 'core', 'impl', 'msg', 'msproxy', 'names', 'service', 'timer', 'topics'}
# They begin with an underscore and are offered all the same: by messages (AnyMsg has its bytes
# nowhere else), by Python.
OFFERED = {'_buff', '_full_text', '_has_header', '_md5sum', '_type', '_exit', '_replace'}


def is_beneath(node):
    """Tell whether an attribute is rospy's own affair."""
    owner = getattr(node.value, 'id', '') or getattr(getattr(node.value, 'func', None), 'id', '')
    private = node.attr.startswith('_') and not node.attr.startswith('__') \
        and node.attr not in OFFERED and owner not in ('self', 'cls', 'super')
    return private or node.attr == 'impl' or owner == 'rospy' and node.attr in BENEATH


def beneath(text):
    """Return what a file reaches for beneath rospy, as a list; [] where it does not import it."""
    tree = ast.parse(text)
    modules = [module for _, module in imports(tree) if module.split('.')[0] == 'rospy']
    found = [module for module in modules if BENEATH & set(module.split('.'))]
    return found + [node.attr for node in ast.walk(tree) if modules
                    and isinstance(node, ast.Attribute) and is_beneath(node)]


@pytest.mark.parametrize('name', sorted(
    set(path.relative_to(SOURCE).as_posix() for path in source_files()) - set(INSIDE)))
def test_a_file_keeps_to_what_rospy_offers(name):
    assert beneath((SOURCE / name).read_text(encoding='utf-8')) == []


@pytest.mark.parametrize('name', INSIDE)
def test_who_reaches_beneath_it_looks_at_import_whether_all_is_there(name):
    text = (SOURCE / name).read_text(encoding='utf-8')
    calls = [node.value.func.id for node in ast.parse(text).body if isinstance(node, ast.Expr)
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
def test_samples(text, found):
    assert beneath(text) == found
