# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A ROS system of a test's own: its master, its nodes, its screen; it ends what it started."""
import contextlib
import os
import random
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
import uuid
import xmlrpc.client

import psutil

from support.xvfb import start_xvfb


# How long a computer that is busy with other things may take for what is done in a moment [s].
PATIENCE_S = 60.0
# Who waits for less asks whether it is quick [s].
QUICK_S = 10.0
# The longest rest between two looks that take long themselves: at the master, at processes [s].
REST_S = 0.05


def wait_for(condition, timeout_s=PATIENCE_S, what='the condition', poll_s=0.002):
    """Return the first true value of a condition.

    Looking takes a third of a processor at most, or what is waited for would come late for it.

    :param timeout_s: from QUICK_S on it is patience, of which there is never less than PATIENCE_S
    :param what: what is waited for, or a function that says so at the end
    :raises AssertionError: it did not come true in time
    """
    if timeout_s >= QUICK_S:
        timeout_s = max(timeout_s, PATIENCE_S)
    deadline = time.monotonic() + timeout_s
    while True:
        begun = time.monotonic()
        value = condition()
        if value:
            return value
        now = time.monotonic()
        if now > deadline:
            raise AssertionError('waited {:g} s for {}'.format(
                timeout_s, what() if callable(what) else what))
        time.sleep(max(poll_s, min(2.0 * (now - begun), REST_S)))


@contextlib.contextmanager
def stuck_terminal():
    """Yield the file descriptor of a terminal that takes nothing: a full pipe that nobody reads."""
    reading, writing = os.pipe()
    try:
        os.set_blocking(writing, False)
        with contextlib.suppress(BlockingIOError):
            while True:
                os.write(writing, bytes(65536))
        os.set_blocking(writing, True)
        yield writing
    finally:
        os.close(reading)
        os.close(writing)


def free_port():
    """Return a TCP port on loopback that nobody uses.

    It is none of those that the kernel gives to whoever asks for any (32768 and above), as each
    node does: one of another test would have it before who was told it listens there.
    """
    while True:
        port = random.SystemRandom().randrange(12000, 32768)
        with socket.socket() as probe, contextlib.suppress(OSError):
            probe.bind(('', port))
            return port


def answers(port):
    """Tell whether something accepts connections on a loopback port."""
    with socket.socket() as probe:
        probe.settimeout(0.2)
        return probe.connect_ex(('127.0.0.1', port)) == 0


def children(number):
    """Return the numbers of the processes that the first thread of a process has started."""
    try:
        with open('/proc/{0}/task/{0}/children'.format(number)) as numbers:
            return [int(word) for word in numbers.read().split()]
    except OSError:
        return []


def processes_with(*words, master=None):
    """Return the processes of a master whose command line has words; one that ends is not there.

    Other tests run at the same time, with masters of their own.

    :param words: arguments, or the ends of them
    :param master: its URI; None: of this process
    """
    master = master or os.environ['ROS_MASTER_URI']
    found = []
    for process in psutil.process_iter(['cmdline']):
        said = process.info['cmdline'] or ()
        if all(any(one.endswith(word) for one in said) for word in words):
            with contextlib.suppress(psutil.Error):
                if process.environ().get('ROS_MASTER_URI') == master:
                    found.append(process)
    return found


class System:
    """Processes around one master on a port of its own; use it as a context manager.

    ``adopt`` puts the environment into this process too, for tests that are nodes themselves.
    """

    def __init__(self, adopt=True):
        self.port = free_port()
        self.home = tempfile.mkdtemp(prefix='mhri_test_')
        self.env = dict(os.environ, ROS_MASTER_URI='http://127.0.0.1:{}'.format(self.port),
                        ROS_IP='127.0.0.1', ROS_HOME=self.home, PYTHONUNBUFFERED='1',
                        ROS_LOG_DIR=os.path.join(self.home, 'log'))
        self.env.pop('ROS_HOSTNAME', None)
        if adopt:
            os.environ.pop('ROS_HOSTNAME', None)
            for key in ('ROS_MASTER_URI', 'ROS_IP', 'ROS_HOME', 'ROS_LOG_DIR'):
                os.environ[key] = self.env[key]
        self._processes = []
        self.master = None

    def __enter__(self):
        return self

    def __exit__(self, failure, *_):
        if failure is not None:
            self._tell_ends()
        self.close()

    def _tell_ends(self):
        """Print how each process was and the end of what it said: to explain a failure far away."""
        for process in self._processes:
            code = process.poll()
            state = 'running' if code is None else 'ended with {}'.format(code)
            print('\n--- {}: {}'.format(' '.join(process.args)[:200], state))
            if hasattr(process, 'log'):
                with open(process.log, errors='replace') as log:
                    print(log.read()[-2000:])

    def start(self, *command, log=None):
        """Start a process in a group of its own; its output goes to a file in ``home``."""
        path = os.path.join(self.home, log or 'out_{}.log'.format(len(self._processes)))
        with open(path, 'ab') as output:
            process = subprocess.Popen(command, env=self.env, stdout=output,
                                       stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL,
                                       start_new_session=True)
        process.log = path
        self._processes.append(process)
        return process

    def start_master(self):
        """Start (or restart) the bare master and wait until it answers."""
        self.master = self.start(
            'rosmaster', '--core', '-p', str(self.port), log='master.log')
        wait_for(lambda: answers(self.port), 60.0, 'the master to answer')
        # As roscore does: two roslaunch at once would each set a run_id of their own, and one fail.
        xmlrpc.client.ServerProxy(self.env['ROS_MASTER_URI']).setParam(
            '/ros_system', '/run_id', str(uuid.uuid1()))
        return self.master

    def node(self, name, *args):
        """Start one of mhri's executables by the name of its module."""
        return self.start(sys.executable, '-c',
                          'from mhri.nodes.{} import main; main()'.format(name), *args)

    def launch(self, *args):
        """Start roslaunch with a file of this package."""
        return self.start('roslaunch', 'mhri', *args)

    def screen(self, size='1920x1080x24', host=''):
        """Start a virtual screen for this system and adopt it."""
        process, display = start_xvfb(size, host)
        self._processes.append(process)
        self.env['DISPLAY'] = os.environ['DISPLAY'] = display
        return display

    @staticmethod
    def kill(process, number=signal.SIGKILL, family=True):
        """Send a signal to a process, to all it started as well unless told not to; await its end.

        roslaunch gives its nodes sessions of their own, so a process group is not enough.
        """
        try:
            members = psutil.Process(process.pid).children(recursive=True) if family else []
            for member in [psutil.Process(process.pid)] + members:
                member.send_signal(number)
        except psutil.NoSuchProcess:
            pass
        process.wait(20)

    def close(self):
        """End everything that was started here, newest first."""
        for process in reversed(self._processes):
            if process.poll() is None:
                try:
                    os.killpg(process.pid, signal.SIGTERM)
                except ProcessLookupError:
                    continue
        for process in reversed(self._processes):
            try:
                process.wait(10)
            except subprocess.TimeoutExpired:
                self.kill(process)
        shutil.rmtree(self.home, ignore_errors=True)
