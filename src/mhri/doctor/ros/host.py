# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Examines this computer: variables, addresses, folders, packages."""
import importlib.util
import os
import shutil
import socket
import time
import xml.etree.ElementTree

import rospkg

import mhri
from mhri.camera import turbojpeg
from mhri.doctor.facts import Computer, Folder, is_ipv4
from mhri.graph.ros.addresses import own_addresses
from mhri.graph.ros.parallel_calls import Answers
from mhri.graph.ros.resources import package_path
from mhri.recording.recording import ros_home

# Names of system packages begin so; the rest is the name of the module, but for these.
_PYTHON = 'python3-'
_MODULES = {'python3-opencv': 'cv2'}
_LIBRARIES = {'libturbojpeg': turbojpeg.load}
_PROGRAMS = ('openssl',)
# Optional: without rqt the panel has its own window; only a TurtleBot 2 needs nodelets.
_OPTIONAL = ('nodelet', 'rqt_gui', 'rqt_gui_py')


def resolve(host):
    """Return the IPv4 addresses of a name (blocking, long if no name server responds).

    :returns: a tuple, or None if the name is unknown
    """
    try:
        return tuple(sorted({entry[4][0] for entry in socket.getaddrinfo(
            host, None, socket.AF_INET, socket.SOCK_STREAM)}))
    except (OSError, UnicodeError):
        return None


def resolve_all(hosts, limit_s):
    """Return {name: addresses or None} of many names at once.

    A name without a response within the limit counts as unknown.
    """
    answers = Answers()
    for host in set(hosts):
        answers.ask(host, resolve, host)
    found = answers.by(time.monotonic() + limit_s)
    return {host: found.get(host) for host in set(hosts)}


def route_ip(address):
    """Return the local address of packets to another address; None without a route.

    Nothing is sent: connecting a UDP socket only looks up the route.
    """
    try:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
            probe.connect((address, 9))
            return probe.getsockname()[0]
    except OSError:
        return None


def look_at_computer(environ, master_host, limit_s=1.0):
    """Return the :class:`Computer` of this program (blocking for at most ``limit_s``)."""
    variables = {key: value for key, value in environ.items() if key.startswith('ROS_')}
    name = socket.gethostname()
    hosts = [name, variables.get('ROS_HOSTNAME'), variables.get('ROS_IP'), master_host]
    resolved = resolve_all([host for host in hosts if host and not is_ipv4(host)], limit_s)
    addresses = own_addresses()
    master = (master_host,) if is_ipv4(master_host) else resolved.get(master_host) or ()
    away = bool(master) and not any(address in addresses or address.startswith('127.')
                                    for address in master)
    package_path = _package_path()
    return Computer(
        name=name, variables=variables, addresses=addresses, resolved=resolved,
        route_ip=route_ip(master[0]) if away else None, folders=_folders(environ),
        package_path=package_path,
        python_paths=tuple(os.path.realpath(path) for path in mhri.__path__)[::-1],
        packages=_packages(package_path))


def _folders(environ):
    """Return the folders of recordings and logs."""
    home = ros_home(environ)
    logs = environ.get('ROS_LOG_DIR') or os.path.join(home, 'log')
    return (_folder('recordings', home), _folder('logs', logs))


def _folder(what, path):
    """Return the state of a folder or, if missing, of its nearest existing parent."""
    place = path = os.path.abspath(os.path.expanduser(path))
    while not os.path.exists(place) and place != os.path.dirname(place):
        place = os.path.dirname(place)
    try:
        if not os.path.isdir(place):
            return Folder(what, path, problem='{} is a file'.format(place))
        if not os.access(place, os.W_OK | os.X_OK):
            return Folder(what, path, problem='no permission')
        status = os.statvfs(place)
        if status.f_flag & os.ST_RDONLY:
            return Folder(what, path, problem='the disk is read-only')
        return Folder(what, path, status.f_bavail * status.f_frsize,
                      device=str(os.stat(place).st_dev))
    except OSError as error:
        return Folder(what, path, problem=error.strerror or str(error))


def _package_path():
    """Return the path at which ROS finds mhri, None if not found."""
    try:
        return os.path.realpath(package_path())
    except rospkg.ResourceNotFound:
        return None


def _packages(package_path):
    """Return {run-time dependency of package.xml: why it is unusable, '' if it is usable}."""
    if package_path is None:
        return {}
    root = xml.etree.ElementTree.parse(os.path.join(package_path, 'package.xml')).getroot()
    finder = rospkg.RosPack()
    found = {}
    for name in sorted({(entry.text or '').strip() for entry in root
                        if entry.tag in ('exec_depend', 'depend')}):
        if name in _LIBRARIES:
            found[name] = '' if _LIBRARIES[name]() else 'the library cannot be loaded'
        elif name in _PROGRAMS:
            found[name] = '' if shutil.which(name) else 'the program is not installed'
        elif name.startswith(_PYTHON):
            module = _MODULES.get(name, name[len(_PYTHON):].replace('-', '_'))
            found[name] = '' if _has_module(module) else \
                'no Python module "{}"'.format(module)
        elif name not in _OPTIONAL:
            found[name] = '' if _has_package(finder, name) else 'no ROS package of that name'
    return found


def _has_package(finder, name):
    """Return whether a ROS package is installed; Debian splits some without a package.xml."""
    try:
        finder.get_path(name)
        return True
    except rospkg.ResourceNotFound:
        return _has_module(name)


def _has_module(name):
    """Return whether a Python module is installed; an empty folder does not count."""
    spec = importlib.util.find_spec(name)
    return spec is not None and spec.origin is not None
