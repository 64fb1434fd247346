# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The thread that writes a session's bags, one after the other."""
import os

from mhri.recording.folder import bag_name
from mhri.recording.ros.bag_file import BagFile, words_of
from mhri.recording.ros.bag_writer import BagWriter


class NewBag(list):
    """What :meth:`SessionWriter.put` takes to begin the next bag: the messages it begins with."""


class SessionWriter(BagWriter):
    """Writes into ``NNNN.bag`` of a folder; the next one when it is given a :class:`NewBag`.

    :param folder: path of the session
    :param number: of the first bag
    :raises OSError: the first bag cannot be made
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
        """How much is in the bags: (messages, bytes)."""
        messages, size = self._before
        return messages + self.file.messages, size + self.file.size

    def _write(self, messages):
        if isinstance(messages, NewBag) and self.file.messages:
            try:
                self._begin_next()
            except OSError as error:
                self._fail(words_of(error))
                return False
        return super()._write(messages) if messages else True

    def _begin_next(self):
        """Close this bag and make the next one.

        :raises OSError: the disk has no room for it
        """
        self._number += 1
        after = self._make(self._folder, self._number)
        done, size = self.written
        closing, self._before = self.file, (done, size)
        self.file = after
        closing.close()
