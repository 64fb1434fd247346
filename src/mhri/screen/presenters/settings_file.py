# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The file of the panel's settings, in plain JSON.

Not an INI file of ``QSettings``: PyQt unpickles Python objects from it, and so would run any code
planted in it.
"""
import errno
import json
import os
import shutil
import stat

from mhri.base.io.files import whole

UNUSABLE = '.unusable'
MAX_BYTES = 1_000_000


class SettingsError(Exception):
    """The file cannot be read or written; the text has its path and the reason."""


def default_path(simulated=False):
    """Return the user's own file (XDG base directories: ``~/.config/mhri/panel.json``).

    :param simulated: that of simulated runs, ``simulation.json``
    """
    config = os.environ.get('XDG_CONFIG_HOME') or os.path.expanduser('~/.config')
    return os.path.join(config, 'mhri', 'simulation.json' if simulated else 'panel.json')


def _no_number(word):
    raise ValueError('{} is not a JSON number'.format(word))


class SettingsFile:
    """The file; it is opened only on demand.

    :param path: None for :func:`default_path`
    :param simulated: as for :func:`default_path`
    """

    def __init__(self, path=None, simulated=False):
        self.path = path or default_path(simulated)

    def read(self):
        """Return the settings, {} if the file does not exist.

        :raises SettingsError: the file cannot be read as a JSON object
        """
        try:
            text = self._text()
            found = json.loads(text, parse_constant=_no_number) if text.strip() else {}
        # Too many nested brackets overflow the parser's stack; ValueError includes invalid UTF-8.
        except (OSError, ValueError, RecursionError) as error:
            raise SettingsError('{}: {}'.format(self.path, str(error)[:200]))
        if not isinstance(found, dict):
            raise SettingsError('{}: expected a dict'.format(self.path))
        return found

    def _text(self):
        """Return the text of the file, '' if it does not exist.

        :raises OSError: the file cannot be opened, or is not a regular file
        :raises ValueError: the file is too large, or not UTF-8
        """
        try:
            # O_NONBLOCK, because opening a pipe in its place would block.
            handle = os.open(self.path, os.O_RDONLY | os.O_NONBLOCK)
        except FileNotFoundError:
            return ''
        with os.fdopen(handle, 'rb') as stream:
            if not stat.S_ISREG(os.fstat(handle).st_mode):
                raise OSError(errno.EINVAL, 'it is not an ordinary file')
            data = stream.read(MAX_BYTES + 1)
        if len(data) > MAX_BYTES:
            raise ValueError('larger than {} bytes'.format(MAX_BYTES))
        return data.decode('utf-8')

    def keep_aside(self):
        """Back up the file before it is overwritten; return the copy's path, None on failure."""
        aside = self.path + UNUSABLE
        try:
            if not os.path.isfile(self.path):
                return None
            shutil.copyfile(self.path, aside)
        except OSError:
            return None
        return aside

    def write(self, settings):
        """Replace the file atomically.

        :raises SettingsError: the file cannot be written
        """
        try:
            text = json.dumps(settings, indent=1, allow_nan=False)
            with whole(self.path) as part, open(part, 'w', encoding='utf-8') as stream:
                stream.write(text + '\n')
        except (OSError, ValueError) as error:
            raise SettingsError('{}: not written, {}'.format(self.path, error))
