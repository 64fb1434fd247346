# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The doctor on the computer it runs on: ROS variables, folders, workspace, packages, master."""
from typing import Dict, List, Optional, Tuple

from mhri.base.text import listed
from mhri.doctor.facts import (
    ANSWERS, Computer, Facts, FAULT, Finding, FINE, Folder, HOST, is_ipv4, is_loopback, MASTER,
    Master, REFUSED, STRANGER, UNRESOLVED, WARNING)

MB = 1000 * 1000
# The recorder's limits: it warns below the first and stops at the second.
LOW_BYTES, FULL_BYTES = 1000 * MB, 256 * MB
_NO_DATA = 'robots and topics are listed, but no data arrives, or in one direction only'


def find_on_host(facts: Facts) -> List[Finding]:
    """Return the findings about this computer."""
    found = (_variables(facts) + _folders(facts.computer) + _workspace(facts.computer)
             + _packages(facts.computer) + [
                 Finding(FAULT, 'template_bad', HOST, 'a robot type is unusable: ' + text,
                         'robots of that type are driven as generic, or not offered',
                         'fix the file named above, or remove it')
                 for text in facts.template_errors] + [
                 Finding(WARNING, 'pad_bad', HOST, 'a pad profile is left out: ' + text,
                         'its pad drives with another profile, or not at all',
                         'fix the file named above, or calibrate the pad on the page Pad')
                 for text in facts.pad_errors])
    return found


def _fine_if_none(found: List[Finding], check: str, about: str, words: str) -> List[Finding]:
    """Return findings; without any, a FINE one with a text."""
    return found or [Finding(FINE, check, about, words)]


def _export(facts: Facts) -> str:
    """Return the command that sets the address under which other computers reach this one."""
    several = facts.several_computers()
    address = facts.computer.good_ip() if several else '127.0.0.1'
    if address is None:
        return 'connect this computer to the robots\' network, then: export ROS_IP=<its address>'
    return 'unset ROS_HOSTNAME; export ROS_IP={}   # in every terminal, and in ~/.bashrc; then ' \
        'start the programs again'.format(address)


def _variables(facts: Facts) -> List[Finding]:
    """Check ROS_MASTER_URI, ROS_IP and ROS_HOSTNAME."""
    computer = facts.computer
    found = []
    if not computer.variables.get('ROS_MASTER_URI'):
        found.append(Finding(
            WARNING, 'master_uri_unset', HOST, 'ROS_MASTER_URI is not set; {} is used'.format(
                facts.master.uri), 'each terminal may look for robots at another master',
            'export ROS_MASTER_URI={}'.format(_known_uri(facts))))
    host, variable = computer.own_host()
    if variable:
        problem = _address_problem(facts, host, variable)
        if problem:
            found.append(problem)
        found += _both(facts)
    else:
        found += _unset(facts)
    return _fine_if_none(found, 'variables', HOST, 'programs started here are known as {}{}'.format(
        host, ' (loopback: this computer alone)' if is_loopback(host) else ''))


def _known_uri(facts: Facts) -> str:
    """Return the URI of a master that responds, or a placeholder."""
    if facts.master.state == ANSWERS:
        return facts.master.uri
    return (facts.master.elsewhere or (
        'http://<address of the computer with the panel>:11311',))[0]


def _address_problem(facts: Facts, host: str, variable: str) -> Optional[Finding]:
    """Return the finding about the address that programs here advertise, or None."""
    computer = facts.computer
    odd = '://' in host or ':' in host or host != host.strip() or (
        variable == 'ROS_IP' and not is_ipv4(host))
    if odd:
        check, problem = 'address_bad', '{}={!r} is not an address: write it without http://, ' \
            'port and spaces{}'.format(variable, host,
                                       ', as four numbers' if variable == 'ROS_IP' else '')
    elif not computer.addresses_of(host):
        check, problem = 'address_unresolved', '{}={}, a name that this computer cannot ' \
            'resolve'.format(variable, host)
    elif not computer.is_own(host):
        check, problem = 'address_foreign', '{}={} is not an address of this computer (it has ' \
            '{})'.format(variable, host, listed(computer.addresses))
    elif facts.several_computers() and all(map(is_loopback, computer.addresses_of(host))):
        check, problem = 'address_loopback', '{}={} is loopback, but other computers take ' \
            'part'.format(variable, host)
    elif computer.route_ip and computer.route_ip not in computer.addresses_of(host):
        return Finding(
            WARNING, 'address_route', HOST, '{}={}, but the way to the master leaves from '
            '{}'.format(variable, host, computer.route_ip), _NO_DATA, _export(facts),
            'right only if robots can reach {} as well'.format(host))
    else:
        return None
    return Finding(FAULT, check, HOST, problem, _NO_DATA, _export(facts))


