# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""On the robot: records on request of a host, and keeps the pieces of outages."""
import contextlib
import functools
import os
import shutil
import threading
import time
import zlib

import rosbag
import rospy

from mhri.link.records import Piece, piece_of, PIECE_S, too_many
from mhri.recording.folder import NotASession
from mhri.recording.recording import ACTIVE, MB, RECORDING, ros_home
from mhri.recording.ros.bag_set import BagSet, DAMAGED
from mhri.recording.ros.recorder import Recorder

MAX_MB = 500
# Maximum size of a piece, as a fraction of max_mb, so that the newest pieces are kept.
PIECE_SHARE = 0.1
# Maximum delay of the detection of an outage [s].
LATE_S = 2.5
_NS = 10 ** 9


def folder_of(robot, side):
    """Return the folder of pieces: ``$ROS_HOME/mhri/link/<robot>/<side>``."""
    return os.path.join(ros_home(os.environ), 'mhri', 'link', robot, side)


def crc_of_file(path):
    """Return the checksum of a file.

    :raises OSError: it cannot be read
    """
    crc = 0
    with open(path, 'rb') as file:
        for data in iter(lambda: file.read(MB), b''):
            crc = zlib.crc32(data, crc)
    return crc


@functools.lru_cache(maxsize=None)
def keeper_of(robot):
    """Return the keeper of a robot, shared by all sides of its link in this process."""
    return Keeper(robot, folder_of(robot, 'kept'))


