# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The folder of a session on the disk: created and appended to, never overwritten."""
from contextlib import suppress
import os
import threading
import time

from mhri.recording.folder import (
    event_line, EVENTS_JSONL, folder_name, free_names, info_text, next_bag, SESSION_YAML, STILLS)
from mhri.recording.recording import ACTIVE, PathRefused, system_folder
from mhri.recording.ros.bag_file import error_text

# A killed recording is continued only within this time [s].
GOES_ON_S = 120.0


class SessionFolder:
    """The folder and its event log; a session writer adds the bags.

    :param path: path of an existing folder
    """

    def __init__(self, path):
        self.path = path
        self._lock = threading.Lock()
        self._events = open(os.path.join(path, EVENTS_JSONL), 'a', encoding='utf-8')

    @classmethod
    def make(cls, home, when, info):
        """Create the folder of a new session.

        :param home: path of the folder of all sessions, created if missing
        :param when: a :class:`datetime.datetime` in local time
        :param info: :class:`mhri.recording.folder.SessionInfo`
        :raises PathRefused: the folder cannot be written; the text gives the reason
        """
        try:
            top = system_folder(os.path.realpath(home))
            if top:
                raise PathRefused('{} belongs to the system'.format(top))
            os.makedirs(home, exist_ok=True)
            path = cls._make(home, when)
            os.mkdir(os.path.join(path, STILLS))
            with open(os.path.join(path, SESSION_YAML), 'x', encoding='utf-8') as file:
                file.write(info_text(info))
            return cls(path)
        except (OSError, ValueError) as error:
            raise PathRefused('cannot write to {}: {}'.format(home, error_text(error)))

    @staticmethod
    def _make(home, when):
        for name in free_names(folder_name(when)):
            with suppress(FileExistsError):
                os.mkdir(os.path.join(home, name))
                return os.path.join(home, name)

    @classmethod
    def go_on(cls, path):
        """Return the folder of a recording killed at most :data:`GOES_ON_S` ago, else None."""
        try:
            active = [os.path.join(path, name) for name in os.listdir(path)
                      if name.endswith(ACTIVE)]
            newest = max(map(os.path.getmtime, active), default=0.0)
            return cls(path) if abs(time.time() - newest) < GOES_ON_S else None
        except OSError:
            return None

    def next_bag(self):
        """Return the number of the next bag."""
        return next_bag(os.listdir(self.path))

    def append(self, event):
        """Write and flush a :class:`mhri.recording.folder.SessionEvent`.

        :raises OSError: the event cannot be written
        """
        with self._lock:
            if not self._events.closed:
                self._events.write(event_line(event))
                self._events.flush()

    def end_line(self):
        """Terminate the last line if a killed program left it incomplete.

        :raises OSError: the log cannot be read or written
        """
        with self._lock, open(self._events.name, 'rb') as file:
            size = file.seek(0, os.SEEK_END)
            file.seek(max(0, size - 1))
            if file.read(1) not in (b'', b'\n'):
                self._events.write('\n')
                self._events.flush()

    def keep(self, name, data):
        """Write a new file into the folder, e.g. a still.

        :raises OSError: the file exists or cannot be written
        """
        with open(os.path.join(self.path, name), 'xb') as file:
            file.write(data)

    def close(self):
        """Close the event log."""
        with self._lock:
            try:
                self._events.close()
            except OSError:
                pass  # a full disk has no room for the last line: append() has reported it
