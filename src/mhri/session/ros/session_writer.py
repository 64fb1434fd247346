# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The thread that writes a session's bags, one after another."""
import os

from mhri.recording.folder import bag_name
from mhri.recording.ros.bag_file import BagFile, error_text
from mhri.recording.ros.bag_writer import BagWriter


class NewBag(list):
    """The first messages of a new bag; :meth:`SessionWriter.put` then begins the next bag."""


class SessionWriter(BagWriter):
    """Writes ``NNNN.bag`` files into a folder; a :class:`NewBag` begins the next one.

    :param folder: path of the session
    :param number: number of the first bag
    :raises OSError: the first bag cannot be created
    """

    def __init__(self, folder, number, limits, on_trouble):
        super().__init__(self._make(folder, number), limits, on_trouble)
        self._folder = folder
        self._number = number
        self._before = (0, 0)

    @staticmethod
    def _make(folder, number):
        return BagFile(os.path.join(folder, bag_name(number)))

    @property
    def written(self):
        """The contents of the bags so far: (messages, bytes)."""
        messages, size = self._before
        return messages + self.file.messages, size + self.file.size

    def _write(self, messages):
        if isinstance(messages, NewBag) and self.file.messages:
            try:
                self._begin_next()
            except OSError as error:
                self._fail(error_text(error))
                return False
        return super()._write(messages) if messages else True

    def _begin_next(self):
        """Close the current bag and begin the next one.

        :raises OSError: the next bag cannot be created
        """
        self._number += 1
        after = self._make(self._folder, self._number)
        done, size = self.written
        closing, self._before = self.file, (done, size)
        self.file = after
        closing.close()
