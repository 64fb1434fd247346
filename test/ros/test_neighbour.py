# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Which process may be ended: the very one that was seen, of this computer, and no other."""
import os
import socket
import subprocess
import sys
import threading
from types import SimpleNamespace
from xmlrpc.server import SimpleXMLRPCServer

import pytest

from mhri.ros.driving import neighbour
from mhri.ros.driving.neighbour import Process, process_of


@pytest.fixture(name='child')
def _child():
    child = subprocess.Popen([sys.executable, '-c', 'input()'], stdin=subprocess.PIPE)
    yield child
    child.kill()
    child.wait()
    child.stdin.close()


def test_a_process_that_is_still_the_same_is_ended(child):
    process = Process(child.pid)
    assert process.is_there() and process.end()
    assert child.wait(60.0) == -9


def test_one_that_has_gone_is_not(child):
    process = Process(child.pid)
    child.kill()
    child.wait()
    assert not process.is_there() and not process.end()
    with pytest.raises(OSError):
        Process(child.pid)


def test_another_one_of_the_same_number_is_not(child):
    """It began at another time, or belongs to somebody else."""
    process = Process(child.pid)
    process.parent += 1
    assert not process.end() and child.poll() is None


def test_never_itself():
    assert not Process(os.getpid()).end()


def test_what_no_launcher_started_does_not_come_back(child):
    assert not Process(child.pid).comes_back()


@pytest.mark.parametrize('shell', [False, True])
def test_what_a_launcher_started_comes_back_through_a_shell_as_well(tmp_path, shell):
    launcher = tmp_path / 'roslaunch'
    command = "[sys.executable, '-c', 'print(__import__(\"os\").getpid(), flush=True); input()']"
    if shell:
        command = "['bash', '-c', '\"$@\"; true', 'restarter', *{}]".format(command)
    launcher.write_text('import subprocess, sys\nsubprocess.call({})\n'.format(command))
    parent = subprocess.Popen([sys.executable, str(launcher)], stdin=subprocess.PIPE,
                              stdout=subprocess.PIPE)
    try:
        assert Process(int(parent.stdout.readline())).comes_back()
    finally:
        parent.stdin.close()
        parent.wait(60.0)
        parent.stdout.close()


@pytest.fixture(name='node')
def _node():
    """Answer getPid as a node does; ``server.pid`` is what it says."""
    server = SimpleXMLRPCServer(('127.0.0.1', 0), logRequests=False)
    server.pid = os.getpid()
    server.register_function(lambda caller: (1, '', server.pid), 'getPid')
    threading.Thread(target=server.serve_forever, daemon=True).start()
    yield server
    server.shutdown()
    server.server_close()


def _uri(node):
    return 'http://127.0.0.1:{}/'.format(node.server_address[1])


def test_a_node_is_known_by_its_number_and_its_port(node, child):
    assert process_of(_uri(node), '/test').pid == os.getpid()
    node.pid = child.pid
    assert process_of(_uri(node), '/test') is None, 'another one has the port: a container'


@pytest.mark.parametrize('answer', ['12', None, -1])
def test_a_number_that_is_none_names_no_process(node, answer):
    node.pid = answer
    try:
        assert process_of(_uri(node), '/test') is None
    except OSError:
        pass


def test_a_node_of_another_computer_names_no_process():
    assert process_of('http://192.0.2.1:11311/', '/test') is None


def test_a_node_that_does_not_answer_is_said():
    with socket.socket() as deaf:
        deaf.bind(('127.0.0.1', 0))
        deaf.listen(1)
        with pytest.raises(OSError, match='does not answer'):
            process_of('http://127.0.0.1:{}/'.format(deaf.getsockname()[1]), '/test', 0.2)


def test_a_node_that_was_replaced_is_learnt_even_where_the_first_question_fails(child, monkeypatch):
    """It is just starting when it is asked: the next look asks again."""
    answers = [Process(child.pid), OSError('it does not answer yet'), Process(os.getpid())]

    def ask(uri, caller_id):
        """Answer as the node of that moment does."""
        answer = answers.pop(0)
        if isinstance(answer, OSError):
            raise answer
        return answer

    monkeypatch.setattr(neighbour, 'process_of', ask)
    monkeypatch.setattr(neighbour, 'MasterApi', lambda *_, **__: SimpleNamespace(
        node_uri=lambda name: 'http://127.0.0.1:1/'))
    watched = neighbour.Neighbour('the gates')
    watched._learn('/mhri_gates', 0.0, 0.0)
    child.kill()
    child.wait()
    for now in (2.0, 4.0):
        watched._learn('/mhri_gates', now, now)
    assert not answers, 'it was asked once, and never again'
