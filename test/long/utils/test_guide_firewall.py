# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The firewall of the operator's guide, as it stands there: robots get through, others do not."""
from pathlib import Path
import re
import shutil
import socket
import subprocess
import sys

from support.checkout import REPO
import pytest

from support import machines

WHY_NOT = machines.why_not() or (
    None if shutil.which('nft') else 'there is no nft here (package nftables)')
pytestmark = pytest.mark.skipif(WHY_NOT is not None, reason=str(WHY_NOT))

MASTER, SSH = 11311, 22
CONNECT_S = 2.0
CONNECT = ('import socket, sys; '
           'socket.create_connection((sys.argv[1], int(sys.argv[2])), {})'.format(CONNECT_S))


@pytest.fixture(scope='module')
def lan(tmp_path_factory):
    """Return the network of a host that has loaded the guide's rules, a robot, and a stranger."""
    folder = tmp_path_factory.mktemp('firewall')
    guide = (REPO / 'doc' / 'guide' / 'security.md').read_text(encoding='utf-8')
    rules, = [block for block in re.findall(r'```nft\n(.*?)```', guide, re.DOTALL)
              if 'table inet mhri {' in block]
    with machines.Lan(folder) as built:
        built.known, built.stranger = built.robot('bot1'), built.robot('stranger')
        rules, changed = re.subn(r'elements = \{.*\}', 'elements = { %s }' % built.known.ip, rules)
        assert changed == 1
        built.rules = Path(folder) / 'mhri.nft'
        built.rules.write_text(rules, encoding='utf-8')
        # Twice, as after a change: it takes the place of what was there.
        for _ in range(2):
            machines.run('nft', '-f', str(built.rules))
        yield built


def listen(port):
    """Return a socket that listens on every interface, as masters and nodes do."""
    server = socket.socket()
    server.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    server.bind(('0.0.0.0', port))
    server.listen(4)
    return server


def reaches(machine, port, address=machines.HOST_IP):
    """Return whether a machine can connect to a port."""
    return subprocess.run(machine.command(sys.executable, '-c', CONNECT, address, str(port)),
                          stderr=subprocess.DEVNULL).returncode == 0


@pytest.mark.parametrize('port, stranger', [(MASTER, False), (0, False), (SSH, True)],
                         ids=['master', 'node', 'ssh'])
def test_who_reaches_the_host(lan, port, stranger):
    """A node's port is whatever the system gives out."""
    with listen(port) as server:
        port = server.getsockname()[1]
        assert reaches(lan.known, port)
        assert reaches(lan.stranger, port) == stranger
        socket.create_connection(('127.0.0.1', port), CONNECT_S).close()


def test_what_the_host_begins_is_answered(lan):
    """It connects to whomever it likes, and to itself by its own address."""
    with listen(0) as server:
        socket.create_connection((machines.HOST_IP, server.getsockname()[1]), CONNECT_S).close()
    robot = subprocess.Popen(lan.stranger.command(
        sys.executable, '-c', 'import socket; server = socket.create_server(("", 40123)); '
        'print("ready", flush=True); server.accept()[0].sendall(b"x")'), stdout=subprocess.PIPE)
    try:
        assert robot.stdout.readline() == b'ready\n'
        with socket.create_connection((lan.stranger.ip, 40123), CONNECT_S) as connection:
            assert connection.recv(1) == b'x'
    finally:
        robot.terminate()
        robot.wait(10)
