# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The bodies of all simulated robots of one building, shared without ROS.

A file in shared memory with one slot per robot: lasers, bumpers and cameras must not require a
topic that no real robot has. The body of a killed robot remains until a robot of its name takes its
slot, or until nothing has been written to the slot for :data:`GHOST_S`.

Slots are read and written without a lock: each is written in one piece with a checksum, and a
reader retries after a torn read.
"""
import errno
import fcntl
import hashlib
import math
import mmap
import os
import stat
import struct
import tempfile
import zlib

import numpy as np

from mhri.base.names import MAX_LENGTH

SLOTS = 64
GHOST_S = 20.0
_SLOT = np.dtype([('name', 'S{}'.format(MAX_LENGTH)), ('owner', '<u8'), ('x', '<f8'), ('y', '<f8'),
                  ('yaw', '<f8'), ('stamp', '<f8'), ('sum', '<u4'), ('colour', 'u1', 3),
                  ('spare', 'u1'), ('radius', '<f8'), ('height', '<f8')])
_OWNER = struct.Struct('<Q')
_POSE = struct.Struct('<4d')
_SUM = struct.Struct('<I')
_SIZE = SLOTS * _SLOT.itemsize
_POSE_FROM = _SLOT.fields['x'][1]
# Number of attempts to read a slot that is being written.
_TRIES = 20
_NOWHERE = (math.nan, math.nan, 0.0)
# Errors of opening a symbolic link, the file of another user, a folder, and a socket.
_NOT_OURS = frozenset((errno.ELOOP, errno.EACCES, errno.EPERM, errno.EISDIR, errno.ENXIO))


class WorldRefused(OSError):
    """The shared file is not this user's own; the text names the remedy."""


class WorldFull(Exception):
    """No slot is left: more than :data:`SLOTS` robots in one building."""


def _file_problem(status):
    """Return why a file cannot be this user's own world, '' if it can.

    :param status: its ``os.stat_result``
    """
    if not stat.S_ISREG(status.st_mode):
        return 'it is not an ordinary file'
    if status.st_uid != os.getuid():
        return 'it belongs to another user ({})'.format(status.st_uid)
    if status.st_mode & (stat.S_IWGRP | stat.S_IWOTH):
        return 'others can write to it (mode {:o})'.format(stat.S_IMODE(status.st_mode))
    # None: the last robot has just removed it.
    return 'it has another name elsewhere (a hard link)' if status.st_nlink > 1 else ''


def world_path(key, folder=None):
    """Return the file of a world, shared by robots with the same key (and file layout)."""
    if folder is None:
        folder = '/dev/shm' if os.path.isdir('/dev/shm') else tempfile.gettempdir()
    digest = hashlib.sha256('{} {} {}'.format(key, SLOTS, _SLOT).encode('utf-8')).hexdigest()[:16]
    return os.path.join(folder, 'mhri_world_{}_{}'.format(os.getuid(), digest))


