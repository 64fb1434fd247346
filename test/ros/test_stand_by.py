# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A process that stands by takes over at once, hands signals on, and leaves nobody behind.

What hangs is ended, and nothing else.
"""
import errno
import os
import signal
import subprocess
import sys
import time

import psutil
import pytest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.realpath(__file__)), '..'))

from mhri.graph.ros import stand_by  # noqa: E402
from support.ros_system import wait_for  # noqa: E402

# Says its number; ends with 7 if SIGTERM or SIGHUP asks it to, with 8 if SIGINT does. If it is to
# beat, it does so once, and hangs from then on.
PROGRAM = '''
import os, signal, sys, time
from mhri.graph.ros import stand_by
stand_by.LEAST_LIFE_S = {least_life_s}
stand_by.HUNG_S = 0.3
beat = stand_by.stand_by('the sleepers', beats={beats})
def end(number, _):
    # It may come while the line below is being printed: print() in print() is an error.
    os.write(1, b'signal %d\\n' % number)
    time.sleep({end_s})
    os._exit(8 if number == signal.SIGINT else 7)
for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
    signal.signal(number, end)
print('here', os.getpid(), flush=True)
if {beats}:
    {beat}
# A signal that comes just before a sleep begins is heard when that ends.
for _ in range(600):
    time.sleep(0.1)
'''


@pytest.fixture
def start():
    """Return a function that starts the program, in a group of its own."""
    begun = []

    def run(least_life_s=0.0, beats=False, beat='beat()', end_s=0.2, stderr=subprocess.PIPE,
            before=''):
        begun.append(subprocess.Popen(
            [sys.executable, '-c', before + PROGRAM.format(
                least_life_s=least_life_s, beats=beats, beat=beat, end_s=end_s), '--stand-by'],
            stdout=subprocess.PIPE, stderr=stderr, text=True, start_new_session=True))
        return begun[-1]
    yield run
    for process in begun:
        process.kill()
        process.communicate(timeout=60)


def here(process):
    """Wait for the word of a new child; return its number."""
    word, number = process.stdout.readline().split()
    assert word == 'here'
    return int(number)


def test_one_that_is_killed_is_followed_by_another(start):
    process = start()
    first = here(process)
    assert first != process.pid
    for _ in range(3):
        os.kill(first, signal.SIGKILL)
        first, before = here(process), first
        assert first != before and process.poll() is None
    assert 'the sleepers: process {} was killed by signal 9'.format(before) in [
        process.stderr.readline() for _ in range(3)][-1]


@pytest.mark.parametrize('number, status', [
    (signal.SIGTERM, 7), (signal.SIGHUP, 7), (signal.SIGINT, 8)])
@pytest.mark.parametrize('send', [os.kill, os.killpg], ids=['process', 'group'])
def test_a_signal_to_end_is_handed_on_once_and_the_status_with_it(start, number, status, send):
    """Twice would break into the last zeros of a node."""
    process = start()
    here(process)
    send(process.pid, number)
    assert process.wait(60) == status
    assert process.stdout.read().split() == ['signal', str(int(number))]


def test_one_that_was_stopped_for_a_while_stands_by_as_before(start):
    """As by Ctrl-Z and fg, or a laptop that sleeps."""
    process = start(beats=True, beat='beat.end()')
    first = here(process)
    parent = psutil.Process(process.pid)
    for _ in range(3):
        parent.suspend()
        begun = time.monotonic()
        wait_for(lambda: parent.status() == psutil.STATUS_STOPPED, 60.0)
        # Longer than it waits between two looks at the beats.
        wait_for(lambda since=begun: time.monotonic() - since > 0.3, 60.0)
        parent.resume()
        wait_for(lambda: parent.status() == psutil.STATUS_SLEEPING, 60.0)
    os.kill(first, signal.SIGKILL)
    assert here(process) != first and process.poll() is None


SHORT = '''
import errno, os
from mhri.graph.ros import stand_by
fork, tries = os.fork, []
def short_of_processes():
    tries.append(0)
    if 1 < len(tries) < {enough}:
        raise BlockingIOError(errno.EAGAIN, os.strerror(errno.EAGAIN))
    return fork()
stand_by.os.fork = short_of_processes
'''


def test_where_there_is_no_room_for_another_it_comes_a_little_later(start):
    process = start(before=SHORT.format(enough=5))
    first = here(process)
    os.kill(first, signal.SIGKILL)
    assert here(process) != first
    lines = [process.stderr.readline() for _ in range(2)]
    assert 'no process can be started yet: [Errno {}]'.format(errno.EAGAIN) in lines[1]


def test_one_that_waits_for_room_can_be_ended(start):
    process = start(before=SHORT.format(enough=10 ** 6))
    os.kill(here(process), signal.SIGKILL)
    for _ in range(2):
        process.stderr.readline()
    process.send_signal(signal.SIGTERM)
    assert process.wait(60) == 128 + signal.SIGTERM


def test_no_child_outlives_its_parent(start):
    process = start()
    child = psutil.Process(here(process))
    process.kill()
    assert process.stdout.readline().split() == ['signal', str(int(signal.SIGTERM))]
    child.wait(60)


def test_one_that_is_killed_at_once_is_not_started_for_ever(start):
    process = start(least_life_s=60.0)
    os.kill(here(process), signal.SIGSEGV)
    assert process.wait(60) == 128 + signal.SIGSEGV


def test_the_child_has_a_processes_ordinary_signals(start):
    process = start()
    with open('/proc/{}/status'.format(here(process))) as stream:
        assert 'SigBlk:\t0000000000000000' in stream.read()


def test_one_that_hangs_is_ended_and_followed_by_another(start):
    process = start(beats=True)
    first = here(process)
    assert here(process) != first and process.poll() is None
    assert process.stderr.readline() == \
        'the sleepers: process {} hung and was ended, another one takes over\n'.format(first)


@pytest.mark.parametrize('beat, ask', [
    ('beat.end()', False), ('beat(); beat.end()', False), ('beat()', True)])
def test_one_that_ends_is_given_its_time(start, beat, ask):
    """Another one in its place would fight with a newer node of its name."""
    process = start(beats=True, beat=beat, end_s=1.0)
    child = here(process)
    if ask:
        os.kill(process.pid, signal.SIGTERM)
    else:
        # Long after it would have hung.
        with pytest.raises(subprocess.TimeoutExpired):
            process.wait(1.0)
        os.kill(child, signal.SIGTERM)
    assert process.wait(60) == 7
    assert process.stdout.read().split() == ['signal', str(int(signal.SIGTERM))]


@pytest.mark.parametrize('events, hung_at', [
    # (time, what the child said by then)
    ([(0.1, b'')] * 3 + [(19.9, b''), (20.1, b'')], None),
    ([(at / 10.0, b'') for at in range(1, 220)], 20.1),
    ([(at / 10.0, b'.' if at == 30 else b'') for at in range(1, 220)], 4.9),
    ([(at / 10.0, b'.' if at % 5 == 0 else b'') for at in range(1, 220)], None),
    ([(at / 10.0, b'.' if at == 5 else b'..e' if at == 10 else b'') for at in range(1, 900)], None),
    # Another thread of the node beats once more after the node's last word.
    ([(at / 10.0, b'e' if at == 10 else b'.' if at == 11 else b'') for at in range(1, 90)], None),
    # It was held up itself between two looks, and gives the child its time.
    ([(0.1, b'.'), (9.0, b''), (9.1, b''), (9.5, b''), (9.9, b'')], None),
    ([(0.1, b'.'), (9.0, b'')] + [(9.0 + at / 10.0, b'') for at in range(1, 30)], 10.9),
])
def test_what_counts_as_hung(events, hung_at):
    now = [0.0]
    hears, speaks = os.pipe()
    os.set_blocking(hears, False)
    try:
        watch, found = stand_by.Watch(hears, lambda: now[0]), None
        for now[0], said in events:
            os.write(speaks, said)
            if watch.hung() and found is None:
                found = now[0]
        assert found == hung_at
    finally:
        os.close(hears)
        os.close(speaks)


@pytest.mark.parametrize('beats', [False, True], ids=['killed', 'hung'])
def test_a_terminal_that_takes_nothing_keeps_nobody_from_taking_over(start, beats):
    reads, writes = os.pipe()
    os.set_blocking(writes, False)
    with pytest.raises(BlockingIOError):
        while True:
            os.write(writes, b'x' * 4096)
    os.set_blocking(writes, True)
    try:
        process = start(beats=beats, stderr=writes)
        first = here(process)
        if not beats:
            os.kill(first, signal.SIGKILL)
        assert here(process) != first
    finally:
        os.close(reads)
        os.close(writes)


def test_what_is_kept_is_known_to_the_next_process():
    memory = stand_by.Memory(size=64)
    assert memory.recall('robots', []) == []
    child = os.fork()
    if not child:
        memory.keep('robots', ['bot1', 'bot2', 'bot3'])
        memory.keep('limit', 0.12)
        memory.keep('robots', ['bot3', 'bot4'])
        os._exit(0)
    os.waitpid(child, 0)
    assert memory.recall('robots') == ['bot3', 'bot4'] and memory.recall('limit') == 0.12
    assert not memory.keep('robots', ['a_name_too_long'] * 10), 'no room'
    assert memory.recall('robots') == ['bot3', 'bot4'] and memory.recall('limit') == 0.12


def test_a_process_that_is_killed_while_it_writes_leaves_what_was_kept():
    memory = stand_by.Memory(size=65536)
    memory.keep('word', 'first')
    for _ in range(20):
        child = os.fork()
        if not child:
            while True:
                for letter in 'abc':
                    memory.keep('word', letter * 60000)
        time.sleep(0.01)
        os.kill(child, signal.SIGKILL)
        os.waitpid(child, 0)
        assert len(set(memory.recall('word'))) in (1, 5)
