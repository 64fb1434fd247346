# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""turtle_check.py: what is said of each thing that can be wrong."""
import importlib.util
import os
import socket
import subprocess
import sys
import threading
from xmlrpc.client import ServerProxy
from xmlrpc.server import SimpleXMLRPCRequestHandler, SimpleXMLRPCServer

from support.checkout import REPO
from support.ros_system import wait_for
import pytest
from test_run_network import stranger

PATH = REPO / 'utils' / 'remote' / 'turtle_check.py'
SPEC = importlib.util.spec_from_file_location('turtle_check', str(PATH))
turtle_check = importlib.util.module_from_spec(SPEC)
SPEC.loader.exec_module(turtle_check)
HOST = '127.0.0.1'


class MortalHandler(SimpleXMLRPCRequestHandler):
    """Answers no more once the server has answered the call that is its last."""

    def do_POST(self):  # noqa: N802 (the name is http.server's)
        if not self.server.ended:
            super().do_POST()


class FakeMaster:
    """A master as far as a robot asks it; each test makes one thing of it wrong."""

    def __init__(self):
        self.params, self.nodes, self.subscribers, self.calls_back = {'/run_id': 'x'}, {}, {}, True
        self.server = SimpleXMLRPCServer((HOST, 0), MortalHandler, logRequests=False,
                                         allow_none=True)
        self.server.ended = False
        self.port = self.server.server_address[1]
        for name in ('getPid', 'getParam', 'getParamNames', 'setParam', 'deleteParam',
                     'subscribeParam', 'unsubscribeParam', 'lookupNode', 'getSystemState'):
            self.server.register_function(getattr(self, name))
        self.thread = threading.Thread(target=self.server.serve_forever, daemon=True,
                                       kwargs={'poll_interval': 0.01})
        self.thread.start()

    def close(self):
        self.server.shutdown()
        self.server.server_close()
        self.thread.join()

    def end_after(self, call):
        """Answer this call and then nothing any more."""
        def last(*arguments):
            self.server.ended = True
            return getattr(self, call)(*arguments)
        self.server.register_function(last, call)

    def getPid(self, _):  # noqa: N802 (names of the master's)
        return 1, '', 77

    def getParam(self, _, key):  # noqa: N802
        return (1, '', self.params[key]) if key in self.params else (-1, 'not set', 0)

    def setParam(self, _, key, value):  # noqa: N802
        self.params[key] = value
        if key in self.subscribers and self.calls_back:
            ServerProxy(self.subscribers[key]).paramUpdate('/master', key, value)
        return 1, '', 0

    def getParamNames(self, _):  # noqa: N802
        return 1, '', list(self.params)

    def deleteParam(self, _, key):  # noqa: N802
        for name in list(self.params):
            if (name + '/').startswith(key + '/'):
                del self.params[name]
        return 1, '', 0

    def subscribeParam(self, _, api, key):  # noqa: N802
        self.subscribers[key] = api
        return 1, '', {}

    def unsubscribeParam(self, _, api, key):  # noqa: N802
        assert self.subscribers.pop(key) == api
        return 1, '', 1

    def lookupNode(self, _, node):  # noqa: N802
        return (1, '', self.nodes[node]) if node in self.nodes else (-1, 'unknown', '')

    def getSystemState(self, _):  # noqa: N802
        return 1, '', [[['/some/topic', sorted(self.nodes)]], [], []]


@pytest.fixture
def master(monkeypatch):
    monkeypatch.setattr(turtle_check, 'TIMEOUT_S', 60.0)
    before = socket.getdefaulttimeout()
    socket.setdefaulttimeout(60.0)  # as main() does
    fake = FakeMaster()
    yield fake
    fake.close()
    socket.setdefaulttimeout(before)


@pytest.fixture
def silence(master, monkeypatch):
    """Wait but a moment for what does not come."""
    monkeypatch.setattr(turtle_check, 'TIMEOUT_S', 1.0)
    socket.setdefaulttimeout(2.0)


@pytest.fixture
def listener():
    """Return the port of something that accepts connections, as a node that lives does."""
    with socket.socket() as sock:
        sock.bind((HOST, 0))
        sock.listen(5)
        yield sock.getsockname()[1]


def check(master, name='bot1', own=HOST):
    turtle_check.check_host(HOST, master.port, own, name)


def problem(master, **keywords):
    """Return what is said of a host."""
    with pytest.raises(turtle_check.Problem) as raised:
        check(master, **keywords)
    return str(raised.value)


def test_host_that_is_right(master):
    check(master)
    assert master.params == {'/run_id': 'x'} and master.subscribers == {}


def test_bare_rosmaster_gets_a_run_id(master, monkeypatch):
    monkeypatch.setattr(turtle_check, 'RUN_ID_TIMEOUT_S', 0.0)
    master.params = {}
    check(master)
    assert list(master.params) == ['/run_id']


