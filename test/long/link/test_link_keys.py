# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A link with keys, and whoever has none, a wrong one, or one that was taken back.

The attacker knows all that the host knows, the newest token of the guard among it: what keeps it
out are the keys. That the same attack moves the robot with a key that drives shows that it is one.
"""
import pathlib
import random
import select
import socket
import threading
import time

import psutil
import pytest

from mhri.base.views import LIVE
from mhri.link.control import STEP_S
from mhri.link.ros.datagrams import PASS
from mhri.robots.owners import ASK_FOR, TAKE_IT
from mhri.robots.robot_view import robot_view
from support.authority import Authority
from support.cable import Cable
from support.linked import Linked, LONG_S
from support.ros_system import wait_for

ATTACK_S = 2.0
# How long a certificate is good that runs out, and how soon after that its owner is out.
VALID_S, OUT_S = 30.0, 8.0


class Attacker:
    """Says that the robot shall turn, as itself and as the host in control, to whoever lets it in.

    :param key: a folder with ``own.key`` and ``own.pem``, None for no key
    :param names: what it calls itself
    """

    def __init__(self, lab, key, names):
        from mhri.link.carried import COMMAND, key_of
        from mhri.link.peer import Peer
        from mhri.link.ros.carrier import Carrier
        settings = {'root_ca_certificate': str(lab.at_robot / 'authority.pem'),
                    'verify_name_on_connect': False, 'enable_mtls': key is not None}
        if key:
            settings.update(connect_private_key=str(key / 'own.key'),
                            connect_certificate=str(key / 'own.pem'))
        self._lab = lab
        self._carrier = Carrier(connect=[lab.endpoint], secrets={
            'transport/link/tls/' + name: value for name, value in settings.items()}, own=names[-1])
        self._peer = Peer()
        self.heard = set()
        self._senders = []
        self._carrier.listen('mhri/**', self._hear)
        for name in names:
            between = self._carrier.between('bot1', name)
            between.listen('up', lambda topic, data, name=name: self._hear(
                key_of('bot1', name, 'up', topic), data))
            self._senders.append([between.sender('down', topic, COMMAND)
                                  for topic in ('_beat', 'mhri_guard/command')])

    def _hear(self, key, data):
        from mhri.link.frames import unpack, unpack_beat
        from mhri.link.ros.side import boot_clock
        if '/up/' not in key:
            return
        self.heard.add(key)
        if key.endswith('/_beat'):
            frame = unpack(data)
            self._peer.on_beat(frame, unpack_beat(frame.body), boot_clock())

    def attack(self, until, timeout_s):
        """Command zeros, then a turn, until something is true; return whether it was."""
        from mhri.link.frames import Beat, pack, pack_beat
        from mhri.link.ros.side import boot_clock
        number, end = 0, time.monotonic() + timeout_s
        session = random.getrandbits(32)
        while time.monotonic() < end:
            number += 1
            turn = 0.0 if number % 20 < 6 else 0.5
            for beat, command in self._senders:
                now = boot_clock()
                beat(pack(session, number, now, pack_beat(Beat(self._peer.echo(now)))))
                command(pack(session, number, now, self._lab.command(session, number, turn)))
            time.sleep(0.05)
            if until():
                return True
        return False

    def is_out(self):
        """Return whether nothing is heard for a while."""
        self.heard.clear()
        return not self.attack(lambda: self.heard, 1.0)

    def close(self):
        self._carrier.close()


class Lab(Linked):
    """A host and a robot with keys, the cable between them, and other keys that were made."""

    def __init__(self, folder):
        self.authority = Authority(folder)
        for words in (('host', 'lab'), ('host', 'desk'), ('host', 'gallery', '--watch'),
                      ('robot', 'bot1'), ('robot', 'bot2')):
            self.authority.run(*words)
        self.stranger = Authority(folder / 'stranger')
        self.stranger.run('host', 'lab')
        self.at_robot = self.authority.put('bot1')
        super().__init__('tls', self.at_robot, self.authority.put('lab'), self._lay)
        self.states = []
        self._token = ''

    def _lay(self, endpoint):
        self.cable = Cable(endpoint)
        return self.cable.endpoint

    def listen(self):
        """Begin to hear the guard's echo and who has control, on the host."""
        import rospy
        from geometry_msgs.msg import TwistStamped
        from mhri.msg import LinkControl
        from mhri.robots.ros.controls import ask_for_control
        from mhri.robots.ros.streams import CONTROL
        rospy.Subscriber('/bot1/mhri_guard/echo', TwistStamped, self._on_echo, queue_size=1)
        rospy.Subscriber('/bot1/mhri_link/state', LinkControl, self.states.append, queue_size=5)
        self.told = []
        control = CONTROL.stream('bot1', None)
        control.open()
        self.shown = lambda: robot_view({'name': 'bot1', 'link': LIVE}, control=control.value())
        self.ask = lambda: ask_for_control('bot1', self.told.append)

    def _on_echo(self, message):
        from mhri.driving.guard_link import parse_id
        self._token = parse_id(message.header.frame_id)[2]

    def command(self, session, number, turn):
        """Return a command for the guard with its newest token, as bytes."""
        import io
        import rospy
        from geometry_msgs.msg import TwistStamped
        from mhri.driving.guard_link import format_id
        message = TwistStamped()
        message.header.frame_id = format_id('bad{}'.format(session), number, self._token)
        message.header.stamp = rospy.Time.from_sec(time.time())
        message.twist.angular.z = turn
        data = io.BytesIO()
        message.serialize(data)
        return data.getvalue()

    @property
    def port(self):
        """Return where the robot listens."""
        return '127.0.0.1', int(self.endpoint.rpartition(':')[2])

    def said(self):
        """Return what the robot's side has written into the log."""
        return pathlib.Path(self.link_of_robot.log).read_text(errors='replace')

    def is_linked(self):
        return bool(self.states) and self.states[-1].linked and self.witness.live()

    def holder(self):
        return self.states[-1].holder if self.states else None

    def attacked(self, key, *names, until=lambda: False, timeout_s=ATTACK_S):
        """Return (whether the robot moved or ``until`` came true, what the attacker heard)."""
        attacker = Attacker(self, key, names)
        try:
            return attacker.attack(lambda: self.moves() or until(), timeout_s), attacker.heard
        finally:
            attacker.close()