class Keeper:
    """Records in pieces of 10 s, and keeps only those of outages.

    A piece that is open when the process is killed is recovered at the next start.

    :param make: creates a recorder of (robot, topics, path)
    :param folder: folder of the pieces, at most :attr:`max_mb`; the oldest are dropped first
    """

    def __init__(self, robot, folder, clock=time.time, make=Recorder):
        self._robot = robot
        self._folder = folder
        self.max_mb = MAX_MB
        self._clock = clock
        self._make = make
        self._lock, self._turn = threading.Lock(), threading.Lock()
        # {host: (whether to record for it, whether it is linked, whether with pictures)}
        self._hosts = {}
        self._pieces = None
        self._now = None      # (recorder, start)
        self._ending = []     # (recorder, start, end)
        self._spare = []      # (path, start, end) of pieces without an outage so far
        self._missed_at = -1e18
        self._number = 0

    def request(self, who, keep, live, pictures=False):
        """Set a host's request of recordings, and whether it is linked."""
        with self._lock:
            self._hosts[who] = keep, live, pictures

    def forget(self, who):
        """Forget a host."""
        with self._lock:
            self._hosts.pop(who, None)

    def pictures_too(self):
        """Return whether a host requests pictures, too."""
        with self._lock:
            return any(keep and pictures for keep, _, pictures in self._hosts.values())

    def pieces(self):
        """Return the kept pieces."""
        with self._lock:
            return list((self._pieces or {}).values())

    def read(self, number, offset, count):
        """Return bytes of a piece, b'' past its end or if it is unknown."""
        with self._lock:
            piece = (self._pieces or {}).get(number)
        if piece is None:
            return b''
        try:
            with open(os.path.join(self._folder, piece.name), 'rb') as file:
                file.seek(offset)
                return file.read(count)
        except OSError:
            return b''

    def drop(self, numbers):
        """Delete pieces that the host has received."""
        with self._lock:
            gone = [self._pieces.pop(number) for number in numbers
                    if number in (self._pieces or {})]
        for piece in gone:
            self._remove(os.path.join(self._folder, piece.name))

    def tick(self, topics):
        """Start and end pieces (blocking: disk); to be called twice a second.

        :param topics: absolute names of the topics to record
        """
        with self._turn:
            self._tick(topics, self._clock())

    def _tick(self, topics, now):
        with self._lock:
            hosts = list(self._hosts.values())
        requested = any(keep for keep, _, _ in hosts)
        missed = any(keep and not live for keep, live, _ in hosts)
        if self._pieces is None:
            self._find()
        was, self._missed_at = self._missed_at, now if missed else self._missed_at
        if self._now is not None:
            begun = self._now[1]
            # After an outage the open piece ends at once, so that the host can fetch it.
            back = not missed and begun < was > now - LATE_S
            full = self._now[0].status().bytes >= PIECE_SHARE * self.max_mb * MB
            if not requested or back or full or now - begun >= PIECE_S:
                self._end(now)
        if requested and self._now is None and topics:
            self._begin(topics, now)
        self._save(now)

    def _begin(self, topics, now):
        folder = os.path.join(self._folder, 'open')
        os.makedirs(folder, exist_ok=True)
        recorder = self._make(self._robot, topics, os.path.join(folder, 'open.bag'))
        recorder.start()
        self._now = recorder, now

    def _end(self, now):
        recorder, begun = self._now
        self._now = None
        recorder.stop()
        self._ending.append((recorder, begun, now))

    def _save(self, now):
        """Keep the finished pieces of outages, and delete the others."""
        ending, self._ending = self._ending, []
        for recorder, begun, ended in ending:
            status = recorder.status()
            if status.state == RECORDING:
                self._ending.append((recorder, begun, ended))
            elif status.messages and status.path:
                self._spare.append((status.path, begun, ended))
            if status.state != RECORDING and status.attention:
                rospy.logwarn_throttle(60.0, '%s: %s', self._robot, status.note)
        spare, self._spare = self._spare, []
        for path, begun, ended in spare:
            if self._missed_at >= begun - LATE_S and self._missed_at - LATE_S <= ended:
                self._keep(path, begun, ended)
            elif now - ended > LATE_S:
                self._remove(path)
            else:
                self._spare.append((path, begun, ended))

    def _keep(self, path, begun, ended):
        # Numbers never repeat, even after all earlier pieces have been deleted.
        self._number = max(int(begun), self._number + 1)
        piece = Piece(self._number, int(1e3 * begun), int(1e3 * (ended - begun)))
        try:
            os.rename(path, os.path.join(self._folder, piece.name))
            self._add(piece)
        except OSError as error:
            rospy.logwarn('%s: a recording is lost: %s', self._robot, error)
        with self._lock:
            gone = too_many(self._pieces.values(), self.max_mb * MB)
        if gone:
            rospy.logwarn('%s: more than %d MB of recordings for the host: the oldest '
                          '%d s are deleted', self._robot, self.max_mb,
                          sum(piece.lasts_ms for piece in gone) // 1000)
            self.drop([piece.number for piece in gone])

    def _add(self, piece):
        """Add the file of a piece to the pieces.

        :raises OSError: it cannot be read
        """
        path = os.path.join(self._folder, piece.name)
        whole = Piece(piece.number, piece.begun_ms, piece.lasts_ms, os.path.getsize(path),
                      crc_of_file(path))
        with self._lock:
            self._pieces[piece.number] = whole

    def _find(self):
        """Load the pieces of an earlier run, and recover its open one."""
        self._pieces = {}
        for name in sorted(os.listdir(self._folder)) if os.path.isdir(self._folder) else ():
            piece = piece_of(name)
            if piece is not None:
                self._number = piece.number
                self._add(piece)
        folder = os.path.join(self._folder, 'open')
        for name in sorted(os.listdir(folder)) if os.path.isdir(folder) else ():
            if name.endswith(ACTIVE):
                self._rescue(os.path.join(folder, name))
        shutil.rmtree(folder, ignore_errors=True)

    def _rescue(self, path):
        """Keep the open piece of a killed process, since an outage in it cannot be excluded."""
        try:
            with rosbag.Bag(path, 'a', allow_unindexed=True) as bag:
                for _ in bag.reindex():
                    pass
            with contextlib.closing(BagSet([path])) as bags:
                begun, ended = bags.start_ns / _NS, bags.end_ns / _NS
            self._keep(path, begun, ended)
        except (NotASession,) + DAMAGED as error:
            rospy.logwarn('%s: %s cannot be recovered: %s', self._robot, path, error)

    def _remove(self, path):
        try:
            os.unlink(path)
        except OSError as error:
            rospy.logdebug('%s', error)
