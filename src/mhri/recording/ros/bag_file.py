# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A bag on the disk: created if missing, written chunk by chunk, closed with its index."""
import errno
import io
import itertools
import os
import stat
import sys
from types import SimpleNamespace

import genpy
import rosbag

from mhri.recording.recording import (
    ACTIVE, default_name, numbered, PathRefused, ros_home, split_path, system_folder)

_WORDS = {errno.EACCES: 'no permission', errno.EPERM: 'no permission',
          errno.EROFS: 'that disk is read-only', errno.ENOSPC: 'the disk is full',
          errno.EDQUOT: 'your disk quota is used up', errno.ENAMETOOLONG: 'the name is too long',
          errno.ELOOP: 'its links lead in a circle', errno.ENOTDIR: 'a part of it is a file',
          errno.EEXIST: 'a part of it is a file', errno.EFBIG: 'the file is too large for it',
          errno.EIO: 'the disk does not answer'}

# The longest path on Linux (PATH_MAX) less room for a name; checked before anything is created.
_MAX_PATH = 4096 - 256
_NS = 10 ** 9


def error_text(error):
    """Return the error of a path or a disk as words for the operator."""
    if isinstance(error, OSError):
        return _WORDS.get(error.errno) or (error.strerror or str(error)).lower()
    if isinstance(error, ValueError) and not isinstance(error, PathRefused):
        return 'it contains a character that no name can have'
    return str(error)


class Publisher(str):
    """The topic of one publisher, different from the same topic of any other publisher.

    ``rosbag.Bag`` keeps one connection per topic. With this as the topic, it keeps a connection
    and a header for each publisher, as ``rosbag record`` does: publishers may differ in caller,
    latching and even type.

    :param fields: {name: text} of its connection header; must include ``topic``, ``type``,
        ``md5sum`` and ``message_definition``
    """

    __eq__ = object.__eq__
    __ne__ = object.__ne__
    __hash__ = object.__hash__

    def __new__(cls, fields):
        """Make the string from the topic's name."""
        self = super().__new__(cls, fields['topic'])
        self.fields = fields
        # The attributes of a message class that the library needs; it may not be installed here.
        self.kind = SimpleNamespace(_md5sum=fields['md5sum'],
                                    _full_text=fields['message_definition'])
        return self


class _Tail(io.BytesIO):
    """A file whose tail stays in memory until it is saved, all or nothing.

    ``rosbag.Bag`` writes a chunk piece by piece and then goes back to its header: if it wrote
    straight to disk, a killed program would leave a chunk without a size, a full disk half a chunk.

    :param file_descriptor: of an empty file; closed with this
    ``saved`` is the length of the file on the disk.
    """

    mode = 'w+b'

    def __init__(self, file_descriptor):
        super().__init__()
        self._fd = file_descriptor
        self._base = 0
        self.saved = 0

    def tell(self):
        """Return the position in the file."""
        return self._base + super().tell()

    def seek(self, offset, whence=os.SEEK_SET):
        """Go to a position; save the tail first if the position is already on the disk.

        :raises OSError: see :meth:`save`
        """
        if whence == os.SEEK_SET:
            if offset < self._base:
                self.save()
                self._base = offset
            offset -= self._base
        return self._base + super().seek(offset, whence)

    def save(self):
        """Write the tail from memory.

        :raises OSError: nothing was written, and memory is empty
        """
        data, done = memoryview(self.getvalue()), 0
        try:
            while done < len(data):
                done += os.pwrite(self._fd, data[done:], self._base + done)
        except OSError:
            self.cut(self.saved)
            raise
        self._base += done
        self.saved = max(self.saved, self._base)
        self._forget()

    def cut(self, length):
        """Discard the tail in memory, and truncate the file to a length."""
        self._forget()
        os.ftruncate(self._fd, length)
        self._base = self.saved = length

    def _forget(self):
        super().seek(0)
        self.truncate()

    def close(self):
        """Save, and flush to the disk.

        :raises OSError: the disk failed; the file is closed anyway
        """
        if self.closed:
            return
        try:
            self.save()
            os.fsync(self._fd)
        finally:
            os.close(self._fd)
            super().close()


