# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""On the robot: records while a host wants it, and keeps the pieces which that host missed."""
import contextlib
import functools
import os
import shutil
import threading
import time

import rosbag
import rospy

from mhri.link.records import crc_of, Piece, piece_of, PIECE_S, too_many
from mhri.recording.folder import NotASession
from mhri.recording.recording import ACTIVE, MB, RECORDING, ros_home
from mhri.recording.ros.bag_set import BagSet, DAMAGED
from mhri.recording.ros.recorder import Recorder

MOST_MB = 500
# No piece takes more than this share of that: of what there is room for the newest is kept.
PIECE_SHARE = 0.1
# A host is missed this much later than it has gone [s].
LATE_S = 2.5
_NS = 10 ** 9


def folder_of(robot, side):
    """Return where pieces are: ``$ROS_HOME/mhri/link/<robot>/<side>``."""
    return os.path.join(ros_home(os.environ), 'mhri', 'link', robot, side)


@functools.lru_cache(maxsize=None)
def keeper_of(robot):
    """Return the keeper of a robot: all sides of its link in this program share one."""
    return Keeper(robot, folder_of(robot, 'kept'))


class Keeper:
    """A recording in pieces of 10 s, of which only those are kept that somebody missed.

    What is open when this program is killed is saved the next time.

    :param make: makes a recorder of (robot, topics, path)
    :param folder: of the pieces; they take :attr:`most_mb` at most, the oldest go first
    """

    def __init__(self, robot, folder, clock=time.time, make=Recorder):
        self._robot = robot
        self._folder = folder
        self.most_mb = MOST_MB
        self._clock = clock
        self._make = make
        self._lock, self._turn = threading.Lock(), threading.Lock()
        # {who: (whether it wants what it misses, whether it is there, whether pictures, too)}
        self._hosts = {}
        self._pieces = None
        self._now = None      # (recorder, when it began)
        self._ending = []     # (recorder, when it began, when it ended)
        self._spare = []      # (path, when it began, when it ended) that nobody has missed yet
        self._missed_at = -1e18
        self._number = 0

    def want(self, who, keep, heard, pictures=False):
        """Take in what a host wants, and whether it is there."""
        with self._lock:
            self._hosts[who] = keep, heard, pictures

    def forget(self, who):
        """Forget a host."""
        with self._lock:
            self._hosts.pop(who, None)

    def pictures_too(self):
        """Tell whether a host wants what it misses of the cameras, too."""
        with self._lock:
            return any(keep and pictures for keep, _, pictures in self._hosts.values())

    def pieces(self):
        """Return the pieces that were kept."""
        with self._lock:
            return list((self._pieces or {}).values())

    def read(self, number, offset, count):
        """Return bytes of a piece, b'' where there are none."""
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
        """Forget pieces: they are where they belong."""
        with self._lock:
            gone = [self._pieces.pop(number) for number in numbers
                    if number in (self._pieces or {})]
        for piece in gone:
            self._remove(os.path.join(self._folder, piece.name))

    def tick(self, topics):
        """Begin, change and end pieces (blocking: the disk); call it twice a second.

        :param topics: what to record, absolute names
        """
        with self._turn:
            self._tick(topics, self._clock())

    def _tick(self, topics, now):
        with self._lock:
            hosts = list(self._hosts.values())
        wanted = any(keep for keep, _, _ in hosts)
        missed = any(keep and not heard for keep, heard, _ in hosts)
        if self._pieces is None:
            self._find()
        was, self._missed_at = self._missed_at, now if missed else self._missed_at
        if self._now is not None:
            begun = self._now[1]
            # Who is back gets what was open at once.
            back = not missed and begun < was > now - LATE_S
            full = self._now[0].status().bytes >= PIECE_SHARE * self.most_mb * MB
            if not wanted or back or full or now - begun >= PIECE_S:
                self._end(now)
        if wanted and self._now is None and topics:
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
        """Keep what has ended and was missed; throw away what was not."""
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
        # No number comes twice, though all pieces before it have gone.
        self._number = max(int(begun), self._number + 1)
        piece = Piece(self._number, int(1e3 * begun), int(1e3 * (ended - begun)))
        try:
            os.rename(path, os.path.join(self._folder, piece.name))
            self._add(piece)
        except OSError as error:
            rospy.logwarn('%s: what was recorded is lost: %s', self._robot, error)
        with self._lock:
            gone = too_many(self._pieces.values(), self.most_mb * MB)
        if gone:
            rospy.logwarn('%s: no room for more than %d MB of what the host missed: the oldest '
                          '%d s are lost', self._robot, self.most_mb,
                          sum(piece.lasts_ms for piece in gone) // 1000)
            self.drop([piece.number for piece in gone])

    def _add(self, piece):
        """Offer a file from now on.

        :raises OSError: it cannot be read
        """
        size = crc = 0
        with open(os.path.join(self._folder, piece.name), 'rb') as file:
            for data in iter(lambda: file.read(MB), b''):
                size, crc = size + len(data), crc_of(data, crc)
        with self._lock:
            self._pieces[piece.number] = Piece(piece.number, piece.begun_ms, piece.lasts_ms, size,
                                               crc)

    def _find(self):
        """Find what an earlier run has kept, and save what it had open."""
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
        """Keep what a killed program was writing; nobody knows any more who missed it."""
        try:
            with rosbag.Bag(path, 'a', allow_unindexed=True) as bag:
                for _ in bag.reindex():
                    pass
            with contextlib.closing(BagSet([path])) as bags:
                begun, ended = bags.start_ns / _NS, bags.end_ns / _NS
            self._keep(path, begun, ended)
        except (NotASession,) + DAMAGED as error:
            rospy.logwarn('%s: %s cannot be saved: %s', self._robot, path, error)

    def _remove(self, path):
        try:
            os.unlink(path)
        except OSError as error:
            rospy.logdebug('%s', error)
