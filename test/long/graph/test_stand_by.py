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

from mhri.graph.ros import stand_by
from support.ros_system import freeze, wait_for

# Says its number and that of the one before; ends with 7 if SIGTERM asks it to, with 8 if SIGINT
# does, with 0 if SIGHUP does. If it is to beat, it does so once, and hangs from then on.
PROGRAM = '''
import os, signal, sys, time
from mhri.graph.ros import stand_by
stand_by.MIN_LIFE_S = {least_life_s}
memory = stand_by.Memory(fallback={{'number': -1}})
undertaker = stand_by.stand_by('the sleepers', {hung_s}, memory)
def end(number, _):
    # It may come while the line below is being printed: print() in print() is an error.
    os.write(1, b'signal %d\\n' % number)
    {ending}
    time.sleep({end_s})
    os._exit({{signal.SIGTERM: 7, signal.SIGINT: 8, signal.SIGHUP: 0}}[number])
for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
    signal.signal(number, end)
before = memory.recall('number', 0)
memory.keep('number', os.getpid())
print('here', os.getpid(), before, flush=True)
{beat}
# A signal that comes just before a sleep begins is heard when that ends.
for _ in range(600):
    time.sleep(0.1)
'''


@pytest.fixture
def start():
    """Return a function that starts the program, in a group of its own."""
    begun = []

    def run(least_life_s=0.0, hung_s=None, beat='undertaker.beat()', end_s=0.2,
            stderr=subprocess.PIPE, before='', ending='undertaker.end()'):
        begun.append(subprocess.Popen(
            [sys.executable, '-c', before + PROGRAM.format(
                least_life_s=least_life_s, hung_s=hung_s, beat=beat, end_s=end_s, ending=ending),
             '--stand-by'],
            stdout=subprocess.PIPE, stderr=stderr, text=True, start_new_session=True))
        return begun[-1]
    yield run
    for process in begun:
        process.kill()
        process.communicate(timeout=60)


def here(process):
    """Wait for the word of a new child; return its number."""
    return both(process)[0]


def both(process):
    """Wait for the word of a new child; return its number and that of the last one it knows of."""
    word, *numbers = process.stdout.readline().split()
    assert word == 'here'
    return tuple(map(int, numbers))


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


@pytest.mark.parametrize('number, status, send', [
    (signal.SIGTERM, 7, os.kill), (signal.SIGHUP, 0, os.killpg), (signal.SIGINT, 8, os.killpg)])
def test_a_signal_to_end_is_handed_on_once_and_the_status_with_it(start, number, status, send):
    """Twice would break into the last zeros of a node."""
    process = start()
    here(process)
    send(process.pid, number)
    assert process.wait(60) == status
    assert process.stdout.read().split() == ['signal', str(int(number))]


def test_one_that_was_stopped_for_a_while_stands_by_as_before(start):
    """As by Ctrl-Z and fg, or a laptop that sleeps."""
    process = start(hung_s=0.3, beat='undertaker.end()')
    first = here(process)
    parent = psutil.Process(process.pid)
    begun = freeze(parent.pid)
    # Longer than it waits between two looks at the beats.
    wait_for(lambda: time.monotonic() - begun > 0.3, 60.0)
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


def test_one_that_fails_is_followed_by_another(start):
    process = start()
    first = here(process)
    os.kill(first, signal.SIGTERM)
    assert process.stdout.readline().split() == ['signal', str(int(signal.SIGTERM))]
    assert here(process) != first and process.poll() is None
    assert process.stderr.readline() == \
        'the sleepers: process {} failed with status 7, another one takes over\n'.format(first)


def test_those_that_fail_again_and_again_come_more_slowly_and_are_reported_no_more(start):
    process = start(least_life_s=60.0)
    for pause_s in (0.1, 0.2, 0.4, 0.4, 0.4):
        child, since = here(process), time.monotonic()
        os.kill(child, signal.SIGSEGV)
        psutil.wait_procs(psutil.Process(process.pid).children(), 60)
        wait_for(lambda: psutil.Process(process.pid).children(), 60.0, poll_s=0.01)
        assert time.monotonic() - since >= pause_s
    process.terminate()
    assert process.communicate(timeout=60)[1].count('was killed by signal 11') == 3


def test_one_that_waits_to_follow_can_be_ended(start):
    process = start(least_life_s=60.0)
    for _ in range(3):
        os.kill(here(process), signal.SIGSEGV)
        process.stderr.readline()
    process.terminate()
    assert process.wait(60) == 128 + signal.SIGTERM


@pytest.mark.parametrize('least_life_s, number, options, knows', [
    # Three that fail at once may fail by what they know: the next one does not.
    (60.0, signal.SIGSEGV, {}, [True, True, False, True, True, False]),
    (0.0, signal.SIGSEGV, {}, 4 * [True]),
    # They live for long, and never work.
    (0.0, signal.SIGSEGV, {'hung_s': 60.0, 'beat': ''}, [True, True, False, True]),
    (60.0, signal.SIGKILL, {}, 4 * [True])])
