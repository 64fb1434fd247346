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
import traceback
import uuid
import xmlrpc.client

import psutil

from support.xvfb import start_xvfb


# How long a computer that is busy with other things may take for what is done in a moment [s].
TIMEOUT_S = 60.0
# Who waits for less asks whether it is quick [s].
QUICK_S = 10.0
# The longest rest between two looks that take long themselves: at the master, at processes [s].
REST_S = 0.05
# Of what a condition looked at in vain so many letters are printed, and so many dots are followed.
MOST_WORDS, MOST_DOTS = 1000, 4
# Marks of the ports that were given out here, held until this process ends.
_GIVEN_OUT = []


class NotYet(AssertionError):
    """What was waited for did not come in time."""


def wait_for(condition, timeout_s=TIMEOUT_S, what='the condition', poll_s=0.002,
             turn=lambda: None):
    """Return the first true value of a condition.

    Looking takes a third of a processor at most, or what is waited for would come late for it.

    :param condition: not true while it looks for something that is not there (StopIteration); one
        that does something for it counts in ``times`` how often, which is printed
    :param timeout_s: from QUICK_S on it is patience, of which there is never less than TIMEOUT_S
    :param what: what is waited for, or a function that says so at the end
    :param turn: called before each look
    :raises NotYet: it did not come true in time
    """
    if timeout_s >= QUICK_S:
        timeout_s = max(timeout_s, TIMEOUT_S)
    deadline = time.monotonic() + timeout_s
    while True:
        begun = time.monotonic()
        turn()
        value = None
        with contextlib.suppress(StopIteration):
            value = condition()
        if value:
            say_insisted(getattr(condition, 'times', 1), what)
            return value
        now = time.monotonic()
        if now > deadline:
            raise NotYet('waited {:g} s for {}; there is: {}'.format(
                timeout_s, words_of(what), seen_by(condition)))
        time.sleep(max(poll_s, min(2.0 * (now - begun), REST_S)))


def seen_by(condition):
    """Return in words what a condition looks at: the variables around it, and what it asks of them.
    """
    code = getattr(condition, '__code__', None)
    if code is None:
        return ', '.join(seen_by(part) for part in vars(condition).values()
                         if hasattr(part, '__code__'))
    seen, around = {}, {'self': getattr(condition, '__self__', None)}
    for name, cell in zip(code.co_freevars, condition.__closure__ or ()):
        with contextlib.suppress(ValueError):  # nothing is in it yet
            around[name] = cell.cell_contents

    def look(name, value):
        """Note a value, or, where it says nothing of itself, its parts that are asked for."""
        if name != 'self' and type(value).__repr__ is not object.__repr__:
            seen[name] = value
            return
        for part in code.co_names if name.count('.') < MOST_DOTS else ():
            with contextlib.suppress(Exception):
                if not callable(getattr(value, part)):
                    look('{}.{}'.format(name, part), getattr(value, part))
    for name, value in around.items():
        if not callable(value):
            look(name, value)
    return ', '.join('{}={}'.format(name, ' '.join(repr(value).split())[:MOST_WORDS])
                     for name, value in seen.items()) or 'nothing'


def insist(attempt, what, timeout_s=TIMEOUT_S, poll_s=0.002):
    """Do something until it succeeds; return what it returned then.

    For what mhri rightly refuses after a process has stood still: a stick has to be centred again
    then, and a task whose robot was not heard has ended. It is no way to wait for something slow.
    How often it was needed is printed, and counted by the runner: once where a machine has time.

    :param attempt: returns a true value once it succeeds; else something false, or NotYet is raised
    :raises NotYet: it did not in time
    """
    attempts = Attempts(attempt)
    return wait_for(attempts, timeout_s, lambda: words_of(what) + (
        attempts.said and '; before: ' + attempts.said), poll_s)


class Attempts:
    """An attempt as a condition."""

    def __init__(self, attempt):
        self.attempt, self.times, self.said = attempt, 0, ''

    def __call__(self):
        self.times += 1
        try:
            return self.attempt()
        except NotYet as error:
            self.said = str(error)
            return None


def say_insisted(times, what):
    """Print how often something was done until it succeeded, where it was not at once."""
    if times > 1:
        print('INSISTED {} times: {}'.format(times, ' '.join(words_of(what).split())[:300]),
              flush=True)


