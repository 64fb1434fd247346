# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The doctor on its own computer and on the master: from facts to findings."""
from dataclasses import replace

import pytest

from mhri.doctor.facts import (
    ANSWERS, Computer, Facts, FAULT, FINE, Folder, is_ipv4, is_loopback, Master, Node,
    REFUSED, SILENT, STRANGER, UNRESOLVED, WARNING)
from mhri.doctor.host import find_on_host, find_on_master, package_of

GIGA = 10 ** 9
URI = 'http://192.0.2.1:11311'
COMPUTER = Computer(
    name='desk', variables={'ROS_MASTER_URI': URI, 'ROS_IP': '192.0.2.1', 'ROS_DISTRO': 'noetic'},
    addresses=('127.0.0.1', '192.0.2.1'),
    resolved={'desk': ('192.0.2.1',), 'localhost': ('127.0.0.1',), 'robot': ('192.0.2.7',),
              'nobody': None},
    folders=(Folder('recordings', '/home/me/.ros', 50 * GIGA, device='1'),
             Folder('logs', '/home/me/.ros/log', 50 * GIGA, device='1')),
    package_path='/ws/src/mhri', python_paths=('/ws/src/mhri/src/mhri',),
    packages={'rospy': '', 'python3-pygame': ''})
MASTER = Master(URI, '192.0.2.1', 11311)
REMOTE = {'/bot1/base': Node('/bot1/base', 'http://192.0.2.7:4000/', '192.0.2.7')}


def facts(nodes=None, master=MASTER, variables=None, **changes):
    """Return the facts of a healthy computer, but for what is changed."""
    computer = replace(COMPUTER, **changes)
    if variables is not None:
        merged = dict(computer.variables, **variables)
        computer = replace(computer, variables={
            key: value for key, value in merged.items() if value is not None})
    return Facts(computer=computer, master=master, nodes=nodes or {})


def wrong(findings):
    return [(item.severity, item.check) for item in findings if item.severity != FINE]


def folder(free=50 * GIGA, problem='', what='recordings'):
    return Folder(what, '/home/me/.ros', free, problem, '1')


HOST = {
    'healthy': (facts(), []),
    'healthy with robots': (facts(REMOTE), []),
    'master variable unset': (facts(variables={'ROS_MASTER_URI': None}),
                              [(WARNING, 'master_uri_unset')]),
    'address with a port': (facts(variables={'ROS_IP': '192.0.2.1:11311'}),
                            [(FAULT, 'address_bad')]),
    'address with a scheme': (facts(variables={'ROS_HOSTNAME': 'http://desk'}),
                              [(FAULT, 'address_bad'), (WARNING, 'address_both')]),
    'address with a space': (facts(variables={'ROS_IP': ' 192.0.2.1'}), [(FAULT, 'address_bad')]),
    'a name for an address': (facts(variables={'ROS_IP': 'desk'}), [(FAULT, 'address_bad')]),
    'the address of another': (facts(variables={'ROS_IP': '192.0.2.99'}),
                               [(FAULT, 'address_foreign')]),
    'the name of another': (facts(variables={'ROS_IP': None, 'ROS_HOSTNAME': 'robot'}),
                            [(FAULT, 'address_foreign')]),
    'a name nobody knows': (facts(variables={'ROS_IP': None, 'ROS_HOSTNAME': 'nobody'}),
                            [(FAULT, 'address_unresolved')]),
    'loopback alone': (facts(variables={'ROS_IP': '127.0.0.1'}), []),
    'loopback with robots': (facts(REMOTE, variables={'ROS_IP': '127.0.0.1'}),
                             [(FAULT, 'address_loopback')]),
    'localhost with robots': (
        facts(REMOTE, variables={'ROS_HOSTNAME': 'localhost', 'ROS_IP': None}),
        [(FAULT, 'address_loopback')]),
    'loopback, and the master far away': (
        facts(master=Master('http://192.0.2.7:11311', '192.0.2.7', 11311), route_ip='192.0.2.1',
              variables={'ROS_IP': '127.0.0.1'}), [(FAULT, 'address_loopback')]),
    'the wrong one of two networks': (
        facts(REMOTE, addresses=('127.0.0.1', '192.0.2.1', '198.51.100.4'),
              route_ip='198.51.100.4'), [(WARNING, 'address_route')]),
    'two that differ': (facts(variables={'ROS_HOSTNAME': 'localhost'}),
                        [(WARNING, 'address_both')]),
    'two that agree': (facts(variables={'ROS_HOSTNAME': 'desk'}), []),
    'unset, alone': (facts(variables={'ROS_IP': None}), []),
    'unset with robots': (facts(REMOTE, variables={'ROS_IP': None}),
                          [(WARNING, 'address_unset')]),
    'unset, name unknown': (facts(variables={'ROS_IP': None}, resolved={'desk': None}),
                            [(FAULT, 'address_unset')]),
    'unset, name of another': (facts(variables={'ROS_IP': None}, resolved={'desk': ('9.9.9.9',)}),
                               [(FAULT, 'address_unset')]),
    'disk low': (facts(folders=(folder(900 * 10 ** 6),)), [(WARNING, 'disk_low')]),
    'disk full': (facts(folders=(folder(10 ** 6),)), [(FAULT, 'disk_full')]),
    'one full disk is said once': (facts(folders=(folder(0), folder(0, what='logs'))),
                                   [(FAULT, 'disk_full')]),
    'no permission': (facts(folders=(folder(problem='no permission'),)),
                      [(FAULT, 'folder_unwritable')]),
    'workspace not sourced': (facts(package_path=None, packages={}),
                              [(FAULT, 'workspace_missing')]),
    'two workspaces': (facts(python_paths=('/old/src/mhri/src/mhri',)),
                       [(WARNING, 'workspace_two')]),
    'installed': (facts(package_path='/opt/x/share/mhri',
                        python_paths=('/opt/x/lib/python3/dist-packages/mhri',)), []),
    'package missing': (facts(packages={'rospy': '', 'cv_bridge': 'no ROS package'}),
                        [(FAULT, 'package_missing')]),
    'package missing that is not needed': (
        facts(packages={'rospy': '', 'libturbojpeg': 'the library cannot be loaded'}),
        [(WARNING, 'package_missing')]),
    'template bad': (replace(facts(), template_errors=('a.yaml: name: is missing',)),
                     [(FAULT, 'template_bad')]),
    'pad bad': (replace(facts(), pad_errors=('my_pad.yaml: axes: is missing',)),
                [(WARNING, 'pad_bad')]),
}


