# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Loads the tasks: those of mhri, and those exported by a lab's packages.

Exported tasks are third-party code. One that cannot be imported, or is not a task, is left out with
an error.
"""
import importlib

from mhri.base.config import ConfigError
from mhri.graph.ros.resources import exported_tasks
from mhri.tasks.rows import with_exports


def task_kinds(rospack=None):
    """Load every task (blocking: reads packages and imports their modules).

    :param rospack: the packages to search, default ``rospkg.RosPack()``
    :returns: ({key: :class:`mhri.tasks.base.TaskKind`}, [ConfigError])
    """
    modules, broken = exported_tasks(rospack)
    rows, unread = [], []
    for package, name in modules:
        origin = 'package {}: {}'.format(package, name)
        try:
            rows.append((origin, importlib.import_module(name).ROW))
        except (Exception, SystemExit) as error:  # a lab's module may raise anything
            unread.append(ConfigError(origin, 'ROW', (
                'cannot be imported ({}: {}); has its package a setup.py and '
                'catkin_python_setup(), and is its workspace built and sourced?').format(
                    type(error).__name__, error)))
    kinds, errors = with_exports(rows)
    return kinds, broken + unread + errors