def _both(facts: Facts) -> List[Finding]:
    """Report ROS_HOSTNAME and ROS_IP if they contradict each other."""
    name, address = (facts.computer.variables.get(key) for key in ('ROS_HOSTNAME', 'ROS_IP'))
    if not (name and address) or name == address \
            or address in facts.computer.addresses_of(name):
        return []
    return [Finding(WARNING, 'address_both', HOST, 'ROS_HOSTNAME={} and ROS_IP={} say different '
                    'things; ROS_HOSTNAME counts'.format(name, address), _NO_DATA, _export(facts))]


def _unset(facts: Facts) -> List[Finding]:
    """Check the computer's name, which programs advertise if neither variable is set."""
    computer = facts.computer
    addresses = computer.addresses_of(computer.name)
    said = 'neither ROS_IP nor ROS_HOSTNAME is set, so programs here are known as "{}"'.format(
        computer.name)
    if not computer.is_own(computer.name):
        return [Finding(FAULT, 'address_unset', HOST, '{}, which {}'.format(
            said, 'is {}, not this computer'.format(listed(addresses)) if addresses else
            'this computer itself cannot resolve'), _NO_DATA, _export(facts))]
    if facts.several_computers():
        return [Finding(WARNING, 'address_unset', HOST, said + '; every robot must be able to '
                        'resolve that name', _NO_DATA, _export(facts))]
    return []


def _folders(computer: Computer) -> List[Finding]:
    """Check the folders that mhri writes to; two on one disk give one finding."""
    found: Dict[Tuple[str, str], Finding] = {}
    for folder in computer.folders:
        problem = _folder_problem(folder)
        if problem:
            found.setdefault((problem.check, folder.device or folder.path), problem)
    return _fine_if_none(list(found.values()), 'disk', HOST, 'free disk space: ' + listed(
        _free(folder) for folder in computer.folders))


def _free(folder: Folder) -> str:
    return '{:,.0f} MB free in {} ({})'.format(folder.free_bytes / MB, folder.path, folder.what)


def _folder_problem(folder: Folder) -> Optional[Finding]:
    """Return the finding about one folder, or None."""
    clean = 'rosclean check; rosclean purge   # removes old logs; move recordings (*.bag) away'
    if folder.problem:
        return Finding(
            FAULT, 'folder_unwritable', HOST, 'cannot write to {} ({}): {}'.format(
                folder.path, folder.what, folder.problem),
            'programs do not start, or recordings are refused',
            'sudo chown -R "$USER" {0}   # or: export {1}=<a folder of yours>'.format(
                folder.path, 'ROS_LOG_DIR' if folder.what == 'logs' else 'ROS_HOME'))
    if folder.free_bytes < FULL_BYTES:
        return Finding(FAULT, 'disk_full', HOST, 'only ' + _free(folder),
                       'recordings stop by themselves', clean)
    if folder.free_bytes < LOW_BYTES:
        return Finding(WARNING, 'disk_low', HOST, _free(folder), 'recordings warn', clean)
    return None


def _workspace(computer: Computer) -> List[Finding]:
    """Check that the workspace with mhri is sourced, and only that one."""
    if computer.package_path is None:
        return [Finding(
            FAULT, 'workspace_missing', HOST, 'mhri is not on ROS_PACKAGE_PATH ({})'.format(
                computer.variables.get('ROS_PACKAGE_PATH') or 'not set'),
            'roslaunch and rosrun do not find mhri or its launch files',
            'source <catkin workspace>/devel/setup.bash   # in every terminal, and in ~/.bashrc')]
    prefix = computer.package_path
    if prefix.endswith('/share/mhri'):
        prefix = prefix[:-len('/share/mhri')]
    if computer.python_paths and not any(
            path == prefix or path.startswith(prefix + '/') for path in computer.python_paths):
        return [Finding(
            WARNING, 'workspace_two', HOST, 'two mhri are mixed: Python uses {}, rosrun uses '
            '{}'.format(computer.python_paths[0], computer.package_path),
            'a change has no effect, or programs end with an ImportError',
            'open a new terminal and source one workspace only: source <catkin workspace>/devel/'
            'setup.bash')]
    return [Finding(FINE, 'workspace', HOST, 'mhri is used from {}'.format(computer.package_path))]


