# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Which namespaces are robots."""
import os

import pytest

from mhri.core.config import ConfigError
from mhri.core.discovery import Candidate, find_candidates, IgnoreList, nodes_of, parse_ignore_list

IGNORE = IgnoreList(('/rosout', '/*/rosout', '/bot*/helper'), ('mux', 'rqt_*'))
RESOURCE = os.path.join(os.path.dirname(__file__), '..', '..', 'resource', 'discovery.yaml')


def state(*nodes):
    """Return a system state in which each node publishes, subscribes or serves something."""
    groups = [[], [], []]
    for number, node in enumerate(nodes):
        groups[number % 3].append(['/topic{}'.format(number), [node]])
    return groups


CASES = {
    'nothing': ((), {}, (), []),
    'by_type': ((), {'bot1': {'robot_type': 'turtlebot2'}}, (), [Candidate('bot1', 'turtlebot2')]),
    'by_nodes': (('/bot1/base',), {}, (), [Candidate('bot1', None, ('/bot1/base',))]),
    'by_both': (('/bot1/base', '/bot1/cam'), {'bot1': {'robot_type': 'x'}}, (),
                [Candidate('bot1', 'x', ('/bot1/base', '/bot1/cam'))]),
    'no_namespace': (('/base', '/rosout'), {'robot_type': 'x', 'rosdistro': 'noetic'}, (), []),
    'parameters_of_another_kind': ((), {'bot1': {'rate': 3}, 'bot2': 7}, (), []),
    'ignored_node': (('/bot1/rosout', '/bot1/helper'), {}, (), []),
    'ignored_node_does_not_hide_others': (
        ('/bot1/rosout', '/bot1/base'), {}, (), [Candidate('bot1', None, ('/bot1/base',))]),
    'ignored_namespace': (('/rqt_gui/a',), {'mux': {'robot_type': 'x'}}, (), []),
    'known': (('/bot1/base', '/bot2/base'), {'bot1': {'robot_type': 'x'}}, ('bot1',),
              [Candidate('bot2', None, ('/bot2/base',))]),
    'sorted': (('/b/n', '/c/n'), {'a': {'robot_type': 'x'}}, (), [
        Candidate('a', 'x'), Candidate('b', None, ('/b/n',)), Candidate('c', None, ('/c/n',))]),
    'deep_nodes_belong_to_the_first_segment': (
        ('/bot1/camera/driver',), {}, (), [Candidate('bot1', None, ('/bot1/camera/driver',))]),
    'type_of_another_kind': ((), {'bot1': {'robot_type': 3}}, (), [Candidate('bot1', '3')]),
}


@pytest.mark.parametrize('case', sorted(CASES))
def test_find_candidates(case):
    """A robot has a type, or nodes that are neither ignored nor under a known robot."""
    nodes, parameters, known, expected = CASES[case]
    assert find_candidates(state(*nodes), parameters, IGNORE, known) == expected


def test_invalid_names_are_found_with_their_problem():
    """Shown as refused, not left out in silence."""
    found = find_candidates(state('/_bot/base'), {'1bot': {'robot_type': 'x'}}, IGNORE)
    assert [(item.name, bool(item.problem)) for item in found] == [('1bot', True), ('_bot', True)]


def test_nodes_of_counts_each_once():
    """A node has many topics."""
    assert nodes_of([[['/a', ['/n', '/m']]], [['/b', ['/n']]], []]) == ['/m', '/n']


def test_shipped_ignore_list_hides_mhri_itself_and_no_robot():
    """The host's own nodes are never offered."""
    with open(RESOURCE, encoding='utf-8') as stream:
        ignore = parse_ignore_list(stream.read(), 'discovery.yaml')
    own = state('/mux', '/rosout', '/mhri_panel', '/robot_controller/x', '/mux_in/x',
                '/vrpn_client_node/x', '/bot1/base', '/rosbag/record')
    assert [item.name for item in find_candidates(own, {}, ignore)] == ['bot1']


@pytest.mark.parametrize('text, key', [
    ('nodes: 3', 'nodes'), ('spaces: [a]', 'spaces'), ('namespaces: {a: b}', 'namespaces')])
def test_ignore_list_error_names_file_and_key(text, key):
    """A lab adds to it."""
    with pytest.raises(ConfigError, match='f.yaml: {}: '.format(key)):
        parse_ignore_list(text, 'f.yaml')


def test_a_thousand_robots_take_no_time():
    """Every name is looked at once; the limit of the contract is for the whole of discovery."""
    nodes = ['/bot{}/node{}'.format(robot, node) for robot in range(100) for node in range(20)]
    assert len(find_candidates(state(*nodes), {}, IGNORE)) == 100
