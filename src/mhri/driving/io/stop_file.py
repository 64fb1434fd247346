# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A persistent stop-all: a file that exists while it is in force."""
import os

from mhri.base.io.files import text_in, whole

_MAX_BYTES = 10000


class StopFile:
    """``$ROS_HOME/mhri/stop``: one line for each master whose robots are stopped.

    :param path: path of the file
    :param master: the URI of the master
    """

    def __init__(self, path, master):
        self._path = path
        self._master = master

    def _masters(self):
        """Return the masters in the file, as a set.

        :raises OSError: the file cannot be read
        """
        text = text_in(self._path, _MAX_BYTES)
        # A file too large to read stops this master, too: in doubt, stop.
        return {self._master} if text is None else set(filter(None, text.splitlines()))

    def stopped(self):
        """Return whether a stop was in force when the previous drive ended.

        :raises OSError: the file exists and cannot be read
        """
        return self._master in self._masters()

    def keep(self, stopped):
        """Store whether a stop is in force; without any, the file is removed.

        :raises OSError: the file cannot be written
        """
        before = self._masters()
        after = before | {self._master} if stopped else before - {self._master}
        if after == before:
            return
        if not after:
            os.remove(self._path)
            return
        with whole(self._path) as part, open(part, 'w', encoding='utf-8') as stream:
            stream.write('\n'.join(sorted(after)) + '\n')
            stream.flush()
            os.fsync(stream.fileno())
