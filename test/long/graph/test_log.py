# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A log that nobody has to wait for: what blocks, blocks its own thread alone."""
import logging
import subprocess
import sys
import threading
import time

import pytest

from mhri.graph.ros import log

from support.ros_system import wait_for


class Terminal(logging.Handler):
    """Takes lines while it is let."""

    def __init__(self):
        super().__init__()
        self.flows = threading.Event()
        self.said = []

    def emit(self, record):
        """Wait until it flows."""
        self.flows.wait()
        self.said.append(record.getMessage())


@pytest.fixture(name='logger')
def _logger():
    logger = logging.Logger('trial')
    yield logger
    logger.handlers.clear()


def test_a_blocked_terminal_holds_nobody_up_and_what_is_missing_is_said(logger):
    terminal = Terminal()
    patient = log.QueuedLogHandler(terminal, size=10)
    logger.addHandler(patient)
    begun = time.monotonic()
    for number in range(1000):
        logger.warning('line %d', number)
    assert time.monotonic() - begun < 10.0
    assert not patient.written()
    terminal.flows.set()
    wait_for(patient.written, what='the log')
    lines = [words for words in terminal.said if words.startswith('line ')]
    missing = [int(words.split()[0]) for words in terminal.said if 'missing' in words]
    assert lines[0] == 'line 0' and 10 <= len(lines) < 20
    assert sum(missing) + len(lines) == 1000


def test_a_line_says_what_was_true_when_it_was_logged(logger):
    terminal, speeds = Terminal(), [1.0]
    patient = log.QueuedLogHandler(terminal)
    logger.addHandler(patient)
    logger.warning('speeds %s', speeds)
    speeds.append(2.0)
    terminal.flows.set()
    wait_for(patient.written, what='the log')
    assert terminal.said == ['speeds [1.0]']


def test_every_handler_is_put_behind_its_own_queue_once(monkeypatch):
    terminal, other = Terminal(), logging.getLogger('trial_of_install')
    monkeypatch.setattr(log.atexit, 'register', lambda *_: None)
    monkeypatch.setattr(logging, 'lastResort', logging.lastResort)
    before = {name: list(logger.handlers) for name, logger in _loggers().items()}
    try:
        other.addHandler(terminal)
        other.addHandler(logging.NullHandler())
        assert log.install()
        assert type(other.handlers[-1]).__name__ == 'QueuedLogHandler'
        assert log.install() == []
        other.warning('said')
        terminal.flows.set()
        wait_for(lambda: terminal.said, what='the log')
    finally:
        for name, logger in _loggers().items():
            logger.handlers = before.get(name, [])


def _loggers():
    """Return {name: logger} of all there are."""
    named = logging.root.manager.loggerDict.items()
    return dict([('', logging.root)] + [(name, item) for name, item in named
                                        if isinstance(item, logging.Logger)])


@pytest.mark.parametrize('lives_on', [False, True])
def test_a_screen_outlives_its_node(lives_on):
    """Any other program is ended where its node is, and does not end by itself."""
    program = '''
import threading, rospy
from mhri.graph.ros import log
log.install(lives_on={})
rospy.signal_shutdown('its name was taken')
print(any(isinstance(thread, threading.Timer) for thread in threading.enumerate()))
'''.format(lives_on)
    done = subprocess.run([sys.executable, '-c', program], timeout=60, stdout=subprocess.PIPE,
                          universal_newlines=True)
    assert done.stdout.strip() == str(not lives_on)


def test_what_is_logged_before_there_is_a_node_holds_nobody_up():
    """Nor does it keep rospy from setting up its handlers, which asks for the lock of each."""
    program = '''
import logging, logging.config, sys, threading, rospy
from mhri.graph.ros import log
class Terminal:
    stuck = threading.Event()
    def write(self, text):
        self.stuck.set()
        threading.Event().wait()
    def flush(self):
        pass
sys.stderr = Terminal()
log.install()
rospy.logwarn('settings left out')
sys.stderr.stuck.wait()
logging.config.dictConfig({'version': 1})
print('goes on', flush=True)
'''
    done = subprocess.run([sys.executable, '-c', program], timeout=60, stdout=subprocess.PIPE)
    assert (done.stdout, done.returncode) == (b'goes on\n', 0)


def test_a_program_that_hangs_at_its_end_is_ended():
    """A thread whose traceback waits for the terminal must not keep a node, and its name."""
    program = '''
import logging, threading, time, rospy
from mhri.graph.ros import log
log.ENDED_WITHIN_S = 0.2
logging.root.addHandler(logging.StreamHandler())
log.install()
threading.Thread(target=time.sleep, args=(600.0,)).start()
rospy.signal_shutdown('the test says so')
'''
    assert subprocess.run([sys.executable, '-c', program], timeout=60).returncode == 0
