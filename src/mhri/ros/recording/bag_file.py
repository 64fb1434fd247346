# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A bag on the disk: made where there is none, written chunk by chunk, closed whole."""
import errno
import itertools
import os
import stat

from mhri.core.recording import bag_format
from mhri.core.recording.recording import (
    ACTIVE, default_name, fallback_note, numbered, PathRefused, ros_home, split_path, system_folder)

_WORDS = {errno.EACCES: 'no permission', errno.EPERM: 'no permission',
          errno.EROFS: 'that disk is read-only', errno.ENOSPC: 'the disk is full',
          errno.EDQUOT: 'no space is left to this user', errno.ENAMETOOLONG: 'the name is too long',
          errno.ELOOP: 'its links lead in a circle', errno.ENOTDIR: 'a part of it is a file',
          errno.EEXIST: 'a part of it is a file', errno.EFBIG: 'the file is too large for it',
          errno.EIO: 'the disk does not answer'}

# What Linux takes (PATH_MAX) less room for a name; asked before anything is made.
_LONGEST_PATH = 4096 - 256


def words_of(error):
    """Return why a path or a disk failed, for a person."""
    if isinstance(error, OSError):
        return _WORDS.get(error.errno) or (error.strerror or str(error)).lower()
    if isinstance(error, ValueError) and not isinstance(error, PathRefused):
        return 'it contains a character that no name may have'
    return str(error)


class BagFile:
    """A rosbag 2.0 file called ``<path>.active`` until it is closed. Not thread-safe.

    :param path: what it will be called; ``path.active`` is made and must not exist
    :raises OSError: it cannot be made or written
    """

    def __init__(self, path):
        self.path = path
        self.messages = 0
        self._active = path + ACTIVE
        self._connections = {}
        self._chunks = []
        self._fd = os.open(self._active, os.O_RDWR | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC, 0o666)
        self._end = 0
        try:
            self._append(bag_format.VERSION_LINE + bag_format.file_header())
        except OSError:
            os.close(self._fd)
            os.unlink(self._active)
            raise

    @property
    def size(self):
        """The bytes written."""
        return self._end

    def _append(self, data):
        """Write at the end, all or nothing.

        :raises OSError: nothing was written
        """
        view = memoryview(data)
        done = 0
        try:
            while done < len(data):
                done += os.pwrite(self._fd, view[done:], self._end + done)
        except OSError:
            os.ftruncate(self._fd, self._end)
            raise
        self._end += done

    def write(self, chunk, introduced):
        """Write a chunk with its index in one piece.

        :param introduced: the :class:`mhri.core.recording.bag_format.Connection` that are new in it
        :raises OSError: the file is as it was before
        """
        data, info = chunk.finish(self._end)
        position = self._end
        self._append(data)
        self._chunks.append((position, info, chunk.messages))
        self._connections.update((connection.number, connection) for connection in introduced)
        self.messages += chunk.messages

    def sync(self):
        """Have the disk keep what is written, whatever happens to this machine (blocking).

        :raises OSError: the disk failed
        """
        os.fdatasync(self._fd)

    def free_bytes(self):
        """Return the space left for this user on the disk, None where it cannot be told."""
        try:
            found = os.fstatvfs(self._fd)
        except OSError:
            return None
        return found.f_bavail * found.f_frsize

    def close(self):
        """Write the index, give the file its name, and return its path; chunks that leave no room
        for an index on a full disk are given up, the newest first.

        :raises OSError: it stays under the name ``<path>.active``
        """
        try:
            self._write_index()
            os.fsync(self._fd)
        finally:
            os.close(self._fd)
        return self._rename()

    def _write_index(self):
        while True:
            index = b''.join([connection.record for connection in self._connections.values()]
                             + [info for _, info, _ in self._chunks])
            start = self._end
            try:
                self._append(index)
                break
            except OSError as error:
                if error.errno not in (errno.ENOSPC, errno.EDQUOT) or not self._chunks:
                    raise
                self._end, _, messages = self._chunks.pop()
                self.messages -= messages
                os.ftruncate(self._fd, self._end)
        os.pwrite(self._fd, bag_format.file_header(start, len(self._connections),
                                                   len(self._chunks)),
                  len(bag_format.VERSION_LINE))

    def _rename(self):
        folder, name = os.path.split(self.path)
        for number in itertools.count():
            path = os.path.join(folder, numbered(name, number))
            try:
                # Unlike a rename, a link never replaces a file that has come up meanwhile.
                os.link(self._active, path)
                os.unlink(self._active)
            except FileExistsError:
                continue
            except OSError:
                # No links on this disk (FAT). A file that comes up in this instant is lost.
                if os.path.lexists(path):
                    continue
                os.rename(self._active, path)
            self.path = path
            return path


def _is_taken(path):
    """Tell whether a file of this name exists.

    :raises PathRefused: something that is no file has the name
    :raises OSError: links in a circle, a name that is too long
    """
    if not os.path.lexists(path):
        return False
    try:
        if not stat.S_ISREG(os.stat(path).st_mode):
            raise PathRefused('{} is not a file'.format(os.path.basename(path)))
    except FileNotFoundError:
        pass  # a link to nowhere: the name is taken all the same
    return True


def _make_folder(folder):
    """Make a folder and those above it.

    :raises PathRefused, OSError, ValueError: as :func:`_create`
    """
    if len(os.fsencode(folder)) >= _LONGEST_PATH:
        raise PathRefused(_WORDS[errno.ENAMETOOLONG])
    for made in (False, True):
        top = system_folder(os.path.realpath(folder))
        if top:
            raise PathRefused('{} belongs to the system'.format(top))
        if not made:
            try:
                os.makedirs(folder, exist_ok=True)
            except RecursionError:
                raise PathRefused('that are too many folders in one another')


def _create(folder, name):
    """Return (BagFile, whether the name had to be changed) in a folder, which is made if missing.

    :raises PathRefused: files do not go there
    :raises OSError, ValueError: they cannot
    """
    _make_folder(folder)
    for number in itertools.count():
        path = os.path.join(folder, numbered(name, number))
        if _is_taken(path) or os.path.lexists(path + ACTIVE):
            continue
        try:
            return BagFile(path), bool(number)
        except FileExistsError:
            continue


def open_bag(text, robot, when, env=None):
    """Make the bag that the operator asked for, or the default one where that is not possible.

    :param text: what was typed: empty, a folder, or a file with or without ``.bag``; ``~`` and
        variables are replaced
    :param when: a :class:`datetime.datetime` in local time
    :returns: (:class:`BagFile`, note); the note is '' where all is as asked for
    :raises PathRefused: not even the default can be written; the text says why
    """
    env = os.environ if env is None else env
    usual = default_name(robot, when)
    refusal = None
    try:
        folder, name = split_path(text, env, os.path.isdir)
        file, changed = _create(folder, name or usual)
    except (PathRefused, OSError, ValueError) as error:
        refusal = error
    if refusal is not None:
        try:
            file, changed = _create(ros_home(env), usual)
        except (PathRefused, OSError, ValueError) as error:
            raise PathRefused('cannot write to {}: {}'.format(ros_home(env), words_of(error)))
        return file, fallback_note(text, words_of(refusal), file.path)
    if changed:
        return file, '{} exists already; saving to {}'.format(
            name or usual, os.path.basename(file.path))
    return file, ''
