# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The doctor tells a wrong clock from a wrong key, by calling the robot's end of a link."""
import datetime
import socket
import time

import pytest

from mhri.doctor.facts import (
    ANSWERS, EARLY, KeysSeen, LinkNote, RUN_OUT, UNTIMELY, UNWELCOME)
from mhri.doctor.ros.linked import ask_links, linked_of, taken
from mhri.graph.ros.parallel_calls import Answers
from mhri.link.ros.carrier import Carrier
from support.ros_system import free_port

x509 = pytest.importorskip('cryptography.x509')
DAY = datetime.timedelta(days=1)
LONG_S = 60.0


class Authority:
    """Makes certificates that are valid on any days."""

    def __init__(self):
        from cryptography.hazmat.primitives.asymmetric import ec
        self._curve = ec.SECP256R1()
        self._generate = ec.generate_private_key
        self._key = self._new_key()
        self._own = self._sign('authority', -900 * DAY, 900 * DAY, self._key, True)

    def _new_key(self):
        from cryptography.hazmat.backends import default_backend
        return self._generate(self._curve, default_backend())

    def _sign(self, owner, begins, ends, key, signs):
        from cryptography.hazmat.backends import default_backend
        from cryptography.hazmat.primitives import hashes
        now = datetime.datetime.utcnow()
        names = [x509.Name([x509.NameAttribute(x509.oid.NameOID.COMMON_NAME, name)])
                 for name in (owner, 'authority')]
        return x509.CertificateBuilder().subject_name(names[0]).issuer_name(names[1]).public_key(
            key.public_key()).serial_number(x509.random_serial_number()).not_valid_before(
                now + begins).not_valid_after(now + ends).add_extension(
                    x509.BasicConstraints(signs, None), critical=True).add_extension(
                        x509.SubjectAlternativeName([x509.DNSName('robot')]), critical=False).sign(
                            self._key, hashes.SHA256(), default_backend())

    def put(self, folder, owner, begins=-1 * DAY, ends=100 * DAY):
        """Return a folder with a key, its certificate, and that of the authority."""
        from cryptography.hazmat.primitives import serialization
        folder.mkdir()
        key, pem = self._new_key(), serialization.Encoding.PEM
        (folder / 'own.key').write_bytes(key.private_bytes(
            pem, serialization.PrivateFormat.PKCS8, serialization.NoEncryption()))
        (folder / 'own.pem').write_bytes(
            self._sign(owner, begins, ends, key, False).public_bytes(pem))
        (folder / 'authority.pem').write_bytes(self._own.public_bytes(pem))
        return folder


@pytest.fixture(scope='module')
def ours():
    return Authority()


def answers(robot, host, wait_s=LONG_S):
    """Let a robot's end with one key be called with another; return how they are taken."""
    endpoint = 'tls/127.0.0.1:{}'.format(free_port())
    settings = {
        'root_ca_certificate': str(robot / 'authority.pem'), 'enable_mtls': True,
        'listen_private_key': str(robot / 'own.key'), 'listen_certificate': str(robot / 'own.pem')}
    carrier = Carrier(listen=[endpoint], secrets={
        'transport/link/tls/' + name: value for name, value in settings.items()})
    try:
        with socket.create_connection(
                ('127.0.0.1', int(endpoint.rpartition(':')[2])), wait_s) as connection:
            return taken(connection, str(host))
    finally:
        carrier.close()


@pytest.mark.parametrize('of_robot, of_host, expected', [
    ((-1, 100), (-1, 100), ANSWERS),
    # The clock here is behind, or the authority's was ahead.
    ((10, 100), (-1, 100), EARLY),
    ((-100, -10), (-1, 100), RUN_OUT),
    # As it is for a robot whose clock is ahead, or behind.
    ((-1, 100), (-100, -10), UNTIMELY),
    ((-1, 100), (10, 100), UNTIMELY),
])
def test_clock_and_dates(ours, tmp_path, of_robot, of_host, expected):
    robot = ours.put(tmp_path / 'robot', 'robot:bot1', *(days * DAY for days in of_robot))
    host = ours.put(tmp_path / 'host', 'host:lab', *(days * DAY for days in of_host))
    # Who is content waits for the next word.
    assert answers(robot, host, 1.0 if expected == ANSWERS else LONG_S) == expected


def test_another_authority(ours, tmp_path):
    robot, host = ours.put(tmp_path / 'robot', 'robot:bot1'), Authority().put(
        tmp_path / 'host', 'host:lab')
    assert answers(robot, host) == UNWELCOME
    # It takes that of the robot, and is not taken itself.
    (host / 'authority.pem').write_bytes((robot / 'authority.pem').read_bytes())
    assert answers(robot, host) == UNWELCOME


def test_keys_that_cannot_be_read_tell_nothing(ours, tmp_path):
    assert answers(ours.put(tmp_path / 'robot', 'robot:bot1'), tmp_path / 'none') == ANSWERS


def test_it_looks_with_the_keys_in_place(ours, tmp_path, monkeypatch):
    home = tmp_path / 'home'
    (home / '.config/mhri').mkdir(parents=True)
    ours.put(home / '.config/mhri/keys', 'host:lab')
    monkeypatch.setenv('HOME', str(home))
    monkeypatch.delenv('XDG_CONFIG_HOME', raising=False)
    robot = ours.put(tmp_path / 'robot', 'robot:bot1', 10 * DAY)
    settings = {'root_ca_certificate': str(robot / 'authority.pem'),
                'listen_private_key': str(robot / 'own.key'), 'enable_mtls': True,
                'listen_certificate': str(robot / 'own.pem')}
    endpoint = 'tls/127.0.0.1:{}'.format(free_port())
    carrier = Carrier(listen=[endpoint], secrets={
        'transport/link/tls/' + name: value for name, value in settings.items()})
    try:
        notes, answers = [LinkNote('bot1', endpoint, secret=True)], Answers()
        ask_links(answers, notes, LONG_S)
        (found,), keys = linked_of(notes, answers.by(time.monotonic() + LONG_S))
        assert found.reach == EARLY
        # The lists are missing there.
        assert isinstance(keys, KeysSeen) and 'there is no peers' in keys.problem
    finally:
        carrier.close()
