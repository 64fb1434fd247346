# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Mux and gates watch each other: each ends the other when it hangs, so that it is restarted.

roslaunch restarts a node that crashes, but not one that hangs. Both repeat their state twice a
second. If one falls silent, the other reports it, and ends it if it can see that it will come back:
it runs on this computer, and roslaunch is its parent.
"""
import os
import signal
import socket
import threading
import time
from urllib.parse import urlsplit

import rospy

from mhri.ros.graph.master_api import MasterApi, MasterError

SILENT_S = 0.9
END_S = 1.8
# One that was started again and says nothing for so long hangs, too: at a load of 40, a start takes
# 5 s at most.
START_S = 20.0
_LOOK_S = 0.1
_LEARN_AGAIN_S = 0.5
# A watch that runs this late was stopped itself, and knows nothing about the other node.
_OWN_SLEEP_S = 0.5
# Between it and roslaunch there may be a shell that restarts it, the command that the shell runs,
# and a process that stands by (:mod:`mhri.ros.stand_by`).
_GENERATIONS = 4
_LAUNCHERS = ('roslaunch', 'rostest')


class Process:
    """One process of this computer, never mistaken for a later one with the same number.

    :param pid: its number
    :raises OSError: there is none, or it cannot be seen
    """

    def __init__(self, pid):
        self.pid = pid
        self._begun, self.parent = self._look()

    def _look(self):
        """Return (when it began [ticks since the start of the computer], its parent's number)."""
        with open('/proc/{}/stat'.format(self.pid), encoding='utf-8', errors='replace') as stream:
            fields = stream.read().rpartition(')')[2].split()
        return int(fields[19]), int(fields[1])

    @property
    def begun_s(self):
        """When it began [s since the start of the computer]."""
        return self._begun / os.sysconf('SC_CLK_TCK')

    def has_any(self, sockets):
        """Tell whether it has one of some open sockets, as /proc names them."""
        folder = '/proc/{}/fd'.format(self.pid)
        for name in os.listdir(folder):
            try:
                if os.readlink(os.path.join(folder, name)) in sockets:
                    return True
            except FileNotFoundError:
                continue
        return False

    def comes_back(self):
        """Tell whether roslaunch started it, directly or through a shell that restarts it."""
        parent = self.parent
        for _ in range(_GENERATIONS):
            try:
                with open('/proc/{}/cmdline'.format(parent), 'rb') as stream:
                    words = stream.read().decode(errors='replace').split('\0')
                if any(os.path.basename(word) in _LAUNCHERS for word in words[:3]):
                    return True
                parent = Process(parent).parent
            except OSError:
                return False
        return False

    def is_there(self):
        """Tell whether it still runs, and is the same."""
        try:
            return self._look() == (self._begun, self.parent)
        except OSError:
            return False

    def end(self):
        """Kill it; return whether it was still there.

        :raises OSError: it is another user's
        """
        if self.pid == os.getpid() or not self.is_there():
            return False
        os.kill(self.pid, signal.SIGKILL)
        return True


def process_of(uri):
    """Return the :class:`Process` behind a node's address, None if it cannot be seen here.

    The system knows who listens there; a node that hangs could not be asked.
    """
    parts = urlsplit(uri)
    with socket.socket() as probe:
        try:
            probe.bind((parts.hostname, 0))
        except OSError:
            return None
    sockets, found = _listening(parts.port), []
    for name in os.listdir('/proc') if sockets else ():
        try:
            process = Process(int(name))
            if process.has_any(sockets):
                found.append(process)
        except (OSError, ValueError):
            continue  # it has gone, is another user's, or no process
    # Its children may hold its socket, too.
    return min(found, key=lambda process: process.begun_s, default=None)


def _listening(port):
    """Return the sockets that listen at a TCP port of this computer."""
    sockets = set()
    for name in ('/proc/net/tcp', '/proc/net/tcp6'):
        if os.path.exists(name):
            with open(name, encoding='ascii') as stream:
                rows = [line.split() for line in stream.readlines()[1:]]
            sockets.update('socket:[{}]'.format(row[9]) for row in rows
                           if row[3] == '0A' and int(row[1].rpartition(':')[2], 16) == port)
    return sockets


class Neighbour:
    """Watches one node by its heartbeat, on a thread of its own.

    :param label: its name in words, e.g. ``the gates``
    :param on_silent: called once when it has been silent for :data:`SILENT_S`
    :param on_back: called when it is heard again after that
    """

    def __init__(self, label, on_silent=lambda: None, on_back=lambda: None, clock=time.monotonic):
        self._label = label
        self._on_silent = on_silent
        self._on_back = on_back
        self._clock = clock
        self._lock = threading.Lock()
        self._caller = self._beat_at = None
        self._known = None
        self._process = None
        self._learn_at = 0.0
        self._looked_at = None
        self.silent = False
        self.ended = 0
        self._remedy = ''
        self._done = threading.Event()

    def start(self):
        """Begin to watch; call it after ``rospy.init_node``."""
        threading.Thread(target=self._run, name='neighbour', daemon=True).start()
        return self

    def stop(self):
        """End the watch; returns at once."""
        self._done.set()

    def beat(self, caller_id):
        """Note that the node was heard; returns at once."""
        with self._lock:
            self._caller, self._beat_at = caller_id, self._clock()

    def words(self):
        """Return what is known about it, in words for the diagnostics."""
        with self._lock:
            caller, beat_at, silent = self._caller, self._beat_at, self.silent
        if caller is None:
            return 'not heard yet'
        words = '{} is heard'.format(caller)
        if silent:
            words = '{} has been silent for {:.0f} s{}'.format(
                caller, self._clock() - beat_at, self._remedy)
        return words + ('; ended {} times because it hung'.format(self.ended) if self.ended else '')

    def _run(self):
        while not self._done.wait(_LOOK_S) and not rospy.is_shutdown():
            self._look(self._clock())

    def _look(self, now):
        """Compare the last heartbeat with the time."""
        with self._lock:
            if self._looked_at is not None and now - self._looked_at > _OWN_SLEEP_S:
                self._beat_at = self._beat_at and now
            self._looked_at = now
            caller, beat_at = self._caller, self._beat_at
            was, self.silent = self.silent, beat_at is not None and now - beat_at > SILENT_S
        if beat_at is None:
            return
        if self.silent and not was:
            self._on_silent()
            rospy.logwarn('%s (%s): silent for %.1f s', self._label, caller, now - beat_at)
        elif was and not self.silent:
            self._remedy = ''
            self._on_back()
            rospy.loginfo('%s (%s): heard again', self._label, caller)
        if not self.silent or self._process is None:
            self._learn(caller, beat_at, now)
        if self.silent and now - beat_at > END_S:
            self._end(caller)

    def _learn(self, caller, beat_at, now):
        """Find out which process it is, and check now and then that it still is."""
        if now < self._learn_at:
            return
        self._learn_at = now + _LEARN_AGAIN_S
        known = self._process.is_there() if self._process else not self.silent
        if known and self._known == caller:
            return
        # Ask again where it is not found, even if it was known before: it may just be starting.
        self._process = self._known = None
        now_s = time.clock_gettime(time.CLOCK_BOOTTIME)
        speaks_since_s = max(now_s - (now - beat_at), now_s - START_S)
        try:
            uri = MasterApi(rospy.get_name(), timeout_s=0.5).node_uri(caller)
            if not uri:
                return
            process = process_of(uri)
        except (MasterError, OSError, ValueError) as error:
            rospy.logdebug('%s: %s', caller, error)
            return
        finally:
            # Asking may have taken long: that does not count as silence.
            with self._lock:
                self._looked_at = self._clock()
        if process is None or process.begun_s <= speaks_since_s:
            self._process, self._known = process, caller
        # Else it is the next one, which starts.

    def _end(self, caller):
        """Kill a process that hangs, once, if it will be restarted."""
        process = self._process
        if process is None or self._remedy:
            return
        if not process.comes_back():
            self._remedy = ': end it and start it again (roslaunch would do so by itself)'
            return
        self._process = self._known = None
        try:
            ended = process.end()
        except OSError:
            return
        if ended:
            self.ended += 1
            rospy.logerr('%s (%s, process %d) hung and was ended: roslaunch starts it again',
                         self._label, caller, process.pid)