def test_no_master_on_the_host(master):
    with socket.socket() as sock:
        sock.bind((HOST, 0))
        port = sock.getsockname()[1]
        with pytest.raises(turtle_check.Problem, match='{}.*mhri_run.sh --ip {}'.format(
                port, HOST)):
            turtle_check.check_host(HOST, port, HOST, 'bot1')


def test_something_else_has_the_port(master):
    with stranger() as port, pytest.raises(turtle_check.Problem, match='--port') as raised:
        turtle_check.check_host(HOST, port, HOST, 'bot1')
    assert 'end it' not in str(raised.value)


@pytest.mark.parametrize('call', ['getPid', 'subscribeParam', 'setParam', 'unsubscribeParam',
                                  'lookupNode', 'getSystemState'])
def test_master_that_ends_meanwhile(master, silence, call):
    master.nodes['/rosout'] = 'http://{}:1/'.format(HOST)
    master.end_after(call)
    assert HOST in problem(master)


def test_master_that_does_not_answer(silence, listener):
    """It may be a busy master: that nobody is told to end it."""
    with pytest.raises(turtle_check.Problem) as raised:
        turtle_check.check_host(HOST, listener, HOST, 'bot1')
    said = str(raised.value)
    assert ' end ' not in said and 'sport = :{}'.format(listener) in said


def test_host_that_does_not_reach_back(master, silence):
    master.calls_back = False
    said = problem(master)
    assert '127.0.0.1' in said and '--ip ADDR' in said
    assert master.params == {'/run_id': 'x'} and master.subscribers == {}


def test_address_that_is_not_the_robots(master):
    # 192.0.2.0/24 is for documentation.
    assert '192.0.2.201' in problem(master, own='192.0.2.201')


def test_host_whose_nodes_are_for_itself_alone(master):
    master.nodes['/mux'] = 'http://127.0.0.1:4711/'
    with pytest.raises(turtle_check.Problem, match='mhri_run.sh --ip 10.0.0.1'):
        turtle_check.check_names_of_host(
            ServerProxy('http://{}:{}'.format(HOST, master.port)), '10.0.0.1', '10.0.0.7')
    check(master)


def test_host_whose_name_is_not_known(master):
    master.nodes['/rosout'] = 'http://no-such-host.invalid:4711/'
    said = problem(master)
    assert 'no-such-host.invalid (/rosout)' in said and 'mhri_run.sh --ip ' + HOST in said


def test_name_that_is_taken(master, listener):
    master.nodes['/bot1/mobile_base'] = 'http://{}:{}/'.format(HOST, listener)
    assert '(/bot1/mobile_base)' in problem(master)
    master.nodes['/bot1/mobile_base'] = 'http://localhost:{}/'.format(listener)
    assert '/bot1/mobile_base runs at localhost' in problem(master)
    check(master, name='bot'), check(master, name='bot11')


def test_leftovers_of_a_robot_that_is_gone_do_not_hold_its_name(master):
    with socket.socket() as sock:
        sock.bind((HOST, 0))
        master.nodes['/bot1/mobile_base'] = 'http://{}:{}/'.format(HOST, sock.getsockname()[1])
        check(master)


def test_a_new_master_is_noticed(master, monkeypatch):
    monkeypatch.setattr(turtle_check, 'WATCH_EVERY_S', 0.01)
    claim = turtle_check.Claim(HOST, master.port, 'bot1', 'me')
    claim.make()
    assert claim.state() is True
    watcher = threading.Thread(target=claim.watch, daemon=True)
    watcher.start()
    watcher.join(0.3)
    assert watcher.is_alive()
    del master.params['/bot1/mhri_remote']
    watcher.join(20)
    assert not watcher.is_alive()


def test_a_silent_master_is_not_a_new_one(master, monkeypatch, capsys):
    monkeypatch.setattr(turtle_check, 'WATCH_EVERY_S', 0.01)
    states = iter([True, None, None, None, False, True, None, True, False, False])
    claim = turtle_check.Claim(HOST, master.port, 'bot1', 'me')
    monkeypatch.setattr(claim, 'state', lambda: next(states))
    claim.watch()
    assert list(states) == []
    said = capsys.readouterr().err
    assert len(said.splitlines()) == 2


def test_release_leaves_another_runs_note(master):
    master.params.update({'/bot1/mhri_remote': 'other', '/bot1/robot_type': 'turtlebot2'})
    turtle_check.Claim(HOST, master.port, 'bot1', 'me').give_up()
    assert set(master.params) == {'/run_id', '/bot1/mhri_remote', '/bot1/robot_type'}


@pytest.mark.parametrize('before', [
    {}, {'/bot1/label': 'x'}, {'/bot1/limits/linear_mps': 0.1}, {'/bot11/robot_type': 'generic'}])