def _packages(computer: Computer) -> List[Finding]:
    """Check the dependencies of mhri."""
    missing = {name: problem for name, problem in computer.packages.items() if problem}
    return _fine_if_none([
        Finding(WARNING if name in SLOWER_WITHOUT else FAULT, 'package_missing', HOST,
                '{} is missing: {}'.format(name, problem),
                SLOWER_WITHOUT.get(name, 'parts of mhri do not start, or robots cannot be read'),
                'sudo apt install {}   # or: rosdep install mhri'.format(
                    package_of(name, computer)))
        for name, problem in sorted(missing.items())],
        'packages', HOST, 'all {} packages that mhri needs are here'.format(len(computer.packages)))


# Optional packages, and the effect of their absence.
SLOWER_WITHOUT = {'libturbojpeg': 'a jpeg picture takes longer, up to six times'}
# rosdep keys that are neither ROS packages nor names of system packages.
_SYSTEM = {'libturbojpeg': 'libturbojpeg0-dev'}


def package_of(name: str, computer: Computer) -> str:
    """Return the system package that contains a ROS package."""
    if name.startswith('python3-'):
        return name
    if name in _SYSTEM:
        return _SYSTEM[name]
    distro = computer.variables.get('ROS_DISTRO', 'noetic')
    return '{}-{}'.format('python3' if distro == 'Debian' else 'ros-' + distro,
                          name.replace('_', '-'))


def use_other(master: Master) -> str:
    """Return the commands that switch to other masters, one for each."""
    return '   # or: '.join('export ROS_MASTER_URI={}'.format(uri) for uri in master.elsewhere[:4])


_NOTHING = 'no robot is found, programs end with "unable to communicate with master"'


def find_on_master(facts: Facts) -> List[Finding]:
    """Return the findings about the master itself."""
    master, computer = facts.master, facts.computer
    if master.uri_problem:
        return [Finding(FAULT, 'master_uri_bad', MASTER, 'ROS_MASTER_URI={!r}: {}'.format(
            master.uri, master.uri_problem), _NOTHING,
            'export ROS_MASTER_URI={}'.format(_known_uri(facts)))]
    if master.state == ANSWERS:
        return [Finding(FINE, 'master', MASTER, 'answers at {} in {:.0f} ms, {} nodes'.format(
            master.uri, master.took_s * 1e3, len(facts.nodes)))]
    if master.elsewhere:
        return [Finding(FAULT, 'master_elsewhere', MASTER, 'none answers at {} ({}), but one does '
                        'at {}'.format(master.uri, master.detail or master.state,
                                       listed(master.elsewhere)), _NOTHING, use_other(master))]
    start = 'roslaunch mhri mhri.launch' if computer.is_own(master.host) else \
        'on {}: roslaunch mhri mhri.launch'.format(master.host)
    if master.state == STRANGER:
        return [Finding(FAULT, 'master_stranger', MASTER, 'something that is not a ROS master has '
                        '{}: {}'.format(master.uri, master.detail), _NOTHING,
                        'export ROS_MASTER_URI=http://{}:11311'.format(master.host))]
    if master.state == UNRESOLVED:
        return [Finding(FAULT, 'master_unresolved', MASTER, 'the name "{}" in ROS_MASTER_URI is '
                        'unknown here'.format(master.host), _NOTHING,
                        'export ROS_MASTER_URI=http://<IP address>:{}   # or: echo "<IP address> '
                        '{}" | sudo tee -a /etc/hosts'.format(master.port, master.host))]
    if master.state == REFUSED:
        return [Finding(FAULT, 'master_refused', MASTER, 'none runs at {}; the computer is '
                        'there'.format(master.uri), _NOTHING, start)]
    return [Finding(FAULT, 'master_silent', MASTER, 'no answer from {} ({})'.format(
        master.uri, master.detail), _NOTHING, 'ping -c 3 {}   # same network? switched on? then: '
        '{}'.format(master.host, start))]
