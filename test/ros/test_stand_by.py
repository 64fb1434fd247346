# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A process that stands by takes over at once, hands signals on, and leaves nobody behind."""
import os
import signal
import subprocess
import sys

import psutil
import pytest

# Says its number; ends with 7 when it is asked to by SIGTERM or SIGHUP, with 8 by SIGINT.
PROGRAM = '''
import os, signal, sys, time
from mhri.ros import stand_by
stand_by.LEAST_LIFE_S = {least_life_s}
stand_by.stand_by('the sleepers')
def end(number, _):
    # It may come while the line below is being printed: print() in print() is an error.
    os.write(1, b'signal %d\\n' % number)
    time.sleep(0.2)
    os._exit(8 if number == signal.SIGINT else 7)
for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
    signal.signal(number, end)
print('here', os.getpid(), flush=True)
# A signal that comes just before a sleep begins is heard when that ends.
for _ in range(600):
    time.sleep(0.1)
'''


@pytest.fixture
def start():
    """Return a function that starts the program, in a group of its own."""
    begun = []

    def run(least_life_s=0.0):
        begun.append(subprocess.Popen(
            [sys.executable, '-c', PROGRAM.format(least_life_s=least_life_s)],
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True))
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
