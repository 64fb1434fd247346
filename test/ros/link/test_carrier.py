# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What carries the link: endpoints, the library, and bytes between two sessions on loopback."""
import importlib

import pytest

from mhri.link.carried import COMMAND, key_of
from mhri.link.ros import carrier
from support.ros_system import free_port, wait_for


@pytest.mark.parametrize('endpoint', [
    'tcp/192.168.0.7:7447', 'tcp/robot.local:7447', 'tcp/0.0.0.0:1', 'tcp/[::]:7447'])
def test_endpoints(endpoint):
    carrier.check_endpoints('connect', [endpoint])
    with pytest.raises(carrier.CarrierError, match='tls/'):
        carrier.check_endpoints('connect', [endpoint], secret=True)


def test_endpoints_with_keys():
    carrier.check_endpoints('listen', ['tls/0.0.0.0:7447'], secret=True)
    with pytest.raises(carrier.CarrierError, match='--listen: tls/0.0.0.0:7447'):
        carrier.check_endpoints('listen', ['tls/0.0.0.0:7447'])


@pytest.mark.parametrize('secret', [False, True])
@pytest.mark.parametrize('old', ['udp', 'quic'])
def test_an_old_protocol_is_refused_with_the_remedy(old, secret):
    end = old + '/192.168.0.7:7447'
    with pytest.raises(carrier.CarrierError, match=end + '.*tls/192.168.0.7:7447 .*--keys off'):
        carrier.check_endpoints('connect', [end], secret)


@pytest.mark.parametrize('endpoint', [
    '192.168.0.7', 'tcp/192.168.0.7', 'http/192.168.0.7:80', 'tcp/192.168.0.7:99999', 'tcp/:7447',
    'tcp/a b:1', 'tcp/a:1\n', 'unixsock-stream//tmp/x'])
def test_what_is_no_endpoint_is_refused_with_the_remedy(endpoint):
    with pytest.raises(carrier.CarrierError, match='--connect: .* such as tls/'):
        carrier.Carrier(connect=[endpoint])


def test_without_the_library_it_says_what_to_do(monkeypatch):
    def missing(name):
        raise ImportError('No module named ' + name)
    monkeypatch.setattr(importlib, 'import_module', missing)
    with pytest.raises(carrier.LibraryMissing, match='mhri_run.sh.*pip3 install eclipse-zenoh=='):
        carrier.load_library()


def test_a_port_that_is_taken_is_named():
    endpoint = 'tcp/127.0.0.1:{}'.format(free_port())
    first = carrier.Carrier(listen=[endpoint])
    try:
        with pytest.raises(carrier.CarrierError, match='cannot listen on ' + endpoint):
            carrier.Carrier(listen=[endpoint])
    finally:
        first.close()


def test_bytes_arrive_whoever_came_first():
    """The one that calls waits for the other, finds it again, and hears its own robot alone."""
    endpoint = 'tcp/127.0.0.1:{}'.format(free_port())
    heard = []
    host = carrier.Carrier(connect=[endpoint])
    host.between('bot1', 'host:lab').listen('up', lambda *row: heard.append(row))
    try:
        for body in (b'first run', b'second run'):
            robot = carrier.Carrier(listen=[endpoint])
            send = robot.between('bot1', 'host:lab').sender('up', 'camera/image', COMMAND)
            others = [robot.between('bot1', 'host:lab').sender('down', 'camera/image', COMMAND),
                      robot.between('bot1', 'host:two').sender('up', 'camera/image', COMMAND)]

            def arrives():
                for other in others:
                    other(b'not for it')
                send(body)
                return ('camera/image', body) in heard
            wait_for(arrives, 60.0, 'bytes', 0.05)
            robot.close()
        assert {data for _, data in heard} == {b'first run', b'second run'}
    finally:
        host.close()


def test_what_is_larger_than_a_robot_needs_is_not_taken_in():
    """A key that may only watch had the robot hold two messages of 700 MB."""
    endpoint, heard = 'tcp/127.0.0.1:{}'.format(free_port()), []
    robot = carrier.Carrier(listen=[endpoint], max_bytes=carrier.MAX_TO_ROBOT)
    host = carrier.Carrier(connect=[endpoint])
    robot.between('bot1', 'host:lab').listen('down', lambda _, data: heard.append(len(data)))
    send = host.between('bot1', 'host:lab').sender('down', '_beat', COMMAND)
    zenoh = carrier.load_library()
    config = zenoh.Config()
    config.insert_json5('mode', '"peer"')
    config.insert_json5('connect/endpoints', '["{}"]'.format(endpoint))
    config.insert_json5('scouting/multicast/enabled', 'false')
    session = zenoh.open(config)

    def arrives():
        send(b'small')
        return 5 in heard
    try:
        wait_for(arrives, 60.0, 'a small one', 0.05)
        for size in (carrier.MAX_TO_ROBOT + 1, carrier.MAX_TO_ROBOT - 10000):
            # The carrier itself would drop them; who attacks waits.
            session.put(key_of('bot1', 'host:lab', 'down', '_beat'), bytes(size),
                        congestion_control=zenoh.CongestionControl.BLOCK)

        def goes_on():
            session.put(key_of('bot1', 'host:lab', 'down', '_beat'), bytes(1 << 20),
                        congestion_control=zenoh.CongestionControl.BLOCK)
            return 1 << 20 in heard
        wait_for(goes_on, 60.0, 'what comes behind it', 0.2)
        assert max(heard) <= carrier.MAX_TO_ROBOT
    finally:
        session.close()
        host.close()
        robot.close()
