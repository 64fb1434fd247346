# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Whatever answers in the place of the master: a named error, and every thread goes on asking."""
import http.server
import threading
import time
import xmlrpc.client

import pytest
import rospy

from mhri.driving.ros.known_robots import KnownRobots
from mhri.graph.ros.master_api import MasterApi, MasterError
from mhri.graph.ros.service_owner import ServiceOwner
from mhri.graph.ros.stand_by import Memory

from support.ros_system import wait_for


def said(*values):
    """Return the body of an answer of XML-RPC."""
    return xmlrpc.client.dumps(values, methodresponse=True, allow_none=True).encode()


BODIES = {
    'nothing': b'', 'no xml': b'<<<>>>', 'torn': said([1, '', 5])[:80], 'html': b'<html></html>',
    'no text': b'\xff\xfe\0\0', 'another document': b'<?xml version="1.0"?><a><b/></a>',
    'bad int': said([1, '', 7]).replace(b'<int>7<', b'<int>x<'),
    'bad date': said([1, '', 7]).replace(b'int>7</int', b'dateTime.iso8601>z</dateTime.iso8601'),
    'bad base64': said([1, '', 7]).replace(b'int>7</int', b'base64>%</base64'),
    'unknown type': said([1, '', 7]).replace(b'int>7</int', b'goo>7</goo'),
    'two values': said([1, 2]), 'a number': said(5), 'a text': said('abc'), 'none': said(None),
    'four': said([1, '', {}, 4]), 'a struct': said({'faultCode': 'x'}),
    'a list of odd things': said([[1, 2, 3, 4], 5, 'x', None, {'faultCode': 1}]),
    'answers of the wrong shape': said([[[1, '', 5], [1, '', ['a', 5]], [1, '', {'x': [1]}]]]),
    'robots of all types': said([[[1, '', ['bot1', 5, None, {}]], [1, '', 7.5], [1, '', []]]]),
}


@pytest.fixture
def master(monkeypatch):
    """A server that answers everything with one body; ``asked`` counts."""
    class Handler(http.server.BaseHTTPRequestHandler):
        protocol_version = 'HTTP/1.1'

        def do_POST(self):  # noqa: N802
            self.rfile.read(int(self.headers['Content-Length']))
            server.asked += 1
            self.send_response(200)
            self.send_header('Content-Type', 'text/xml')
            self.send_header('Content-Length', str(len(server.body)))
            self.end_headers()
            self.wfile.write(server.body)

        def log_message(self, *_):
            pass

    server = http.server.ThreadingHTTPServer(('127.0.0.1', 0), Handler)
    server.daemon_threads = True
    server.asked = 0
    server.uri = 'http://127.0.0.1:{}'.format(server.server_port)
    monkeypatch.setenv('ROS_MASTER_URI', server.uri)
    threading.Thread(target=server.serve_forever, kwargs={'poll_interval': 0.01},
                     daemon=True).start()
    yield server
    server.shutdown()
    server.server_close()


@pytest.mark.parametrize('kind', sorted(BODIES))
def test_an_answer_of_any_kind_is_a_value_or_the_named_error(master, kind):
    master.body = BODIES[kind]
    api = MasterApi('/test', uri=master.uri)
    for ask in (lambda: api.call('getSystemState'),
                lambda: api.call_many([('getParam', '/a'), ('getParam', '/b')])):
        try:
            ask()
        except MasterError as error:
            assert master.uri in str(error) and len(str(error)) < 400


def alive(name):
    """Return whether a thread runs."""
    return any(thread.name == name for thread in threading.enumerate())


@pytest.mark.parametrize('kind', sorted(BODIES))
def test_roster_and_in_force_go_on_asking(master, monkeypatch, kind):
    master.body = BODIES[kind]
    done = threading.Event()
    monkeypatch.setattr(rospy, 'is_shutdown', done.is_set)
    rospy.rostime.set_rostime_initialized(True)
    monkeypatch.setattr('mhri.driving.ros.known_robots.PERIOD_S', 0.02)
    known = KnownRobots({}, lambda *_: None, lambda name: None, lambda: 5, Memory(), dict,
                        lambda *_: None, dict, lambda *_: None, dict).start()
    owner = ServiceOwner('/service').start()
    try:
        for _ in range(3):
            asked = master.asked
            known.check(['bot1', 'x{}'.format(asked)])
            wait_for(lambda: master.asked >= asked + 3, 20.0, 'more questions')
            assert alive('known_robots') and alive('owner of /service')
            time.sleep(0.01)
    finally:
        done.set()
        owner.stop()
        wait_for(lambda: not alive('known_robots') and not alive('owner of /service'), 20.0,
                 'the end')
