# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Where the shipped data files are, in the devel space and in the install space alike."""
import glob
import os

import rospkg

from mhri.core.config import ConfigError
from mhri.core.robot_types import load_robot_types


def resource_path(*parts):
    """Return the absolute path of a file below ``resource/``; it need not exist.

    :raises rospkg.ResourceNotFound: the workspace with mhri is not sourced
    """
    return os.path.join(rospkg.RosPack().get_path('mhri'), 'resource', *parts)


def read_text(path):
    """Return the UTF-8 text of a file.

    :raises OSError: it cannot be read
    :raises ConfigError: it is not UTF-8
    """
    try:
        with open(path, encoding='utf-8') as stream:
            return stream.read()
    except UnicodeDecodeError as error:
        raise ConfigError(path, '', 'is not UTF-8 text: {}'.format(error))


def read_resource(*parts):
    """Return the text of a file below ``resource/``.

    :raises OSError: it cannot be read
    """
    return read_text(resource_path(*parts))


def robot_types():
    """Load every template of ``resource/robots``.

    :returns: ({name: RobotType}, [ConfigError])
    """
    files = sorted(glob.glob(resource_path('robots', '*.yaml')))
    return load_robot_types([(path, read_text(path)) for path in files])


def profile_reader(beside):
    """Return a function from the name of a pad profile to (origin, text).

    A name is ``resource/pads/<name>.yaml``; something with a slash or ``.yaml`` is a path, relative
    ones seen from the folder of the file that names it.

    :param beside: the path of the file in which the names stand
    """
    def read(name):
        path = resource_path('pads', name + '.yaml')
        if os.sep in name or name.endswith('.yaml'):
            path = os.path.join(os.path.dirname(os.path.abspath(beside)), name)
        return path, read_text(path)
    return read
