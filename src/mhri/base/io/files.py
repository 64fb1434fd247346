# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Atomic writing of files, and reading up to a maximum size."""
from contextlib import contextmanager
import math
import os


@contextmanager
def whole(path):
    """Yield a temporary path that is renamed to ``path`` at the end, and removed after a failure.

    The folder is created if missing; the temporary path has the same suffix.

    :raises OSError: the file cannot be written
    """
    root, ending = os.path.splitext(path)
    part = '{}.{}.part{}'.format(root, os.getpid(), ending)
    os.makedirs(os.path.dirname(os.path.abspath(path)), exist_ok=True)
    try:
        yield part
        os.replace(part, path)
    finally:
        if os.path.exists(part):
            os.remove(part)


def text_in(path, most_bytes=math.inf):
    """Return the text of a file, with U+FFFD for invalid UTF-8; '' if it is not a regular file.

    :returns: None if it is larger than ``most_bytes``
    :raises OSError: the file cannot be read
    """
    if not os.path.isfile(path):
        return ''
    if os.path.getsize(path) > most_bytes:
        return None
    with open(path, encoding='utf-8', errors='replace') as stream:
        return stream.read()
