# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Creates the tiles of robots, including classes from a lab's own packages.

Such a class is foreign code inside the program that drives robots. If it cannot be imported,
created or drawn, the robot gets the standard tile, and a sentence gives the reason.
"""
import importlib
import logging
import sys

from mhri.screen.gui.robot_tile import RobotTile
from mhri.screen.gui.windows import STANDARD, window_class

_LOG = logging.getLogger(__name__)
_TOLD = set()
_MAX_TOLD = 100


def log_slips(kind, value, trace):
    """Log an uncaught exception.

    PyQt ends the program at an exception in a slot or an event handler, unless there is an
    ``excepthook`` (https://www.riverbankcomputing.com/static/Docs/PyQt5/incompatibilities.html).
    A repeated exception, such as on each painting, is logged once.
    """
    words = (kind, str(value))
    if words in _TOLD or len(_TOLD) >= _MAX_TOLD:
        return
    _TOLD.add(words)
    _LOG.error('error in a tile: %s: %s', kind.__name__, value, exc_info=(kind, value, trace))


def import_window(key):
    """Return the class of a key of the form ``package.module.Class``.

    :raises ImportError: the class cannot be imported, or is not a tile; the text has the reason
        and the remedy
    """
    module, _, name = key.rpartition('.')
    try:
        found = getattr(importlib.import_module(module), name)
    except KeyboardInterrupt:
        raise
    except BaseException as error:  # foreign code: a module may even exit
        raise ImportError('{} cannot be imported ({}: {}); has its package a setup.py and '
                          'catkin_python_setup(), and is its workspace built and sourced?'.format(
                              key, type(error).__name__, error))
    if not (isinstance(found, type) and issubclass(found, RobotTile)):
        raise ImportError('{} is not a subclass of mhri.screen.gui.robot_tile.RobotTile; '
                          'make it one'.format(key))
    return found


class WindowMaker:
    """Loads the classes of tiles, and keeps track of the failed ones."""

    def __init__(self):
        self._classes = {}
        self._failed = {}

    def make(self, key, *args):
        """Return (tile, '') or (standard tile, reason).

        :param key: ``window`` of the robot's type
        :param args: arguments of :class:`mhri.screen.gui.robot_tile.RobotTile`
        """
        if '.' not in key:
            return window_class(key)(*args), ''
        if key not in self._failed:
            try:
                return self._class(key)(*args), ''
            except ImportError as error:
                self.distrust(key, str(error))
            except KeyboardInterrupt:
                raise
            except BaseException as error:  # foreign code: see the docstring of this module
                self.distrust(key, '{} cannot be opened ({}: {}); fix it and start mhri again'
                              .format(key, type(error).__name__, error))
        return window_class(STANDARD)(*args), '{}; the standard window is shown instead'.format(
            self._failed[key])

    def distrust(self, key, reason):
        """Replace a class by the standard tile from now on, and log the reason."""
        self._failed[key] = reason
        _LOG.warning('%s', reason, exc_info=sys.exc_info()[0] is not None)

    def trusts(self, key):
        """Return whether a key is a lab's own class that has not failed yet."""
        return '.' in key and key not in self._failed

    def _class(self, key):
        if key not in self._classes:
            self._classes[key] = import_window(key)
            if sys.excepthook is sys.__excepthook__:
                sys.excepthook = log_slips
        return self._classes[key]