@pytest.fixture(scope='module')
def lab(tmp_path_factory):
    import rospy
    from mhri.link.ros.carrier import load_library
    load_library()
    built = Lab(tmp_path_factory.mktemp('keys'))
    try:
        built.join('keys_test')
        built.listen()
        wait_for(built.is_linked, 2 * LONG_S, lambda: 'the link: {}'.format(built.said()[-3000:]))
        yield built
    finally:
        built.close()
        rospy.signal_shutdown('done')


def test_with_keys_it_is_driven(lab):
    lab.drive(lab.operator)
    wait_for(lambda: lab.holder() == 'host:lab', LONG_S, 'the host to be in control')
    assert lab.states[-1].keys and lab.states[-1].may_drive
    assert lab.states[-1].host == 'host:lab'
    lab.let_stand(lab.operator)
    assert 'robot:bot1' in lab.said()


@pytest.mark.parametrize('who, names, line', [
    ('nobody', ('host:lab',), 'refused a connection without a key'),
    ('stranger', ('host:lab',), 'refused a key of another authority'),
    ('bot2', ('host:lab', 'robot:bot2'), 'refused a key that is withdrawn'),
])
def test_who_is_not_let_in_hears_nothing_and_moves_nothing(lab, who, names, line):
    key = {'nobody': None, 'bot2': lab.authority.put('bot2'),
           'stranger': lab.stranger.put('lab')}[who]
    begun = time.monotonic()
    moved, heard = lab.attacked(key, *names)
    assert not moved and heard == set()
    wait_for(lambda: line in lab.said(), LONG_S, 'a line in the log')
    assert lab.said().count(line) <= 2 + (time.monotonic() - begun) / 10.0, 'not one for each try'
    wait_for(lab.is_linked, LONG_S, 'the link')


def test_a_watching_key_sees_and_does_not_drive(lab):
    attacker = Attacker(lab, lab.authority.put('gallery'), ('host:lab', 'watch:gallery'))
    try:
        assert attacker.attack(lambda: attacker.heard, LONG_S)
        assert attacker.attack(lambda: 'bot1 with gallery: sealed datagrams ' + PASS in lab.said(),
                               LONG_S)
        assert not attacker.attack(lab.moves, ATTACK_S)
    finally:
        attacker.close()
    assert all(key.startswith('mhri/bot1/watch:gallery/up/') for key in attacker.heard)
    wait_for(lab.is_linked, LONG_S, 'the link')
    wait_for(lambda: 'linked with gallery' in lab.said(), LONG_S, 'the line')


