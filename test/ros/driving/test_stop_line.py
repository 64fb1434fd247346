# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The line to the mux: what is said there, and what is made of each answer."""
import io
import select
import socket
import struct
import threading
from xmlrpc.server import SimpleXMLRPCServer

import pytest
from rosgraph.network import read_ros_handshake_header, write_ros_handshake_header
from std_srvs.srv import SetBool

from mhri.driving.ros import stop_line
from mhri.driving.ros.stop_line import ROBOTS_SERVICE, STOP_SERVICE, StopLine
from mhri.srv import StopRobots

CALLER = '/somebody'
STOPPED, REFUSED, FAILED, HANGS_UP, SILENT = 'stopped', 'refused', 'failed', 'hangs up', 'silent'


def framed(message):
    """Return a message as it goes over the wire, behind its length."""
    buffer = io.BytesIO()
    message.serialize(buffer)
    return struct.pack('<I', len(buffer.getvalue())) + buffer.getvalue()


class Mux:
    """A master and a service that answers as it is told to, connection after connection."""

    def __init__(self, *answers):
        self.answers, self.headers, self.requests = list(answers), [], []
        self.known = True
        self._listening = socket.create_server(('127.0.0.1', 0))
        self._master = SimpleXMLRPCServer(('127.0.0.1', 0), logRequests=False, allow_none=True)
        self._master.register_function(self._look_up, 'lookupService')
        self.uri = 'http://127.0.0.1:{}'.format(self._master.server_address[1])
        for work in (self._serve, self._master.serve_forever):
            threading.Thread(target=work, daemon=True).start()

    def _look_up(self, caller, service):
        assert service in (STOP_SERVICE, ROBOTS_SERVICE)
        return [1, '', 'rosrpc://127.0.0.1:{}'.format(self._listening.getsockname()[1])] \
            if self.known else [-1, 'no provider', '']

    def _serve(self):
        while True:
            try:
                connection, _ = self._listening.accept()
            except OSError:
                return
            with connection:
                self._talk(connection)

    def _talk(self, connection):
        self.headers.append(read_ros_handshake_header(connection, io.BytesIO(), 4096))
        write_ros_handshake_header(connection, {'callerid': '/mux'})
        while self.answers:
            request = connection.recv(1000)
            if not request:
                return
            self.requests.append(request)
            answer = self.answers.pop(0)
            if answer == HANGS_UP:
                return
            if answer == FAILED:
                connection.sendall(struct.pack('<BI', 0, 3) + b'bad')
            elif answer != SILENT:
                connection.sendall(b'\x01' + framed(
                    SetBool._response_class(answer == STOPPED, 'a sentence')))
        connection.recv(1)

    def close(self):
        self._master.shutdown()
        self._master.server_close()
        self._listening.close()


@pytest.fixture(name='mux')
def _mux(monkeypatch):
    monkeypatch.setattr(stop_line, '_TIMEOUT_S', 60.0)
    made = []

    def make(*answers):
        made.append(Mux(*answers))
        return made[-1]
    yield make
    for each in made:
        each.close()


NOTHING = (None, 'the drive service does not answer')


@pytest.mark.parametrize('value, answers, wanted', [
    (True, [STOPPED], (True, 'a sentence')),
    (False, [STOPPED], (True, 'a sentence')),
    (True, [HANGS_UP, STOPPED], (True, 'a sentence')),
    (True, [SILENT, STOPPED], (True, 'a sentence')),
    (True, [HANGS_UP, HANGS_UP], NOTHING),
    (False, [REFUSED], (False, 'a sentence')),
    (True, [FAILED, FAILED], NOTHING),
    (False, [FAILED, STOPPED], (True, 'a sentence')),
    (('bot1', 'bot_2'), [STOPPED], (True, 'a sentence')),
    (['bot1'], [REFUSED], (False, 'a sentence')),
    ([], [REFUSED], (False, 'a sentence')),
    (['bot1'], [HANGS_UP, HANGS_UP], NOTHING),
], ids=str)
def test_what_comes_of_it(mux, monkeypatch, answers, wanted, value):
    there = mux(*answers)
    if SILENT in answers:
        monkeypatch.setattr(stop_line, '_TIMEOUT_S', 3.0)
    service, kind = (STOP_SERVICE, SetBool) if isinstance(value, bool) \
        else (ROBOTS_SERVICE, StopRobots)
    line = StopLine(CALLER, there.uri, service)
    assert line.call(value) == wanted and there.answers == []
    assert set(there.requests) == {framed(kind._request_class(value))}
    assert {header['service'] for header in there.headers} == {service}
    line.close()


def test_the_line_is_held_open(mux):
    """So the master may be lost when it matters."""
    there = mux(STOPPED, STOPPED)
    line = StopLine(CALLER, there.uri)
    assert line.fileno() is None and line.connect() and line.fileno() is not None
    there.known = False
    assert line.connect() and line.call(True)[0] and line.call(True)[0]
    header, = there.headers
    assert (header['service'], header['callerid'], header['persistent']) == (
        '/mux/set_stop_all', CALLER, '1')
    line.close()
    assert line.fileno() is None and not line.connect()


def test_a_line_that_has_ended_is_connected_anew_before_it_is_needed(mux):
    there = mux(STOPPED, HANGS_UP, STOPPED)
    line = StopLine(CALLER, there.uri)
    assert line.call(True)[0]
    with socket.fromfd(line.fileno(), socket.AF_INET, socket.SOCK_STREAM) as same:
        same.sendall(framed(SetBool._request_class(True)))
        select.select([same], [], [], 60.0)
    assert line.connect() and len(there.headers) == 2
    line.close()


def test_nobody_there():
    with socket.create_server(('127.0.0.1', 0)) as closed:
        uri = 'http://127.0.0.1:{}'.format(closed.getsockname()[1])
    line = StopLine(CALLER, uri)
    assert not line.connect() and line.call(True) == NOTHING