class BagFile:
    """A rosbag 2.0 file called ``<path>.active`` until it is closed. Not thread-safe.

    Written by ``rosbag.Bag``. The only private attributes used are its lists of chunks (to drop the
    newest if the disk is full) and of messages (kept for readers, and growing without limit).

    :param path: its final name; ``path.active`` is created and must not exist
    :raises OSError: it cannot be created or written
    """

    def __init__(self, path):
        self.path = path
        self._active = path + ACTIVE
        self._fd = os.open(self._active, os.O_RDWR | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC, 0o666)
        self._tail = _Tail(self._fd)
        try:
            # Only write() ends chunks.
            self._bag = rosbag.Bag(self._tail, 'w', chunk_threshold=sys.maxsize)
            self._tail.save()
        except OSError:
            os.unlink(self._active)
            self._tail.close()
            raise

    @property
    def size(self):
        """The number of bytes written."""
        return self._tail.saved

    @property
    def messages(self):
        """The number of messages written."""
        return self._bag.get_message_count()

    def write(self, messages):
        """Write messages as a chunk with its index, in one piece.

        :param messages: (:class:`Publisher`, receipt time [ns], frame: the length (4 bytes) and
            bytes of a serialised message), at least one
        :raises OSError: the write failed; the file is unchanged
        """
        for publisher, time_ns, frame in messages:
            fields = publisher.fields
            self._bag.write(
                publisher, (fields['type'], frame[4:], fields['md5sum'], publisher.kind),
                genpy.Time(*divmod(time_ns, _NS)), raw=True, connection_header=fields)
        self._bag.flush()
        self._bag._connection_indexes.clear()
        try:
            self._tail.save()
        except OSError:
            self._bag._chunks.pop()
            raise

    def sync(self):
        """Flush to the disk, so that the data survive a crash of this machine (blocking).

        :raises OSError: the disk failed
        """
        os.fdatasync(self._fd)

    def free_bytes(self):
        """Return the free space for this user on the disk, None if unknown."""
        try:
            found = os.fstatvfs(self._fd)
        except OSError:
            return None
        return found.f_bavail * found.f_frsize

    def close(self):
        """Write the index, rename the file to its final name, and return its path.

        If a full disk has no room for the index, drop chunks, the newest first.

        :raises OSError: the file keeps the name ``<path>.active``
        """
        try:
            self._write_index()
        finally:
            self._tail.close()
        return self._rename()

    def _write_index(self):
        chunks = self._bag._chunks
        while True:
            try:
                self._bag.close()
                return
            except OSError as error:
                full = error.errno in (errno.ENOSPC, errno.EDQUOT)
                if self._tail.closed or not (full and chunks):
                    raise
                self._tail.cut(chunks.pop().pos)

    def _rename(self):
        folder, name = os.path.split(self.path)
        for number in itertools.count():
            path = os.path.join(folder, numbered(name, number))
            try:
                # Unlike a rename, a link never replaces a file that appeared meanwhile.
                os.link(self._active, path)
                os.unlink(self._active)
            except FileExistsError:
                continue
            except OSError:
                # This disk has no links (FAT): a file that appears in this instant is overwritten.
                if os.path.lexists(path):
                    continue
                os.rename(self._active, path)
            self.path = path
            return path


def _is_taken(path):
    """Return whether a file of this name exists.

    :raises PathRefused: the name is that of something other than a file
    :raises OSError: circular links, or a name that is too long
    """
    if not os.path.lexists(path):
        return False
    try:
        if not stat.S_ISREG(os.stat(path).st_mode):
            raise PathRefused('{} is not a file'.format(os.path.basename(path)))
    except FileNotFoundError:
        pass  # a broken link: the name is taken, too
    return True


def _make_folder(folder):
    """Make a folder and its parents.

    :raises PathRefused, OSError, ValueError: see :func:`_create`
    """
    if len(os.fsencode(folder)) >= _MAX_PATH:
        raise PathRefused(_WORDS[errno.ENAMETOOLONG])
    for made in (False, True):
        top = system_folder(os.path.realpath(folder))
        if top:
            raise PathRefused('{} belongs to the system'.format(top))
        if not made:
            try:
                os.makedirs(folder, exist_ok=True)
            except RecursionError:
                raise PathRefused('the folders are nested too deeply')


def _create(folder, name):
    """Return (BagFile, whether its name had to change) in a folder, created if missing.

    :raises PathRefused: files must not be written there
    :raises OSError, ValueError: files cannot be written there
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


def open_bag(text, robot, when):
    """Create the requested bag, or the default one if that is impossible.

    :param text: as the operator typed it: empty, a folder, or a file with or without ``.bag``;
        ``~`` and variables are expanded
    :param when: a :class:`datetime.datetime` in local time
    :returns: (:class:`BagFile`, note, why it is elsewhere); both texts are '' if all is as
        requested
    :raises PathRefused: even the default cannot be written; the text is the reason
    """
    env = os.environ
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
            raise PathRefused('cannot write to {}: {}'.format(ros_home(env), error_text(error)))
        return file, '', error_text(refusal)
    if changed:
        return file, '{} exists already; saving to {}'.format(
            name or usual, os.path.basename(file.path)), ''
    return file, '', ''
