# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The folder of a session on the disk: made, added to, never overwritten."""
import os
import threading
import time

from mhri.recording.folder import (
    event_line, EVENTS_JSONL, folder_name, info_text, next_bag, SESSION_YAML, STILLS)
from mhri.recording.recording import ACTIVE, PathRefused, system_folder
from mhri.recording.ros.bag_file import words_of

# A recording that was killed longer ago is not gone on with [s].
GOES_ON_S = 120.0


class SessionFolder:
    """A folder with its events; bags are written by others.

    :param path: of a folder that exists
    """

    def __init__(self, path):
        self.path = path
        self._lock = threading.Lock()
        self._events = open(os.path.join(path, EVENTS_JSONL), 'a', encoding='utf-8')

    @classmethod
    def make(cls, home, when, info):
        """Make the folder of a session that begins now.

        :param home: path of the folder of all sessions, made if missing
        :param when: a :class:`datetime.datetime` in local time
        :param info: :class:`mhri.recording.folder.SessionInfo`
        :raises PathRefused: files do not go there; the text says why
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
            raise PathRefused('cannot write to {}: {}'.format(home, words_of(error)))

    @staticmethod
    def _make(home, when):
        while True:
            path = os.path.join(home, folder_name(when, os.listdir(home)))
            try:
                os.mkdir(path)
                return path
            except FileExistsError:
                continue

    @classmethod
    def go_on(cls, path):
        """Return the folder of a recording that was killed a moment ago, else None."""
        try:
            active = [os.path.join(path, name) for name in os.listdir(path)
                      if name.endswith(ACTIVE)]
            newest = max(map(os.path.getmtime, active), default=0.0)
            return cls(path) if abs(time.time() - newest) < GOES_ON_S else None
        except OSError:
            return None

    def next_bag(self):
        """Return the number of the bag to begin."""
        return next_bag(os.listdir(self.path))

    def tell(self, event):
        """Write a :class:`mhri.recording.folder.SessionEvent`; it is kept on return.

        :raises OSError: it cannot be written
        """
        with self._lock:
            if not self._events.closed:
                self._events.write(event_line(event))
                self._events.flush()

    def end_line(self):
        """End a line that a killed program has left half; nothing where it left none.

        :raises OSError: it cannot be read or written
        """
        with self._lock, open(self._events.name, 'rb') as file:
            size = file.seek(0, os.SEEK_END)
            file.seek(max(0, size - 1))
            if file.read(1) not in (b'', b'\n'):
                self._events.write('\n')
                self._events.flush()

    def keep(self, name, data):
        """Write a file of the folder, e.g. a still.

        :raises OSError: it cannot be written, or exists
        """
        with open(os.path.join(self.path, name), 'xb') as file:
            file.write(data)

    def close(self):
        """Close the events."""
        with self._lock:
            try:
                self._events.close()
            except OSError:
                pass  # a full disk has no room for the last line: tell() has said so
