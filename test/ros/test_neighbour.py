# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Which process may be ended: the very one that was seen, of this computer, and no other."""
import contextlib
import os
import signal
import subprocess
import sys
import time
from types import SimpleNamespace

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


NODE = """
import os, socket, time
listening = socket.create_server(('127.0.0.1', 0))
if not os.fork():
    time.sleep(600)
print(listening.getsockname()[1], flush=True)
time.sleep(600)
"""


@pytest.fixture(name='node')
def _node():
    """Return a process that listens, as a node does, and its address; its child listens, too."""
    node = subprocess.Popen([sys.executable, '-c', NODE], stdout=subprocess.PIPE,
                            start_new_session=True)
    yield node, 'http://127.0.0.1:{}/'.format(int(node.stdout.readline()))
    with contextlib.suppress(ProcessLookupError):
        os.killpg(node.pid, signal.SIGKILL)
    node.wait(60.0)
    node.stdout.close()


def test_a_node_is_known_by_its_port_even_where_it_hangs(node):
    process, uri = node
    assert process_of(uri).pid == process.pid
    process.send_signal(signal.SIGSTOP)
    assert process_of(uri).pid == process.pid


def test_nobody_is_known_where_nobody_listens(node):
    process, uri = node
    os.killpg(process.pid, signal.SIGKILL)
    process.wait(60.0)
    deadline = time.monotonic() + 60.0
    while process_of(uri) is not None:
        assert time.monotonic() < deadline, 'its child is there still'


def test_a_node_of_another_computer_names_no_process():
    assert process_of('http://192.0.2.1:11311/') is None


def test_a_node_that_was_replaced_is_learnt_even_where_the_first_question_fails(child, monkeypatch):
    """It is just starting when it is asked: the next look asks again."""
    answers = [Process(child.pid), OSError('it does not answer yet'), Process(os.getpid())]

    def ask(uri):
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


@pytest.mark.parametrize('silent_s, age_s, ended', [
    (2.0, 10.0, True), (60.0, 10.0, False), (60.0, 30.0, True)])
def test_one_that_hung_before_it_was_known_is_ended(node, monkeypatch, silent_s, age_s, ended):
    """But not one that began after the last word, unless its start takes too long."""
    process, uri = node
    monkeypatch.setattr(neighbour, 'MasterApi', lambda *_, **__: SimpleNamespace(
        node_uri=lambda name: uri))
    monkeypatch.setattr(Process, 'comes_back', lambda self: True)
    monkeypatch.setattr(Process, 'begun_s', time.clock_gettime(time.CLOCK_BOOTTIME) - age_s)
    watched = neighbour.Neighbour('the gates')
    watched.beat('/mhri_gates')
    watched._look(time.monotonic() + silent_s)
    assert watched.silent and watched.ended == ended
    if ended:
        process.wait(60.0)
    assert (process.poll() is not None) == ended
