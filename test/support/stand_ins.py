# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Packages of a robot that stand in for real ones, also where the real ones are installed."""
import os


def workspace(folder, *sources):
    """Make a catkin workspace of folders with packages; return the environment that puts it first.

    ``ROS_PACKAGE_PATH`` alone is not enough: roslaunch looks for a node's executable in the
    workspaces of ``CMAKE_PREFIX_PATH`` before that, so an installed package would win.

    :param folder: a folder that exists, for catkin's marker
    :param sources: folders with packages, the first one first
    """
    sources = [str(source) for source in sources]
    (folder / '.catkin').write_text(';'.join(sources))
    return {'CMAKE_PREFIX_PATH': before(str(folder), 'CMAKE_PREFIX_PATH'),
            'ROS_PACKAGE_PATH': before(':'.join(sources), 'ROS_PACKAGE_PATH')}


def before(path, variable):
    """Return a path variable of the environment with something in front."""
    return ':'.join(part for part in (path, os.environ.get(variable, '')) if part)