@pytest.mark.parametrize('case', sorted(HOST))
def test_host(case):
    seen, expected = HOST[case]
    findings = find_on_host(seen)
    assert wrong(findings) == expected
    assert all(item.symptom and item.remedy for item in findings if item.severity != FINE)
    assert all(item.problem for item in findings)


@pytest.mark.parametrize('case, words', [
    ('the address of another', 'export ROS_IP=127.0.0.1'),
    ('loopback with robots', 'export ROS_IP=192.0.2.1'),
    ('the wrong one of two networks', 'export ROS_IP=198.51.100.4'),
    ('disk full', 'rosclean purge'),
    ('workspace not sourced', 'devel/setup.bash'),
    ('package missing', 'sudo apt install ros-noetic-cv-bridge'),
    ('master variable unset', 'export ROS_MASTER_URI=' + URI),
])
def test_remedy_names_the_command(case, words):
    assert words in [item for item in find_on_host(HOST[case][0])
                     if item.severity != FINE][0].remedy


def test_without_a_network_the_remedy_is_not_loopback():
    seen = facts(REMOTE, variables={'ROS_IP': '127.0.0.1'}, addresses=('127.0.0.1',))
    assert 'ROS_IP=<its address>' in find_on_host(seen)[0].remedy


@pytest.mark.parametrize('state, check, words', [
    (REFUSED, 'master_refused', 'roslaunch mhri mhri.launch'),
    (SILENT, 'master_silent', 'ping -c 3 192.0.2.1'),
    (UNRESOLVED, 'master_unresolved', '/etc/hosts'),
    (STRANGER, 'master_stranger', 'export ROS_MASTER_URI=http://192.0.2.1:11311'),
])
def test_master(state, check, words):
    finding, = find_on_master(facts(master=replace(MASTER, state=state, detail='because')))
    assert (finding.severity, finding.check) == (FAULT, check)
    assert words in finding.remedy


def test_master_of_another_computer_is_started_there():
    far = Master('http://192.0.2.7:11311', '192.0.2.7', 11311, REFUSED)
    assert find_on_master(facts(master=far))[0].remedy.startswith('on 192.0.2.7:')


def test_master_elsewhere_is_named():
    other = replace(MASTER, state=REFUSED, elsewhere=('http://localhost:11311',))
    finding, = find_on_master(facts(master=other))
    assert finding.check == 'master_elsewhere'
    assert finding.remedy == 'export ROS_MASTER_URI=http://localhost:11311'


def test_master_uri_that_is_none():
    bad = Master('192.0.2.1', '', 0, SILENT, uri_problem='it has the form http://...')
    finding, = find_on_master(facts(master=bad))
    assert finding.check == 'master_uri_bad' and 'export ROS_MASTER_URI=http://' in finding.remedy


def test_master_that_answers_is_fine():
    assert [item.severity for item in find_on_master(facts())] == [FINE]
    assert MASTER.state == ANSWERS


@pytest.mark.parametrize('name, distro, expected', [
    ('python3-pygame', 'noetic', 'python3-pygame'), ('cv_bridge', 'noetic', 'ros-noetic-cv-bridge'),
    ('nav_msgs', 'Debian', 'python3-nav-msgs')])
def test_package_of(name, distro, expected):
    assert package_of(name, replace(COMPUTER, variables={'ROS_DISTRO': distro})) == expected


@pytest.mark.parametrize('text, ip, loopback', [
    ('192.0.2.1', True, False), ('127.0.1.1', True, True), ('localhost', False, True),
    ('256.1.1.1', False, False), ('1.2.3', False, False), ('', False, False), ('::1', False, True),
    ('127.example.org', False, False)])
def test_addresses(text, ip, loopback):
    assert (is_ipv4(text), is_loopback(text)) == (ip, loopback)