class World:
    """One robot's slot in the shared file.

    Of two robots with one name, the slot belongs to the one that published last. A robot that
    lost its slot takes it, or a free one, when it publishes again.

    :param path: from :func:`world_path`
    :param body_type: :class:`mhri.sim.body.BodyType` as seen by the others
    :param clock: seconds of a clock shared by all processes (``time.monotonic`` on Linux)
    :raises WorldFull: no slot is left
    :raises WorldRefused: the file is not this user's own
    :raises OSError: the file is unusable
    """

    def __init__(self, path, name, body_type, clock):
        self._path = path
        self._name = name.encode('ascii')
        self._body_type = body_type
        self._clock = clock
        self._owner = int.from_bytes(os.urandom(8), 'little') | 1
        self._file = self._open_locked()
        try:
            if os.fstat(self._file).st_size < _SIZE:
                os.ftruncate(self._file, _SIZE)
            self._map = mmap.mmap(self._file, _SIZE)
            self._slots = np.frombuffer(self._map, dtype=_SLOT)
            self._take()
        finally:
            fcntl.flock(self._file, fcntl.LOCK_UN)

    def _open_locked(self):
        """Return the open file, locked; retry if the last robot has just removed it.

        The folder is world-writable: a file in it may be a trap.

        :raises WorldRefused: it is not this user's own file
        """
        while True:
            try:
                handle = os.open(self._path, os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW, 0o600)
            except OSError as error:
                if error.errno in _NOT_OURS:
                    raise self._refused(error.strerror)
                raise
            try:
                problem = _file_problem(os.fstat(handle))
                if problem:
                    raise self._refused(problem)
                fcntl.flock(handle, fcntl.LOCK_EX)
                if os.fstat(handle).st_nlink:
                    kept, handle = handle, None
                    return kept
            finally:
                if handle is not None:
                    os.close(handle)

    def _refused(self, reason):
        return WorldRefused('{}: not used, {}; remove it, or ask who put it there'.format(
            self._path, reason))

    def _take(self):
        """Take the slot of this name, else a free one; called with the file locked."""
        slots = self._slots
        own = np.flatnonzero(slots['name'] == self._name)
        free = np.flatnonzero(~self._there())
        if not len(own) and not len(free):
            raise WorldFull('the simulated building has room for {} robots'.format(SLOTS))
        slot = int(own[0] if len(own) else free[0])
        body = self._body_type
        self._slot = slot
        self._owner_at = slot * _SLOT.itemsize + _SLOT.fields['owner'][1]
        self._pose_at = slot * _SLOT.itemsize + _POSE_FROM
        # Unowned until it is complete, and invisible until it has a pose.
        slots['owner'][slot] = 0
        self._write(*_NOWHERE)
        for key, value in (('name', self._name), ('radius', body.radius_m),
                           ('height', body.height_m), ('colour', body.colour)):
            slots[key][slot] = value
        slots['owner'][slot] = self._owner

    def _write(self, x, y, yaw):
        # In one piece: pack_into() would fill the slot with zeros first.
        pose = _POSE.pack(x, y, yaw, self._clock())
        self._map[self._pose_at:self._pose_at + _POSE.size + _SUM.size] = pose + _SUM.pack(
            zlib.crc32(pose))

    def _owned(self):
        return _OWNER.unpack_from(self._map, self._owner_at)[0] == self._owner

    def publish(self, x, y, yaw):
        """Write the pose of this robot [m, m, rad].

        :raises WorldFull: its slot was given away, and no other is left
        """
        if not self._owned():
            fcntl.flock(self._file, fcntl.LOCK_EX)
            try:
                self._take()
            finally:
                fcntl.flock(self._file, fcntl.LOCK_UN)
        self._write(x, y, yaw)

    def _there(self):
        """Return a mask of the slots with a robot, or with the body of a killed one."""
        # Another process may write meanwhile: then its stamp is later than our time.
        age = np.abs(self._clock() - self._slots['stamp'])
        return (self._slots['owner'] != 0) & (age <= GHOST_S)

    def others(self):
        """Return the appearance of the other robots: a structured array, a copy.

        Its fields: ``x, y`` [m], ``yaw`` [rad], ``radius, height`` [m], ``colour`` (3 times 0 to
        255), ``name``.
        """
        rows = _whole_rows(self._slots.copy, self._clock)
        return rows[rows['name'] != self._name]

    def discs(self):
        """Return the bodies of the other robots as an array (n, 3) of x, y, radius [m]."""
        rows = self.others()
        return np.column_stack((rows['x'], rows['y'], rows['radius']))

    def leave(self):
        """Remove this robot, unless its slot was given away; the last one removes the file."""
        fcntl.flock(self._file, fcntl.LOCK_EX)
        try:
            if self._owned():
                # The pose stays, so that concurrent readers do not see a jump.
                _OWNER.pack_into(self._map, self._owner_at, 0)
            if not self._there().any() and os.fstat(self._file).st_nlink:
                os.unlink(self._path)
        finally:
            fcntl.flock(self._file, fcntl.LOCK_UN)


def look_in(path, clock):
    """Return all robots of a world, like :meth:`World.others`, without taking a slot.

    The array is empty if the world does not exist.

    :raises WorldRefused: the shared file is not this user's own
    """
    try:
        handle = os.open(path, os.O_RDONLY | os.O_NOFOLLOW)
    except FileNotFoundError:
        return np.zeros(0, _SLOT)
    try:
        problem = _file_problem(os.fstat(handle))
        if problem:
            raise WorldRefused('{}: not looked at, {}'.format(path, problem))
        return _whole_rows(lambda: np.frombuffer(
            os.pread(handle, _SIZE, 0).ljust(_SIZE, b'\0'), dtype=_SLOT), clock)
    finally:
        os.close(handle)


def _whole_rows(read, clock):
    """Return the slots with a valid pose, without torn ones.

    :param read: function that returns a copy of all slots
    """
    for _ in range(_TRIES):
        rows = read()
        # Another process may write meanwhile: then its stamp is later than our time.
        rows = rows[rows['owner'] != 0]
        whole = np.array([_is_whole(row.tobytes()) for row in rows], bool)
        if whole.all():
            break
    rows = rows[whole]
    return rows[np.isfinite(rows['x']) & (np.abs(clock() - rows['stamp']) <= GHOST_S)]


def _is_whole(row):
    end = _POSE_FROM + _POSE.size
    return _SUM.unpack_from(row, end)[0] == zlib.crc32(row[_POSE_FROM:end])
