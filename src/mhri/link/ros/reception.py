# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""On the robot: whoever calls gets a side of the link, and one of them has control."""
import threading

import rospy

from mhri.link.budget import Budget
from mhri.link.carried import COMMAND, key_of
from mhri.link.control import Control, pack_standing, Standing
from mhri.link.frames import FrameError, read_rows, unpack, unpack_beat
from mhri.link.peer import BEAT_S
from mhri.link.ros.clock import boot_clock
from mhri.link.ros.robot_side import RobotSide
from mhri.link.ros.side import BEAT, CONTROL
from mhri.robots.owners import called, is_host, may_drive, ROBOT, split

# More hosts than this are not heard at once. Where there are so many, one that was not heard for so
# long gives way to one that is new [s].
MOST_HOSTS, GONE_S = 16, 10.0
# Who has control is said again after this, since the radio may have lost it [s].
SAID_S = 1.0


class Desk:
    """What the robot has agreed with one host about control."""

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
        """Take note that the host is there."""
        with self._lock:
            self._control.on_heard(self.host, now)

    def on_asked(self, body, now):
        """Take in a request for control, as often as it comes; 0 gives it up.

        :raises FrameError: it is none
        """
        row = read_rows(body)
        if len(row) != 1 or type(row[0]) is not int:
            raise FrameError('no request for control')
        with self._lock:
            if row[0] == 0:
                self._control.on_gone(self.host)
            elif row[0] > self.asked:
                self.asked, self.answer = row[0], self._control.ask(self.host, now)
                self._was = None

    def passes(self, stop, moving, now):
        """Tell whether a command of the host goes on to the guard."""
        with self._lock:
            return self._control.passes(self.host, stop, moving, now)

    def holds(self):
        """Tell whether the host has control, or could have it for the asking."""
        with self._lock:
            return self._control.may_drive(self.host) and self._control.holder in ('', self.host)

    def share(self, bears, reports, now):
        """Return what this host may be sent, see :class:`mhri.link.budget.Budget`."""
        with self._lock:
            return self._budget.share(self.host, self._control.holder, bears, reports, now)

    def news(self, said, now):
        """Return what to say to the host of control now, None for nothing."""
        with self._lock:
            standing = Standing(
                self._control.holder, self._control.asking, self._control.may_drive(self.host),
                said, self.asked, self.answer)
            if standing == self._was and now - self._said_at < SAID_S:
                return None
            self._was, self._said_at = standing, now
            return standing


class Reception:
    """Opens a :class:`mhri.link.ros.robot_side.RobotSide` for each host that beats.

    :param own: the name in the robot's key, None without keys
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
        """Begin to listen; returns at once."""
        self._carrier.listen(key_of(self._name, '*', 'down', BEAT), self._knock)
        threading.Thread(target=self._run, name='reception', daemon=True).start()
        return self

    def _knock(self, key, data):
        """Take note of a host that is new (on zenoh's thread)."""
        host = key.split('/')[2]
        if host in self._sides or not is_host(host):
            return
        try:
            unpack_beat(unpack(data).body)
        except FrameError as error:
            rospy.logwarn_throttle(1.0, '{}: refused a beat: {}'.format(self._name, error))
            return
        if len(self._sides) >= MOST_HOSTS and self._longest_gone() is None:
            rospy.logwarn_throttle(60.0, '{}: {} is not heard: {} hosts are here'.format(
                self._name, called(host), MOST_HOSTS))
            return
        self._new.add(host)
        self._work.set()

    def _run(self):
        while not rospy.is_shutdown():
            self._work.wait(BEAT_S)
            self._work.clear()
            try:
                self._tick(self._clock())
            except Exception as error:  # without this thread no other host would be heard
                if not rospy.is_shutdown():
                    rospy.logerr_throttle(1.0, '{}: the link failed: {!r}'.format(
                        self._name, error))

    def _longest_gone(self):
        """Return the host to forget where another one is new, None if there is none.

        First of those for whom nothing is recorded meanwhile.
        """
        now = self._clock()
        gone = [(side.keeps(), -side.peer.silence_s(now), host)
                for host, (side, _) in list(self._sides.items())
                if side.peer.silence_s(now) > GONE_S]
        return min(gone)[2] if gone else None

    def _make_room(self):
        """Return whether one more host may be here."""
        gone = self._longest_gone() if len(self._sides) >= MOST_HOSTS else None
        if gone is not None:
            side, _ = self._sides.pop(gone)
            self._budget.forget(gone)
            side.leave()
            rospy.loginfo('%s: %s has gone', self._name, called(gone))
        return len(self._sides) < MOST_HOSTS

    def _tick(self, now):
        while self._new:
            host = self._new.pop()
            if host not in self._sides and self._make_room():
                desk = Desk(host, self._control, self._lock, self._budget)
                side = RobotSide(self._name, self._carrier.between(self._name, host), *self._rest,
                                 desk)
                self._sides[host] = side, desk
                rospy.loginfo('%s: linked with %s, which may %s', self._name,
                              called(host, *self._sides),
                              'drive' if self._control.may_drive(host) else 'only watch')
                side.start()
        with self._lock:
            self._control.tick(now)
            events, self._control.events[:] = list(self._control.events), []
        for text in events:
            rospy.loginfo('%s: %s', self._name, text)
            self._said = text
        for side, desk in list(self._sides.values()):
            standing = desk.news(self._said, now)
            if standing is not None:
                side.send(CONTROL, COMMAND, pack_standing(standing))

    def fill(self, status):
        """Fill a ``DiagnosticStatusWrapper``: of the host in control, else of the first."""
        with self._lock:
            holder = self._control.holder
        sides = dict(self._sides)
        if not sides:
            status.summary(status.WARN, 'no host was ever heard: does one call, with a key that is '
                                        'on the list here?')
            return status
        side, desk = sides.get(holder) or next(iter(sides.values()))
        status.add('host', called(desk.host))
        status.add('hosts that were here', len(sides))
        return side.fill(status)

    def close(self):
        """End all of it; the guard ends what is being driven."""
        for side, _ in list(self._sides.values()):
            side.close()