def words_of(what):
    """Return words, or what a function says."""
    try:
        return what() if callable(what) else what
    except StopIteration as missing:
        return 'something that is not there: {}'.format(
            traceback.extract_tb(missing.__traceback__)[-1].line)


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
    node does: one of another test would have it before who was told it listens there. Nor is it
    one that was given out to another test, which may only be about to listen.
    """
    while True:
        port, mark = random.SystemRandom().randrange(12000, 32768), socket.socket(socket.AF_UNIX)
        with socket.socket() as probe, contextlib.suppress(OSError):
            mark.bind('\0mhri_test_port_{}'.format(port))
            probe.bind(('', port))
            _GIVEN_OUT.append(mark)
            return port
        mark.close()


def answers(port):
    """Return whether something accepts connections on a loopback port."""
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


def child_processes(word, number=None):
    """Return the children of a process, by default this one, of which an argument has a word in it.

    One that ends meanwhile is not among them, whoever it is.
    """
    found = []
    for child in psutil.Process(number).children():
        with contextlib.suppress(psutil.NoSuchProcess):
            if child.status() != psutil.STATUS_ZOMBIE and any(
                    word in one for one in child.cmdline()):
                found.append(child)
    return found


def family_of(process):
    """Return a process and all that it has started and they have, none of one that is gone."""
    try:
        first = psutil.Process(process.pid)
        return [first] + first.children(recursive=True)
    except psutil.NoSuchProcess:
        return []


def freeze(*numbers):
    """Stop processes by their numbers; return when the first was signalled [s, monotonic].

    It returns once every thread stands: each takes the signal by itself, some a moment later.

    :raises NotYet: a thread goes on
    """
    when = time.monotonic()
    for number in numbers:
        os.kill(number, signal.SIGSTOP)
    wait_for(lambda: {state for number in numbers for state in _thread_states(number)} <= set('Tt'),
             what=lambda: 'all threads to stand: {}'.format(
                 {number: _thread_states(number) for number in numbers}))
    return when


def thaw(*numbers):
    """Let processes that were frozen go on; return when [s, monotonic]."""
    when = time.monotonic()
    for number in numbers:
        os.kill(number, signal.SIGCONT)
    return when


def _thread_states(number):
    """Return the states of a process's threads, a letter each as in proc(5)."""
    found = []
    for thread in os.listdir('/proc/{}/task'.format(number)):
        # It may end meanwhile.
        with contextlib.suppress(OSError), \
                open('/proc/{}/task/{}/stat'.format(number, thread)) as stat:
            # The name before it may have spaces and brackets in it.
            found.append(stat.read().rpartition(')')[2].split()[0])
    return found


def tell(process, line):
    """Write a line to the standard input of a process."""
    process.stdin.write((line + '\n').encode())
    process.stdin.flush()


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


def node_words(name, *words):
    """Return the command line of one of mhri's executables by the name of its module."""
    return [sys.executable, '-c', 'from mhri.nodes.{} import main; main()'.format(name), *words]


class System:
    """Processes around one master on a port of its own; use it as a context manager.

    ``adopt`` puts the environment into this process too, for tests that are nodes themselves.

    :param ip: address of this computer that other ones of the test know
    """

    def __init__(self, adopt=True, ip='127.0.0.1'):
        self.port = free_port()
        self.home = tempfile.mkdtemp(prefix='mhri_test_')
        self.env = dict(os.environ, ROS_MASTER_URI='http://{}:{}'.format(ip, self.port),
                        ROS_IP=ip, ROS_HOME=self.home, PYTHONUNBUFFERED='1',
                        ROS_LOG_DIR=os.path.join(self.home, 'log'),
                        # Settings are nobody's own.
                        XDG_CONFIG_HOME=os.path.join(self.home, 'config'))
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
            self.tell_ends()
        self.close()

    def tell_ends(self):
        """Print how each process was and the end of what it said: to explain a failure far away."""
        for process in self._processes:
            code = process.poll()
            state = 'running' if code is None else 'ended with {}'.format(code)
            print('\n--- {}: {}'.format(' '.join(process.args)[:200], state))
            if hasattr(process, 'log'):
                with open(process.log, errors='replace') as log:
                    print(log.read()[-2000:])

    def start(self, *command, log=None, env=None, stdin=subprocess.DEVNULL):
        """Start a process in a group of its own; its output goes to a file.

        :param log: the file, in ``home`` or with its path
        :param env: what its environment has beside that of the system
        :param stdin: ``subprocess.PIPE`` for one that :func:`tell` tells things
        """
        path = os.path.join(self.home, log or 'out_{}.log'.format(len(self._processes)))
        with open(path, 'ab') as output:
            process = subprocess.Popen(command, env=dict(self.env, **(env or {})), stdout=output,
                                       stderr=subprocess.STDOUT, stdin=stdin,
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
        return self.start(*node_words(name, *args))

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
        for member in family_of(process) if family else family_of(process)[:1]:
            with contextlib.suppress(psutil.NoSuchProcess):
                member.send_signal(number)
        process.wait(TIMEOUT_S)

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