def test_one_host_at_a_time_and_the_other_asks_twice(lab):
    desk = lab.authority.put('desk')
    lab.drive(lab.operator)
    lab.let_stand(lab.operator)
    wait_for(lambda: lab.holder() == 'host:lab', LONG_S, 'lab to be in control')
    moved, _ = lab.attacked(desk, 'host:lab', 'host:desk', until=lambda: (
        'desk' in lab.states[-1].said), timeout_s=LONG_S)
    # The refusal is logged, and the robot stands.
    assert moved and not lab.moves()
    # lab leaves, so that desk may.
    lab.host.kill(lab.link_of_host)
    wait_for(lambda: 'lab has given up control' in lab.said(), LONG_S, 'lab to be missed')
    attacker = Attacker(lab, desk, ('host:desk',))
    try:
        assert attacker.attack(lambda: 'desk has control' in lab.said(), LONG_S)
        lab.start_host_side()
        assert attacker.attack(lambda: lab.holder() == 'host:desk', LONG_S)
        # The very attack of the others: with a key that drives it is obeyed.
        assert attacker.attack(lab.moves, LONG_S)
        threading.Thread(target=attacker.attack, daemon=True, args=(
            lambda: lab.holder() == 'host:lab', LONG_S)).start()
        told = lab.told
        wait_for(lambda: lab.shown().ask == ASK_FOR, LONG_S, 'the button')
        assert 'desk' in lab.shown().note
        lab.ask()
        wait_for(lambda: lab.shown().ask == TAKE_IT, LONG_S, 'the second step')
        wait_for(lambda: told, LONG_S, 'the answer')
        assert len(told) == 1 and 'desk' in told[0]
        # The second step is for a hand: not within half a second.
        time.sleep(STEP_S + 0.1)
        lab.ask()
        wait_for(lambda: told[1:], LONG_S, 'the answer')
        assert len(told) == 2
    finally:
        attacker.close()
    wait_for(lambda: lab.holder() == 'host:lab', LONG_S, 'lab to be in control')
    lab.drive(lab.operator)
    lab.let_stand(lab.operator)


def test_a_key_that_is_withdrawn_is_out_within_seconds(lab):
    stolen = lab.authority.put('desk')
    attacker = Attacker(lab, stolen, ('host:desk',))
    try:
        assert attacker.attack(lambda: attacker.heard, LONG_S), 'before that it is let in'
        lab.authority.run('withdraw', 'desk')
        begun = time.monotonic()
        lab.authority.put('bot1')
        wait_for(lambda: 'are in use as they are now' in lab.said(), LONG_S, 'the list to be read')
        print('MEASURED the list of those withdrawn is in use after {:.1f} s'.format(
            time.monotonic() - begun))
        # What was on its way may come yet.
        wait_for(attacker.is_out, LONG_S, 'it to be hung up on')
        assert not attacker.attack(lab.moves, ATTACK_S) and attacker.heard == set()
    finally:
        attacker.close()
    moved, heard = lab.attacked(stolen, 'host:desk', 'host:lab')
    assert not moved and heard == set()
    wait_for(lab.is_linked, LONG_S, 'the others to be linked again')
    lab.drive(lab.operator)
    lab.let_stand(lab.operator)


def test_a_key_is_out_though_its_thief_takes_all_descriptors(lab):
    """With them the keys cannot be read; before, the robot went on with the old ones."""
    lab.authority.run('host', 'spare')
    lab.authority.put('bot1')
    wait_for(lab.is_linked, LONG_S, 'the link')
    attacker = Attacker(lab, lab.authority.put('spare'), ('host:spare',))
    try:
        assert attacker.attack(lambda: attacker.heard, LONG_S), 'before that it is let in'
        with Flood(lab.port, lab.node_of_robot()):
            before = lab.said().count('are in use as they are now')
            lab.authority.run('withdraw', 'spare')
            lab.authority.put('bot1')
            begun = time.monotonic()
            wait_for(lambda: lab.said().count('are in use as they are now') > before, LONG_S,
                     lambda: 'the list to be read: {}'.format(lab.said()[-1000:]))
            print('MEASURED with no descriptor left the list is in use after {:.1f} s'.format(
                time.monotonic() - begun))
            wait_for(attacker.is_out, LONG_S, 'it to be hung up on')
            assert not attacker.attack(lab.moves, ATTACK_S) and attacker.heard == set()
    finally:
        attacker.close()
    wait_for(lab.is_linked, LONG_S, 'the others to be linked again')


