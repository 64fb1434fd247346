# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Reads serialised ROS messages field by field in place, without copies.

They are little-endian, with lengths before texts and arrays (http://wiki.ros.org/msg). genpy builds
everything that a message announces before it can be refused, and blocks all other threads
meanwhile: 0.13 s for each megabyte of a name that is not text, 0.4 s for a false number of fields
in 10 MB.
"""
import functools
import struct
from typing import Any, Tuple, Type, Union

#: a serialised message or a part of it
Data = Union[bytes, bytearray, memoryview]
_LONGEST_NAME = 4096
_struct = functools.lru_cache(100)(struct.Struct)


class Wire:
    """Reads the fields of a serialised message in order.

    ``at`` is the offset of the next field.

    :param what: name of the message, for the error's text
    :param error: exception raised if the message ends early
    """

    def __init__(self, what: str, data: Data, error: Type[ValueError] = ValueError) -> None:
        self._what = what
        self._error = error
        self._data = memoryview(data)
        self.at = 0

    def numbers(self, form: str) -> Tuple[Any, ...]:
        """Return the tuple of a struct format."""
        try:
            found = _struct(form)
            values = found.unpack_from(self._data, self.at)
        except struct.error:
            raise self._error('{}: truncated message of {} bytes'.format(
                self._what, len(self._data)))
        self.at += found.size
        return values

    def header(self) -> Tuple[int, float]:
        """Return (sequence number, stamp [s]) of a header; the name of its frame follows."""
        number, seconds, nanoseconds = self.numbers('<III')
        return number, seconds + 1e-9 * nanoseconds

    def array(self) -> memoryview:
        """Return a uint8[] as a view."""
        (length,) = self.numbers('<I')
        data = self._data[self.at:self.at + length]
        if len(data) < length:
            raise self._error('{}: truncated, {} of {} bytes'.format(
                self._what, len(data), length))
        self.at += length
        return data

    def text(self) -> str:
        """Return a string; invalid UTF-8 becomes U+FFFD."""
        value = self.array()
        if len(value) > _LONGEST_NAME:
            raise self._error('{}: corrupted, a name of {} bytes'.format(self._what, len(value)))
        return bytes(value).decode('utf-8', 'replace')
