# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""On the robot: accepts hosts, each with its own side of the link; one of them has control."""
import threading

import rospy

from mhri.link.budget import Budget
from mhri.link.carried import COMMAND, key_of
from mhri.link.control import Control, pack_control_status, ControlStatus
from mhri.link.frames import FrameError, read_rows, unpack, unpack_beat
from mhri.link.peer import BEAT_S
from mhri.link.ros.clock import boot_clock
from mhri.link.ros.robot_side import RobotSide
from mhri.link.ros.side import BEAT, CONTROL
from mhri.robots.owners import called, is_host, may_drive, ROBOT, split

# Maximum number of hosts; beyond it a new host replaces one that has been silent for this long [s].
MAX_HOSTS, GONE_S = 16, 10.0
# The control status is repeated after this, since the radio may lose it [s].
SAID_S = 1.0


class PeerControl:
    """Control of the robot as seen from one host: its requests and rights."""

    def __init__(self, host, control, lock, budget):
        self.host = host
        self._budget = budget
        self.asked = 0
        self.answer = ''
        self._control = control
        self._lock = lock
        self._was = None
        self._said_at = 0.0

    def on_heard(self, now):
        """Note that the host is present."""
        with self._lock:
            self._control.on_heard(self.host, now)

    def on_asked(self, body, now):
        """Handle a request for control, which may be repeated; 0 releases control.

        :raises FrameError: it is malformed
        """
        row = read_rows(body)
        if len(row) != 1 or type(row[0]) is not int:
            raise FrameError('not a request for control')
        with self._lock:
            if row[0] == 0:
                self._control.on_gone(self.host)
            elif row[0] > self.asked:
                self.asked, self.answer = row[0], self._control.ask(self.host, now)
                self._was = None

    def passes(self, stop, moving, now):
        """Return whether to pass a command of the host on to the guard."""
        with self._lock:
            return self._control.passes(self.host, stop, moving, now)

    def holds(self):
        """Return whether the host has control, or can take it at once."""
        with self._lock:
            return self._control.may_drive(self.host) and self._control.holder in ('', self.host)

    def share(self, carries, reports, now):
        """Return the rate to this host, see :class:`mhri.link.budget.Budget`."""
        with self._lock:
            return self._budget.share(self.host, self._control.holder, carries, reports, now)

    def news(self, said, now):
        """Return the control status to send to the host now, or None."""
        with self._lock:
            standing = ControlStatus(
                self._control.holder, self._control.asking, self._control.may_drive(self.host),
                said, self.asked, self.answer)
            if standing == self._was and now - self._said_at < SAID_S:
                return None
            self._was, self._said_at = standing, now
            return standing


class LinkServer:
    """Opens a :class:`mhri.link.ros.robot_side.RobotSide` for each host that sends beats.

    :param own: name in the robot's key, None without keys
    :param rest: further arguments of the side
    """

    def __init__(self, name, carrier, own, *rest, clock=boot_clock):
        self._name = name
        self._carrier = carrier
        self._rest = rest
        self._clock = clock
        self._lock = threading.RLock()
        self._control = Control(
            lambda host: may_drive(host) and (own is None or split(own)[0] == ROBOT))
        self._budget = Budget()
        self._said = ''
        self._new = set()
        self._sides = {}
        self._work = threading.Event()

    def start(self):
        """Start listening, on a thread."""
        self._carrier.listen(key_of(self._name, '*', 'down', BEAT), self._on_beat)
        threading.Thread(target=self._run, name='reception', daemon=True).start()
        return self

    def _on_beat(self, key, data):
        """Note a new host (on zenoh's thread)."""
        host = key.split('/')[2]
        if host in self._sides or not is_host(host):
            return
        try:
            unpack_beat(unpack(data).body)
        except FrameError as error:
            rospy.logwarn_throttle(1.0, '{}: refused a beat: {}'.format(self._name, error))
            return
        if len(self._sides) >= MAX_HOSTS and self._longest_gone() is None:
            rospy.logwarn_throttle(60.0, '{}: {} is not accepted: there are {} hosts'.format(
                self._name, called(host), MAX_HOSTS))
            return
        self._new.add(host)
        self._work.set()

    def _run(self):
        while not rospy.is_shutdown():
            self._work.wait(BEAT_S)
            self._work.clear()
            try:
                self._tick(self._clock())
            except Exception as error:  # this thread must not end: it accepts all hosts
                if not rospy.is_shutdown():
                    rospy.logerr_throttle(1.0, '{}: the link failed: {!r}'.format(
                        self._name, error))

    def _longest_gone(self):
        """Return the silent host that a new one may replace, or None.

        Hosts without recordings come first.
        """
        now = self._clock()
        gone = [(side.keeps(), -side.peer.silence_s(now), host)
                for host, (side, _) in list(self._sides.items())
                if side.peer.silence_s(now) > GONE_S]
        return min(gone)[2] if gone else None

    def _make_room(self):
        """Return whether another host can be accepted; drop a silent one if necessary."""
        gone = self._longest_gone() if len(self._sides) >= MAX_HOSTS else None
        if gone is not None:
            side, _ = self._sides.pop(gone)
            self._budget.forget(gone)
            side.leave()
            rospy.loginfo('%s: %s has gone', self._name, called(gone))
        return len(self._sides) < MAX_HOSTS

    def _tick(self, now):
        while self._new:
            host = self._new.pop()
            if host not in self._sides and self._make_room():
                peer_control = PeerControl(host, self._control, self._lock, self._budget)
                side = RobotSide(self._name, self._carrier.between(self._name, host), *self._rest,
                                 peer_control)
                self._sides[host] = side, peer_control
                rospy.loginfo('%s: linked with %s, which may %s', self._name,
                              called(host),
                              'drive' if self._control.may_drive(host) else 'only watch')
                side.start()
        with self._lock:
            self._control.tick(now)
            events, self._control.events[:] = list(self._control.events), []
        for text in events:
            rospy.loginfo('%s: %s', self._name, text)
            self._said = text
        for side, peer_control in list(self._sides.values()):
            standing = peer_control.news(self._said, now)
            if standing is not None:
                side.send(CONTROL, COMMAND, pack_control_status(standing))

    def fill(self, status):
        """Fill a ``DiagnosticStatusWrapper`` for the host in control, else for the first."""
        with self._lock:
            holder = self._control.holder
        sides = dict(self._sides)
        if not sides:
            status.summary(status.WARN, 'no host has connected yet: is one calling, with a key '
                                        'that is on the list here?')
            return status
        side, peer_control = sides.get(holder) or next(iter(sides.values()))
        status.add('host', called(peer_control.host))
        status.add('hosts that were here', len(sides))
        return side.fill(status)

    def close(self):
        """Close all sides; the guard stops the robot."""
        for side, _ in list(self._sides.values()):
            side.close()