def test_who_has_a_certificate_that_runs_out_is_out_within_seconds(lab):
    """TLS hangs up by itself; datagrams passed for ten minutes more."""
    lab.authority.run('host', 'guest', '--days', '1', shift_s=int(VALID_S) - 86400)
    lab.authority.put('bot1')
    end_s = lab.authority.end_s('guest')
    attacker = Attacker(lab, lab.authority.put('guest'), ('host:guest',))
    try:
        assert attacker.attack(lambda: 'bot1 with guest: sealed datagrams ' + PASS in lab.said(),
                               VALID_S), 'before that it is let in'
        attacker.attack(lambda: time.time() > end_s, VALID_S)
        wait_for(attacker.is_out, OUT_S, 'it to be hung up on')
        print('MEASURED who has a certificate that ran out is out after {:.1f} s'.format(
            time.time() - 1.0 - end_s))
        assert not attacker.attack(lab.moves, ATTACK_S) and attacker.heard == set()
    finally:
        attacker.close()
    wait_for(lab.is_linked, LONG_S, 'the others to be linked')


class Flood:
    """Holds as many connections as a process takes, and calls again where one is closed."""

    def __init__(self, port, process):
        self._port, self._process = port, process
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._run, daemon=True)

    def __enter__(self):
        # As many as the system gives a process would take long.
        most = self._process.num_fds() + 200
        self._before = self._process.rlimit(psutil.RLIMIT_NOFILE)
        self._process.rlimit(psutil.RLIMIT_NOFILE, (most, self._before[1]))
        self._most = 400
        self._thread.start()
        wait_for(lambda: self._process.num_fds() > most - 5, LONG_S,
                 'all descriptors to be taken')
        return self

    def _run(self):
        open_now, poll = {}, select.poll()
        while not self._ended.is_set():
            try:
                while len(open_now) < self._most and not self._ended.is_set():
                    caller = socket.create_connection(self._port, 1.0)
                    open_now[caller.fileno()] = caller
                    poll.register(caller, select.POLLIN)
            except OSError:
                pass  # it does not listen now, or its queue is full
            for number, _ in poll.poll(20):
                poll.unregister(number)
                open_now.pop(number).close()
        for caller in open_now.values():
            caller.close()

    def __exit__(self, *_):
        self._ended.set()
        self._thread.join()
        self._process.rlimit(psutil.RLIMIT_NOFILE, self._before)


def test_garbage_on_the_port_disturbs_nobody(lab):
    line = 'refused a caller without TLS'
    begun, before = time.monotonic(), lab.said().count(line)
    for seed in range(20):
        with socket.create_connection(lab.port) as caller:
            caller.sendall(random.Random(seed).choice((
                b'GET / HTTP/1.1\r\n\r\n', b'\x16\x03\x01\x02\x00\x01\x00', b'')) +
                random.Random(seed).getrandbits(8000).to_bytes(1000, 'big'))
    wait_for(lambda: line in lab.said(), LONG_S, 'a line in the log')
    # One in 10 s.
    assert lab.said().count(line) - before <= 2 + (time.monotonic() - begun) / 10.0
    wait_for(lab.is_linked, LONG_S, 'the link')


def test_what_was_said_before_is_not_heard_again(lab):
    """All that the host ever said, byte by byte, to the robot's port once more."""
    copies = [b''.join(copy) for copy in list(lab.cable.said)]
    assert any(copies)
    for copy in copies:
        with socket.create_connection(lab.port) as caller:
            try:
                caller.sendall(copy)
            except OSError:
                pass
    datagrams = wait_for(lambda: lab.cable.datagrams[100:], LONG_S, 'datagrams')
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as stranger:
        for packet in datagrams:
            stranger.sendto(packet, lab.port)
            time.sleep(0.0005)
    time.sleep(ATTACK_S)
    assert not lab.moves()
    wait_for(lab.is_linked, LONG_S, 'the link')


def test_what_comes_late_is_not_obeyed(lab):
    lab.drive(lab.operator)
    since = time.monotonic()
    lab.cable.flows.clear()
    try:
        at = wait_for(lambda: lab.stood_at(since), LONG_S, 'it to stand')
        time.sleep(0.4)
    finally:
        lab.cable.flows.set()
    wait_for(lab.is_linked, LONG_S, 'the link to be back')
    # The stick was never let go.
    time.sleep(1.0)
    assert [row for row in lab.rows() if row[0] > at and abs(row[2]) > 0.02] == []
    lab.drive(lab.operator)
    lab.operator.stick.hold(0.0, 0.0)
