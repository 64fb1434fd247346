# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The doctor examines its own computer: variables, addresses, folders, packages."""
import importlib.util
import os
import shutil
import socket
import threading
import time
import xml.etree.ElementTree

import netifaces
import rospkg

import mhri
from mhri.camera import turbojpeg
from mhri.doctor.facts import Computer, Folder, is_ipv4
from mhri.graph.ros.resources import package_path
from mhri.recording.recording import ros_home

# Debian packages of package.xml, and the Python module that each brings.
_MODULES = {'python3-evdev': 'evdev', 'python3-numpy': 'numpy', 'python3-opencv': 'cv2',
            'python3-pygame': 'pygame', 'python3-pyqtgraph': 'pyqtgraph', 'python3-yaml': 'yaml'}
_LIBRARIES = {'libturbojpeg': turbojpeg.load}
_PROGRAMS = ('openssl',)
# Optional: without rqt the panel has its own window; only a TurtleBot 2 runs nodelets.
_OPTIONAL = ('nodelet', 'rqt_gui', 'rqt_gui_py')


def own_addresses():
    """Return the IPv4 addresses of this computer's interfaces, read anew at each call."""
    found = []
    for interface in netifaces.interfaces():
        try:
            entries = netifaces.ifaddresses(interface).get(netifaces.AF_INET, ())
        except ValueError:  # the interface is gone by now
            continue
        found += [entry['addr'] for entry in entries if 'addr' in entry]
    return tuple(found)


def resolve(host):
    """Return the IPv4 addresses of a name (blocking, for long if no name server answers).

    :returns: a tuple, or None if the name is unknown
    """
    try:
        return tuple(sorted({entry[4][0] for entry in socket.getaddrinfo(
            host, None, socket.AF_INET, socket.SOCK_STREAM)}))
    except (OSError, UnicodeError):
        return None


def resolve_all(hosts, limit_s):
    """Return {name: addresses or None} of many names at once.

    A name without an answer within the limit counts as unknown: nobody can work with it.
    """
    answers, threads = {}, []
    for host in set(hosts):
        thread = threading.Thread(target=lambda name=host: answers.update({name: resolve(name)}),
                                  daemon=True)
        thread.start()
        threads.append(thread)
    deadline = time.monotonic() + limit_s
    for thread in threads:
        thread.join(max(0.0, deadline - time.monotonic()))
    return {host: answers.get(host) for host in set(hosts)}


def route_ip(address):
    """Return the local address from which packets to another one leave; None if there is no route.

    It sends nothing: connecting a UDP socket only looks at the routes.
    """
    try:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
            probe.connect((address, 9))
            return probe.getsockname()[0]
    except OSError:
        return None


def look_at_computer(environ, master_host, limit_s=1.0):
    """Return the :class:`Computer` this runs on (blocking for ``limit_s`` [s] at most)."""
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
    """Return the state of a folder or, if it is missing, of the nearest one above it."""
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
    """Return where ROS finds mhri, None if it does not."""
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
        module = _MODULES.get(name)
        if name in _LIBRARIES:
            found[name] = '' if _LIBRARIES[name]() else 'the library cannot be loaded'
        elif name in _PROGRAMS:
            found[name] = '' if shutil.which(name) else 'the program is not installed'
        elif module is not None:
            found[name] = '' if _has_module(module) else \
                'no Python module "{}"'.format(module)
        elif not name.startswith('python3-') and name not in _OPTIONAL:
            found[name] = '' if _has_package(finder, name) else 'no ROS package of that name'
    return found


def _has_package(finder, name):
    """Tell whether a ROS package is here; Debian splits some into parts without a package.xml."""
    try:
        finder.get_path(name)
        return True
    except rospkg.ResourceNotFound:
        return _has_module(name)


def _has_module(name):
    """Tell whether there is a Python module; an empty folder left behind is none."""
    spec = importlib.util.find_spec(name)
    return spec is not None and spec.origin is not None