def test_what_was_kept_is_forgotten_when_three_that_knew_it_have_failed_soon(
        start, least_life_s, number, options, knows):
    process = start(least_life_s, **options)
    before = here(process)
    for known in knows:
        os.kill(before, number)
        now, kept = both(process)
        assert kept == (before if known else -1)
        before = now


def test_those_that_ended_before_they_recalled_anything_are_no_reason_to_forget_it():
    """They may have found no master."""
    memory = stand_by.Memory()
    memory.keep('number', 1)
    for _ in range(2 * stand_by.MAX_RECALLS):
        memory.on_failure(True)
    assert memory.recall('number') == 1
    for soon in (True, True, False, True, True):
        assert memory.recall('number') == 1
        memory.on_failure(soon)
    assert memory.recall('number') == 1
    memory.on_failure(True)
    assert memory.recall('number') is None


def test_the_child_has_a_processes_ordinary_signals(start):
    process = start()
    with open('/proc/{}/status'.format(here(process))) as stream:
        assert 'SigBlk:\t0000000000000000' in stream.read()


def test_one_that_hangs_is_ended_and_followed_by_another(start):
    process = start(hung_s=0.3)
    first = here(process)
    assert here(process) != first and process.poll() is None
    assert process.stderr.readline() == \
        'the sleepers: process {} hung and was ended, another one takes over\n'.format(first)


@pytest.mark.parametrize('beat, ask', [
    ('undertaker.end()', False), ('undertaker.beat(); undertaker.end()', False),
    ('undertaker.beat()', True)])
def test_one_that_ends_is_given_its_time(start, beat, ask):
    """Another one in its place would fight with a newer node of its name."""
    # One that beats is asked before it has hung.
    process = start(hung_s=2.0 if ask else 0.3, beat=beat, end_s=3.0 if ask else 1.0)
    child = psutil.Process(here(process))
    if not ask:
        # Long after it would have hung.
        with pytest.raises(subprocess.TimeoutExpired):
            process.wait(1.0)
        child.send_signal(signal.SIGHUP)
        wait_for(lambda: not child.is_running(), 60.0)
        assert process.stderr.readline() == \
            'the sleepers: process {} has ended; it is not started again\n'.format(child.pid)
        # Nor does the parent end: roslaunch would start it again.
        with pytest.raises(subprocess.TimeoutExpired):
            process.wait(0.5)
    process.terminate()
    assert process.wait(60) == (7 if ask else 0)
    assert process.stdout.read().split() == [
        'signal', str(int(signal.SIGTERM if ask else signal.SIGHUP))]


def test_one_that_hangs_while_it_ends_is_ended(start):
    """Its robots would have no zero; and whoever asked it to end would wait for ever."""
    process = start(hung_s=2.0, ending='', end_s=60.0)
    here(process)
    process.terminate()
    assert process.wait(60) == 128 + signal.SIGKILL


LOOKS = [round(0.025 * look, 3) for look in range(1, 900)]


@pytest.mark.parametrize('beats, ends_at, asleep, hung_at', [
    # times of the beats; when it says that it ends; from when to when nobody looks
    ((), 99.0, (0.0, 0.0), 20.0),
    ((3.0,), 99.0, (0.0, 0.0), 3.5),
    (range(1, 23), 99.0, (0.0, 0.0), 1.5),
    ([0.4 * beat for beat in range(60)], 99.0, (0.0, 0.0), None),
    ((1.0,), 1.0, (0.0, 0.0), None),
    # Another thread of the node beats once more after the node's last word.
    ((1.0, 1.1), 1.0, (0.0, 0.0), None),
    # The process that looks was held up itself, and gives the child its time.
    ((3.0,), 99.0, (3.2, 3.26), 3.5),
    ((3.0,), 99.0, (3.2, 3.3), 3.8),
    ((3.0,), 99.0, (3.2, 9.0), 9.5)])
def test_what_counts_as_hung(beats, ends_at, asleep, hung_at):
    now = [0.0]
    watch, found = stand_by.Watch(0.5, lambda: now[0]), None
    for now[0] in LOOKS:
        if asleep[0] < now[0] < asleep[1]:
            continue
        count = sum(1e-6 < at <= now[0] + 1e-6 for at in beats)
        if watch.hung(count, now[0] >= ends_at):
            found = now[0]
            break
    assert found == hung_at or found is not None and 0.0 < found - hung_at < 0.06


@pytest.mark.parametrize('hung_s', [None, 0.3], ids=['killed', 'hung'])
def test_a_terminal_that_takes_nothing_keeps_nobody_from_taking_over(start, hung_s):
    reads, writes = os.pipe()
    os.set_blocking(writes, False)
    with pytest.raises(BlockingIOError):
        while True:
            os.write(writes, b'x' * 4096)
    os.set_blocking(writes, True)
    try:
        process = start(hung_s=hung_s, stderr=writes)
        first = here(process)
        if not hung_s:
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
