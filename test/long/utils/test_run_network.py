# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Which addresses mhri_run.sh takes, and what it says about them and about the master."""
import contextlib
import socket
import threading

import pytest

from support.ros_system import free_port

LOOPBACK = ['ROS_HOSTNAME=127.0.0.1', 'ROS_IP=127.0.0.1']


def ros_variables(checkout):
    return [line for line in checkout.calls if line.startswith('ROS_')]


@pytest.fixture
def quiet_port():
    """Return a port of this machine where nothing listens."""
    return free_port()


@contextlib.contextmanager
def stranger():
    """Give the port of something that answers, but not as a master does."""
    server = socket.create_server(('127.0.0.1', 0))

    def answer():
        while True:
            try:
                with server.accept()[0] as connection:
                    connection.recv(4096)
                    connection.sendall(b'SSH-2.0-none\r\n')
            except OSError:
                return
    threading.Thread(target=answer, daemon=True).start()
    yield server.getsockname()[1]
    server.shutdown(socket.SHUT_RDWR)
    server.close()


@pytest.mark.parametrize('addresses, arguments, ip, several', [
    ('192.0.2.7 198.51.100.2', [], '192.0.2.7', True),
    ('fd00::1 192.0.2.7 fe80::2', [], '192.0.2.7', False),
    ('192.0.2.7 198.51.100.2', ['--ip', '198.51.100.2'], '198.51.100.2', False),
    ('', ['--sim', '3'], '127.0.0.1', False),
    ('192.0.2.7', ['--sim', '3', '--ip', '192.0.2.7'], '192.0.2.7', False),
])
def test_own_address(checkout, addresses, arguments, ip, several):
    # Port 11311 of this machine may be in use: the probe is not what this test is about.
    script = checkout.script.read_text()
    checkout.script.write_text(script.replace('  check_master\n', ''))
    status, output = checkout.run(*arguments, FAKE_ADDRESSES=addresses)
    assert status == 0, output
    assert ros_variables(checkout) == [
        'ROS_HOSTNAME=' + ip, 'ROS_IP=' + ip, 'ROS_MASTER_URI=http://{}:11311'.format(ip)]
    assert ('({})'.format(addresses) in output) == several


@pytest.mark.parametrize('addresses', ['', 'fd00::1 ::ffff:192.0.2.7'])
def test_no_address_is_said_with_the_remedy(checkout, addresses):
    status, output = checkout.run(FAKE_ADDRESSES=addresses)
    assert status == 1
    assert addresses in output and '--ip ADDR' in output and '--sim' in output
    assert checkout.calls == ['hostname -I'] or checkout.called('catkin_make', 'roslaunch') == []


def test_somebody_elses_address_is_refused(checkout):
    status, output = checkout.run('--ip', '198.51.100.2',
                                  FAKE_ADDRESSES='192.0.2.7 fd00::1 192.0.2.8')
    assert status == 2
    assert '198.51.100.2' in output and '192.0.2.7 192.0.2.8 127.0.0.1' in output
    assert [call for call in checkout.calls if call != 'hostname -I'] == []


def test_address_that_leads_here_is_taken(checkout):
    """As where a router translates it: the computer has it on none of its interfaces."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
        try:
            sock.connect(('192.0.2.1', 9))
        except OSError:
            pytest.skip('this machine has no address but the loopback')
        own = sock.getsockname()[0]
    script = checkout.script.read_text()
    checkout.script.write_text(script.replace('  check_master\n', ''))
    status, output = checkout.run('--ip', own, FAKE_ADDRESSES='192.0.2.7')
    assert status == 0, output
    assert 'ROS_IP=' + own in checkout.calls


def test_what_the_shell_had_is_not_used(checkout, quiet_port):
    uri = 'http://127.0.0.1:{}'.format(quiet_port)
    status, output = checkout.run('--master', uri, ROS_MASTER_URI='http://elsewhere:1',
                                  ROS_IP='203.0.113.9', ROS_HOSTNAME='elsewhere')
    assert status == 0, output
    assert ros_variables(checkout) == LOOPBACK + ['ROS_MASTER_URI=' + uri]


def test_port_taken_by_something_else(checkout):
    with stranger() as port:
        uri = 'http://127.0.0.1:{}'.format(port)
        status, output = checkout.run('--master', uri)
    assert status == 1
    assert uri in output and '--master' in output
    assert checkout.called('roslaunch') == []


def test_master_that_does_not_answer(checkout):
    """It may be a busy master, and the other robots': nobody is told to end it."""
    with socket.create_server(('127.0.0.1', 0)) as server:
        uri = 'http://127.0.0.1:{}'.format(server.getsockname()[1])
        status, output = checkout.run('--master', uri)
    assert status == 1
    assert uri in output and 'ss -ltnp' in output
    assert ' end ' not in output and checkout.called('roslaunch') == []


def test_master_that_is_not_there_elsewhere(checkout):
    # 192.0.2.0/24 is for documentation: nobody answers there.
    status, output = checkout.run('--master', 'http://192.0.2.99:11311')
    assert status == 1
    assert 'http://192.0.2.99:11311' in output
    assert checkout.called('roslaunch') == []


def test_demo_has_a_master_of_its_own(checkout):
    checkout.run('--demo', FAKE_ADDRESSES='')
    uri, = [line for line in checkout.calls if line.startswith('ROS_MASTER_URI=')]
    name, _, port = uri.rpartition(':')
    assert name == 'ROS_MASTER_URI=http://127.0.0.1' and 12000 <= int(port) < 32768
