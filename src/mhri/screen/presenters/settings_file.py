# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The file that keeps the panel's settings: plain JSON.

PyQt unpickles Python objects from an INI file of ``QSettings``, and so runs code that somebody
wrote into it.
"""
import errno
import json
import os
import shutil
import stat

UNUSABLE = '.unusable'
MOST_BYTES = 1_000_000


class SettingsError(Exception):
    """The file is unusable; the text names it, the reason and the place of the copy."""


def default_path():
    """Return the user's own file (XDG base directories: ``~/.config/mhri/panel.json``)."""
    config = os.environ.get('XDG_CONFIG_HOME') or os.path.expanduser('~/.config')
    return os.path.join(config, 'mhri', 'panel.json')


def _no_number(word):
    raise ValueError('{} is not a JSON number'.format(word))


class SettingsFile:
    """One file; opened only on demand.

    :param path: None for :func:`default_path`
    """

    def __init__(self, path=None):
        self.path = path or default_path()

    def read(self):
        """Return what the file says, {} if there is none.

        :raises SettingsError: it cannot be read as a dict of JSON
        """
        try:
            text = self._text()
            found = json.loads(text, parse_constant=_no_number) if text.strip() else {}
        # Too many nested brackets break the parser, and not every text is UTF-8.
        except (OSError, ValueError, RecursionError) as error:
            raise SettingsError('{}: {}'.format(self.path, str(error)[:200]))
        if not isinstance(found, dict):
            raise SettingsError('{}: expected a dict'.format(self.path))
        return found

    def _text(self):
        """Return the text of the file, '' if there is none.

        :raises OSError: it cannot be opened, or is not an ordinary file
        :raises ValueError: it is too large, or not text
        """
        try:
            # Opening a pipe in its place would block.
            handle = os.open(self.path, os.O_RDONLY | os.O_NONBLOCK)
        except FileNotFoundError:
            return ''
        with os.fdopen(handle, 'rb') as stream:
            if not stat.S_ISREG(os.fstat(handle).st_mode):
                raise OSError(errno.EINVAL, 'it is not an ordinary file')
            data = stream.read(MOST_BYTES + 1)
        if len(data) > MOST_BYTES:
            raise ValueError('larger than {} bytes'.format(MOST_BYTES))
        return data.decode('utf-8')

    def keep_aside(self):
        """Copy the file beside itself before it is overwritten; return the copy's path or None."""
        aside = self.path + UNUSABLE
        try:
            if not os.path.isfile(self.path):
                return None
            shutil.copyfile(self.path, aside)
        except OSError:
            return None
        return aside

    def write(self, settings):
        """Replace the file completely or not at all.

        :raises SettingsError: it cannot be written
        """
        part = '{}.{}.part'.format(self.path, os.getpid())
        try:
            text = json.dumps(settings, indent=1, allow_nan=False)
            os.makedirs(os.path.dirname(os.path.abspath(self.path)), exist_ok=True)
            with open(part, 'w', encoding='utf-8') as stream:
                stream.write(text + '\n')
            os.replace(part, self.path)
        except (OSError, ValueError) as error:
            if os.path.exists(part):
                os.unlink(part)
            raise SettingsError('{}: not written, {}'.format(self.path, error))
