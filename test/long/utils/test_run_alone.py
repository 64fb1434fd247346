# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""mhri_run.sh joins a master with robots on it, and no master on which mhri runs already."""
import contextlib
import socket
import threading
from xmlrpc.server import SimpleXMLRPCServer

import pytest

MUX_TOPIC, SELECT, MODE = (
    '/robot_controller/twist', '/robot_controller/robot_select', '/mux_in/mode_select')


@contextlib.contextmanager
def served(**functions):
    """Serve functions by XML-RPC; gives the address."""
    server = SimpleXMLRPCServer(('127.0.0.1', 0), logRequests=False, allow_none=True)
    for name, function in functions.items():
        server.register_function(function, name)
    thread = threading.Thread(target=server.serve_forever, kwargs={'poll_interval': 0.01},
                              daemon=True)
    thread.start()
    yield 'http://127.0.0.1:{}/'.format(server.server_address[1])
    server.shutdown()
    server.server_close()
    thread.join()


@contextlib.contextmanager
def node(*topics):
    """Serve what a node answers that publishes these topics."""
    with served(getPublications=lambda caller: (1, '', [[topic, 't'] for topic in topics])) as uri:
        yield uri


@contextlib.contextmanager
def silent():
    """Listen, and answer nothing: a node that hangs, or is out of reach."""
    with socket.create_server(('127.0.0.1', 0)) as server:
        yield 'http://127.0.0.1:{}/'.format(server.getsockname()[1])


@contextlib.contextmanager
def gone():
    """Give the address of nobody: a node that was killed."""
    with socket.socket() as kept:
        kept.bind(('127.0.0.1', 0))
        yield 'http://127.0.0.1:{}/'.format(kept.getsockname()[1])


@contextlib.contextmanager
def master(muxes=(), panels=(), selecting=(), **uris):
    """Serve a master that knows these nodes; gives its address as --master takes it."""
    published = [[MUX_TOPIC, list(muxes)], [SELECT, list(panels) + list(selecting)],
                 [MODE, list(panels)], ['/bot1/odom', ['/bot1/base']]]
    state = [published, [], [['/mux/set_stop_all', list(muxes)]]]
    with served(getPid=lambda caller: (1, '', 7), getSystemState=lambda caller: (1, '', state),
                lookupNode=lambda caller, name: (1, '', uris[name.strip('/')])) as uri:
        yield uri.rstrip('/')


def check_refused(checkout, uri, names):
    status, output = checkout.run('--sim', '1', '--master', uri)
    assert status == 1, output
    last = output.strip().splitlines()[-1]
    assert uri + ': ' + names in last and ':{}'.format(int(uri.rsplit(':', 1)[1]) + 1) in last
    assert checkout.called('roslaunch') == []


def check_joined(checkout, uri):
    status, output = checkout.run('--sim', '1', '--master', uri)
    assert status == 0, output
    assert uri in output
    assert checkout.called('roslaunch')


def test_master_with_mux_and_panel_is_refused(checkout):
    with node(MUX_TOPIC) as mux, node(SELECT) as panel, \
            master(['/mux'], ['/panel'], mux=mux, panel=panel) as uri:
        check_refused(checkout, uri, '/mux and /panel')


def test_master_with_a_mux_of_another_name_is_refused(checkout):
    with node(MUX_TOPIC) as mux, master(['/old_mux'], old_mux=mux) as uri:
        check_refused(checkout, uri, '/old_mux')


def test_master_with_a_panel_in_rqt_is_refused(checkout):
    with node(SELECT) as panel, master(panels=['/rqt_gui_7'], rqt_gui_7=panel) as uri:
        check_refused(checkout, uri, '/rqt_gui_7')


def test_master_with_robots_is_joined(checkout):
    with master() as uri:
        check_joined(checkout, uri)


def test_a_labs_own_node_is_no_panel(checkout):
    with node(SELECT) as lab, master(selecting=['/lab'], lab=lab) as uri:
        check_joined(checkout, uri)


@pytest.mark.parametrize('leftover', [gone, silent, lambda: node('/chatter')],
                         ids=['killed', 'silent', 'another has its port'])
def test_leftovers_of_a_killed_run_lock_nobody_out(checkout, leftover):
    with leftover() as uri_of_both, \
            master(['/mux'], ['/panel'], mux=uri_of_both, panel=uri_of_both) as uri:
        check_joined(checkout, uri)
