# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Which addresses mhri_run.sh takes, and what it says about them and about the master."""
import os
import socket
import sys
import threading
from xmlrpc.server import SimpleXMLRPCServer

import pytest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..'))

from support.ros_system import free_port  # noqa: E402

LOOPBACK = ['ROS_HOSTNAME=127.0.0.1', 'ROS_IP=127.0.0.1']


def ros_variables(checkout):
    return [line for line in checkout.calls if line.startswith('ROS_')]


@pytest.fixture
def quiet_port():
    """Return a port of this machine where nothing listens."""
    return free_port()


@pytest.fixture
def master():
    """Return the port of something that answers as a master does."""
    server = SimpleXMLRPCServer(('127.0.0.1', 0), logRequests=False)
    server.register_function(lambda caller: (1, 'ok', 7), 'getPid')
    thread = threading.Thread(target=server.serve_forever, kwargs={'poll_interval': 0.01},
                              daemon=True)
    thread.start()
    yield server.server_address[1]
    server.shutdown()
    server.server_close()
    thread.join()


@pytest.fixture
def no_master():
    """Return the port of something that answers, but not as a master does."""
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


@pytest.mark.parametrize('addresses, arguments, ip, said', [
    ('192.0.2.7', [], '192.0.2.7', None),
    ('192.0.2.7 198.51.100.2', [], '192.0.2.7', 'several addresses (192.0.2.7 198.51.100.2)'),
    ('fd00::1 192.0.2.7 fe80::2', [], '192.0.2.7', None),
    ('192.0.2.7 198.51.100.2', ['--ip', '198.51.100.2'], '198.51.100.2', None),
    ('', ['--ip', '127.0.0.1'], '127.0.0.1', None),
    ('', ['--sim', '3'], '127.0.0.1', None),
    ('192.0.2.7', ['--sim', '3'], '127.0.0.1', None),
    ('192.0.2.7', ['--sim', '3', '--ip', '192.0.2.7'], '192.0.2.7', None),
])
def test_own_address(checkout, addresses, arguments, ip, said):
    # Port 11311 of this machine may be in use: the probe is not what this test is about.
    script = checkout.script.read_text()
    checkout.script.write_text(script.replace('  check_master\n', ''))
    status, output = checkout.run(*arguments, FAKE_ADDRESSES=addresses)
    assert status == 0, output
    assert ros_variables(checkout) == [
        'ROS_HOSTNAME=' + ip, 'ROS_IP=' + ip, 'ROS_MASTER_URI=http://{}:11311'.format(ip)]
    if said:
        assert said in output and '--ip' in output
    else:
        assert 'several' not in output


@pytest.mark.parametrize('addresses, said', [
    ('', 'this computer has no IPv4 address:'),
    ('fd00::1 fe80::2', 'no IPv4 address (only fd00::1 fe80::2, and ROS 1 needs one)'),
    ('::ffff:192.0.2.7', 'no IPv4 address'),
])
def test_no_address_is_said_with_the_remedy(checkout, addresses, said):
    status, output = checkout.run(FAKE_ADDRESSES=addresses)
    assert status == 1
    assert said in output and '--ip ADDR' in output and '--sim' in output
    assert checkout.calls == ['hostname -I'] or checkout.called('catkin_make', 'roslaunch') == []


@pytest.mark.parametrize('addresses, has', [
    ('192.0.2.7 fd00::1 192.0.2.8', '192.0.2.7 192.0.2.8 127.0.0.1'), ('', '127.0.0.1')])
def test_somebody_elses_address_is_refused(checkout, addresses, has):
    status, output = checkout.run('--ip', '198.51.100.2', FAKE_ADDRESSES=addresses)
    assert status == 2
    assert '198.51.100.2 is not an address of this computer; it has {} ('.format(has) in output
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


def test_running_master_is_joined(checkout, master):
    status, output = checkout.run('--sim', '1', '--master', 'http://127.0.0.1:{}'.format(master))
    assert status == 0, output
    assert 'a ROS master runs at' in output and 'joining it' in output
    assert checkout.called('roslaunch')


def test_port_taken_by_something_else(checkout, no_master):
    uri = 'http://127.0.0.1:{}'.format(no_master)
    status, output = checkout.run('--master', uri)
    assert status == 1
    assert 'something other than a ROS master uses ' + uri in output and '--master' in output
    assert 'end it' not in output
    assert checkout.called('roslaunch') == []


def test_master_that_does_not_answer(checkout):
    """It may be a busy master, and the other robots': nobody is told to end it."""
    with socket.create_server(('127.0.0.1', 0)) as server:
        uri = 'http://127.0.0.1:{}'.format(server.getsockname()[1])
        status, output = checkout.run('--master', uri)
    assert status == 1
    assert uri + ' takes the connection but does not answer' in output and 'ss -ltnp' in output
    assert ' end ' not in output and checkout.called('roslaunch') == []


def test_master_that_is_not_there_elsewhere(checkout):
    # 192.0.2.0/24 is for documentation: nobody answers there.
    status, output = checkout.run('--master', 'http://192.0.2.99:11311')
    assert status == 1
    assert 'there is no ROS master at http://192.0.2.99:11311' in output
    assert checkout.called('roslaunch') == []


def test_demo_has_a_master_of_its_own(checkout):
    checkout.run('--demo', FAKE_ADDRESSES='')
    checkout.run('--demo', FAKE_ADDRESSES='')
    uris = [line for line in checkout.calls if line.startswith('ROS_MASTER_URI=')]
    assert len(uris) == 2
    for uri in uris:
        assert uri.startswith('ROS_MASTER_URI=http://127.0.0.1:')
        assert not uri.endswith(':11311')
