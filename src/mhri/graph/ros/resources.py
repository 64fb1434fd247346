# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Finds the shipped data files, in the devel space and in the install space alike."""
from dataclasses import replace
import functools
import glob
import os
import stat

import rospkg

from mhri.base.config import ConfigError, MAX_BYTES, too_large
from mhri.base.robot_types import Export, load_robot_types

# The element of a package.xml that exports a robot type or a task, and its attributes.
EXPORT_TAG = 'mhri'
TYPE_ATTRIBUTE, WINDOW_ATTRIBUTE, TASK_ATTRIBUTE = 'robot_type', 'window', 'task'


def package_path():
    """Return the folder of mhri's package.xml, as ROS finds it.

    :raises rospkg.ResourceNotFound: the workspace with mhri is not sourced
    """
    return _found(tuple(rospkg.get_ros_paths()))


# Each search reads every package.xml.
@functools.lru_cache(maxsize=None)
def _found(ros_paths):
    return rospkg.RosPack(list(ros_paths)).get_path('mhri')


def resource_path(*parts):
    """Return the absolute path of a file below ``resource/``; it need not exist.

    :raises rospkg.ResourceNotFound: the workspace with mhri is not sourced
    """
    return os.path.join(package_path(), 'resource', *parts)


def read_text(path):
    """Return the UTF-8 text of a configuration file.

    :raises OSError: the file cannot be read
    :raises ConfigError: it is not UTF-8, or too large, or a pipe or device, which might never end
    """
    mode = os.stat(path).st_mode
    if not (stat.S_ISREG(mode) or stat.S_ISDIR(mode)):
        raise ConfigError(path, '', 'is not a regular file')
    with open(path, 'rb') as stream:
        data = stream.read(MAX_BYTES + 1)
    if len(data) > MAX_BYTES:
        raise too_large(path)
    try:
        return data.decode('utf-8')
    except UnicodeDecodeError as error:
        raise ConfigError(path, '', 'is not UTF-8 text: {}'.format(error))


def read_resource(*parts):
    """Return the text of a file below ``resource/``.

    :raises OSError: the file cannot be read
    """
    return read_text(resource_path(*parts))


def read_all(*folders):
    """Read the ``*.yaml`` files of folders, sorted by name in each.

    :returns: ([(path, text)], [ConfigError] of the unreadable files)
    """
    files, errors = [], []
    for path in (path for folder in folders
                 for path in sorted(glob.glob(os.path.join(folder, '*.yaml')))):
        try:
            files.append((path, read_text(path)))
        except OSError as error:
            errors.append(ConfigError(path, '', 'cannot be read: {}'.format(error.strerror)))
        except ConfigError as error:
            errors.append(error)
    return files, errors


def robot_types():
    """Load every template in ``resource/robots``, and those exported by other packages.

    A package exports a template in its package.xml, like an rqt plugin (``window``, the class of
    its window, is optional)::

        <export>
          <mhri robot_type="${prefix}/resource/crawler.yaml" window="crawler_robot.window.Crawler"/>
        </export>

    :returns: ({name: RobotType}, [ConfigError])
    """
    files, unread = read_all(resource_path('robots'))
    exports, broken = exported_types()
    types, errors = load_robot_types(files, exports)
    return types, unread + errors + broken


def exported_types(rospack=None):
    """Read the robot types that packages export.

    :param rospack: where to look for packages, default ``rospkg.RosPack()``
    :returns: ([:class:`Export`], [ConfigError]), in the order of the packages' names
    """
    exports, errors = [], []
    for package, manifest, attributes in _elements(rospack, errors):
        if TASK_ATTRIBUTE in attributes:
            continue
        try:
            exports.append(_read_export(package, manifest, attributes))
        except ConfigError as error:
            errors.append(error)
    return exports, errors


def exported_tasks(rospack=None):
    """Return the modules of tasks that packages export.

    A package exports a task in its package.xml; the module has the task's row as ``ROW``::

        <export>
          <mhri task="lab_tasks.look_around"/>
        </export>

    :param rospack: where to look for packages, default ``rospkg.RosPack()``
    :returns: ([(package, module)], [ConfigError]), in the order of the packages' names
    """
    modules, errors = [], []
    for package, manifest, attributes in _elements(rospack, []):
        if TASK_ATTRIBUTE not in attributes:
            continue
        if set(attributes) == {TASK_ATTRIBUTE} and attributes[TASK_ATTRIBUTE].strip():
            modules.append((package, attributes[TASK_ATTRIBUTE].strip()))
        else:
            errors.append(Export(package, manifest, '').error('<{}>'.format(EXPORT_TAG), (
                'a task is exported by itself; write <{} {}="package.module"/>').format(
                    EXPORT_TAG, TASK_ATTRIBUTE)))
    return modules, errors


def _elements(rospack, errors):
    """Yield (package, manifest, attributes) of each export for mhri."""
    rospack = rospack or rospkg.RosPack()
    for package in sorted(rospack.list()):
        manifest = os.path.join(rospack.get_path(package), 'package.xml')
        for attributes in _exports_of(package, manifest, errors):
            yield package, manifest, attributes


def _exports_of(package, manifest, errors):
    """Return the attributes of each export of one package; most have none and are not parsed."""
    try:
        with open(manifest, 'rb') as stream:
            if b'<' + EXPORT_TAG.encode('ascii') not in stream.read():
                return []
    except OSError:
        # A rosbuild package without a package.xml, or a package deleted meanwhile.
        return []
    # Slow to import: most computers have no such package.
    from catkin_pkg.package import InvalidPackage, parse_package
    try:
        return [export.attributes for export in parse_package(manifest, warnings=[]).exports
                if export.tagname == EXPORT_TAG]
    except OSError:
        return []  # deleted meanwhile
    except InvalidPackage as error:
        errors.append(Export(package, manifest, '').error('', 'cannot be understood: {}'.format(
            ' '.join(str(error).split()))))
        return []


def _read_export(package, manifest, attributes):
    """Return the :class:`Export` of one element of a package.xml.

    :raises ConfigError: an attribute is missing or unknown, or the template is unreadable
    """
    element = Export(package, manifest, '')
    odd = sorted(set(attributes) - {TYPE_ATTRIBUTE, WINDOW_ATTRIBUTE})
    if odd or not attributes.get(TYPE_ATTRIBUTE):
        raise element.error('<{}>'.format(EXPORT_TAG), '{}; write <{} {}="${{prefix}}/...yaml"/>, '
                            'and {}="package.module.Class" if it has one'.format(
                                'unknown attribute ' + odd[0] if odd else 'names no template',
                                EXPORT_TAG, TYPE_ATTRIBUTE, WINDOW_ATTRIBUTE))
    folder = os.path.dirname(manifest)
    path = os.path.join(folder, attributes[TYPE_ATTRIBUTE].replace('${prefix}', folder))
    export = Export(package, path, '', attributes.get(WINDOW_ATTRIBUTE, ''))
    try:
        return replace(export, text=read_text(path))
    except OSError as error:
        raise export.error('', 'cannot be read ({}), though {} exports it; an installed package '
                           'has to install it, too'.format(error.strerror, manifest))
    except ConfigError as error:
        raise export.error('', error.problem)