def test_release_takes_what_the_robot_brought_and_nothing_else(master, before):
    master.params.update(before)
    brought = {'/bot1/robot_type': 'turtlebot2', '/bot1/tf_prefix': 'bot1',
               '/bot1/mobile_base/odom_frame': 'bot1/odom', '/bot1/limits/angular_rad_s': 1.0}
    # The first run is killed, and its leftovers are none of the host's.
    for token, ends in (('killed', False), ('me', True)):
        claim = turtle_check.Claim(HOST, master.port, 'bot1', token)
        claim.make()
        master.params.update(brought)
        if ends:
            master.params['/bot1/mhri/command'] = 'said while it ran'
            claim.give_up()
    assert master.params == dict(before, **{'/run_id': 'x',
                                            '/bot1/mhri/command': 'said while it ran'})


def test_wrong_things_are_one_line_and_status_1(master):
    master.nodes['/rosout'] = 'http://no-such-host.invalid:4711/'
    done = subprocess.run([sys.executable, str(PATH), 'host', HOST, str(master.port), HOST, 'bot1'],
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          universal_newlines=True, timeout=300)
    assert done.returncode == 1
    assert done.stdout.startswith('mhri: ') and done.stdout.count('\n') == 1


@pytest.mark.parametrize('arguments', [
    [], ['host'], ['nonsense'], ['host', '', '11311', HOST, 'bot1'], ['hold'],
    ['host', HOST, '', HOST, 'bot1'], ['host', HOST, '99999', HOST, 'bot1'],
    ['host', HOST, '11311\n', HOST, 'bot1'], ['host', HOST + '\n', '1', HOST, 'bot1'],
    ['watch', HOST, 'port', 'bot1', 'me'], ['release', '\x1b[2J' * 10000, '1', 'bot1', 'me']])
def test_wrong_command_lines_are_one_line_and_status_1(arguments):
    done = subprocess.run([sys.executable, str(PATH)] + arguments, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, universal_newlines=True, timeout=300)
    assert done.returncode == 1 and done.stdout.startswith('mhri: '), done.stdout
    assert done.stdout[:-1].isprintable() and len(done.stdout) <= 600


def test_what_a_master_says_is_shown_safely(master, listener):
    node = '/bot1/\x7f\x9b2J\u202e' + 'x' * 100000
    master.nodes[node] = 'http://{}:{}/'.format(HOST, listener)
    done = subprocess.run([sys.executable, str(PATH), 'host', HOST, str(master.port), HOST, 'bot1'],
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          universal_newlines=True, timeout=300)
    assert done.returncode == 1 and done.stdout.startswith('mhri: ')
    assert done.stdout[:-1].isprintable() and len(done.stdout) <= 600


def running(pid):
    """Return whether a process runs."""
    try:
        with open('/proc/{}/stat'.format(pid)) as file:
            return file.read().rpartition(')')[2].split()[0] != 'Z'
    except OSError:
        return False


@pytest.fixture
def shell(tmp_path):
    """Return what has a shell run a line; it returns the shell, and the process that it names."""
    shells = []

    def run(line, **environment):
        ready = tmp_path / 'pid'
        shells.append(subprocess.Popen(
            ['bash', '-c', line + ' & wait', sys.executable, str(PATH), str(ready)],
            env=dict(os.environ, **environment)))
        wait_for(lambda: ready.exists() and ready.read_text().strip(), 60.0, 'the process')
        return shells[-1], int(ready.read_text())
    yield run
    for one in shells:
        one.kill()
        one.wait()


def test_held_command_ends_with_its_parent(shell):
    """The shell in between is killed; what it held has to go as well."""
    process, pid = shell('"$0" "$1" hold $$ bash -c \'echo $$ >"$0"; exec sleep 600\' "$2"')
    process.kill()
    wait_for(lambda: not running(pid), 60.0, 'the end of the held command')


def test_a_command_whose_parent_was_killed_before_it_was_held_never_runs(tmp_path):
    ran = tmp_path / 'ran'
    assert subprocess.call([sys.executable, str(PATH), 'hold', '1', 'touch', str(ran)]) == 1
    assert not ran.exists()


def test_where_the_script_is_killed_what_ignores_the_signal_is_killed(shell):
    watch = ('import sys; sys.path.insert(0, sys.argv[1].rpartition("/")[0]); import turtle_check; '
             'turtle_check.END_S = 0.2; '
             'turtle_check.watch("127.0.0.1", 1, "bot1", sys.argv[2])')
    stays = ('import os, signal, sys, time; signal.signal(signal.SIGTERM, signal.SIG_IGN); '
             'print(os.getpid(), flush=True); time.sleep(600)')
    process, pid = shell(
        '(MHRI_REMOTE_ID=$$-1 "$0" -c "$STAYS" >"$2" &); "$0" -c "$WATCH" "$1" "$$-1"',
        WATCH=watch, STAYS=stays)
    process.kill()
    wait_for(lambda: not running(pid), 60.0, 'the end of what was left')
