# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Makes the windows of robots, of classes from a lab's own packages as well.

Such a class is somebody else's program inside the one that drives robots. Where it cannot be
imported, made or drawn, the robot gets the standard window, and a sentence says why.
"""
import importlib
import logging
import sys

from mhri.screen.gui.bot_window import BotWindow
from mhri.screen.gui.windows import STANDARD, window_class

_LOG = logging.getLogger(__name__)
_TOLD = set()
_MOST_TOLD = 100


def log_slips(kind, value, trace):
    """Log an exception that nobody caught.

    PyQt ends the program at an exception in a slot or an event handler, unless there is an
    ``excepthook`` (https://www.riverbankcomputing.com/static/Docs/PyQt5/incompatibilities.html).
    One that comes again, as with each painting, is logged once.
    """
    words = (kind, str(value))
    if words in _TOLD or len(_TOLD) >= _MOST_TOLD:
        return
    _TOLD.add(words)
    _LOG.error('a slip in a window: %s: %s', kind.__name__, value, exc_info=(kind, value, trace))


def import_window(key):
    """Return the class that a key names as ``package.module.Class``.

    :raises ImportError: it cannot be had, or is no window of a robot; the text says why and what
        mends it
    """
    module, _, name = key.rpartition('.')
    try:
        found = getattr(importlib.import_module(module), name)
    except KeyboardInterrupt:
        raise
    except BaseException as error:  # the guard of this boundary: a module may even exit
        raise ImportError('{} cannot be imported ({}: {}); has its package a setup.py and '
                          'catkin_python_setup(), and is its workspace built and sourced?'.format(
                              key, type(error).__name__, error))
    if not (isinstance(found, type) and issubclass(found, BotWindow)):
        raise ImportError('{} is no subclass of mhri.screen.gui.bot_window.BotWindow; '
                          'make it one'.format(key))
    return found


class WindowMaker:
    """Knows the classes of windows, and which of them have failed."""

    def __init__(self):
        self._classes = {}
        self._failed = {}

    def make(self, key, *args):
        """Return (window, '') or (standard window, why not the wanted one).

        :param key: ``window`` of the robot's type
        :param args: those of :class:`mhri.screen.gui.bot_window.BotWindow`
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
            except BaseException as error:  # the guard of this boundary: see the head of this file
                self.distrust(key, '{} cannot be opened ({}: {}); mend it and start mhri again'
                              .format(key, type(error).__name__, error))
        return window_class(STANDARD)(*args), '{}; the standard window is shown instead'.format(
            self._failed[key])

    def distrust(self, key, reason):
        """Make standard windows in place of this one from now on; one sentence says why."""
        self._failed[key] = reason
        _LOG.warning('%s', reason, exc_info=sys.exc_info()[0] is not None)

    def trusts(self, key):
        """Tell whether a window of this key is somebody else's that has not failed yet."""
        return '.' in key and key not in self._failed

    def _class(self, key):
        if key not in self._classes:
            self._classes[key] = import_window(key)
            if sys.excepthook is sys.__excepthook__:
                sys.excepthook = log_slips
        return self._classes[key]
