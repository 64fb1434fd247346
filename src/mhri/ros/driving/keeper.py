# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The gate keeper: a child process of the panel in which the gates do their work.

A panel that draws four cameras and graphs shares one interpreter lock among all that, and a
command waits its turn; and a panel that gets SIGKILL (or runs out of memory) cannot say zero any
more, while not every robot has a watchdog (turtlebot3#1154). So the gates are there twice. Those of
the keeper speak to the robots; those of the panel follow: they decide the same, show what is
decided, and speak for any robot that the keeper does not reach yet, or when it has ended.

- The panel ends, however it went: their pipe breaks, and the keeper sends the zeros.
- The keeper ends: its pipe breaks, and the panel's gates take over, with a zero where one was just
  said. A keeper that is silent for :data:`SILENCE_S` is ended.
- A robot's link is cut: the network keeps the last commands of the keeper and would bring them,
  late, when it is back. So the keeper drops its connection before the robot's watchdog has stopped
  it, and the panel's gate, which has never said anything on its own, says zero there: the first
  word that comes through. The robot takes another connection only from another node: once it is
  heard again, the keeper is replaced.

The pipes carry one JSON list per line. To the keeper: ``["open", name, [topic, ...], m/s, rad/s]``,
``["close", name]``, ``["announce", name]``, ``["held", name, bool]``, ``["select", [name, ...]]``,
``["press"]``, ``["withdraw"]``, ``["pace", together, share]``, ``["leave"]``, ``["bye"]``. From it:
``["alive"]`` ten times a second, ``["leads", name]``, ``["dropped", name]``, ``["leaves"]``,
``["closed"]`` after bye. The keeper hears commands and stop-all from the mux itself, and the
selection from the panel alone.
"""
import json
import os
import queue
import select
import subprocess
import sys
import threading
import time

import rospy

from mhri.core.driving.arbiter import REPEAT_HZ, ZEROS_S
from mhri.core.driving.limits import ZERO
from mhri.core.robots.robot_types import Limits
from mhri.ros.driving.gate import Gate
from mhri.ros.worker import Worker

ALIVE_S = 0.1
SILENCE_S = 0.5
START_S = 60.0
RESTART_S = 1.0
# The zeros of a panel that ends are due within 50 ms: past this it says them itself.
CLOSE_S = 0.03
FLUSH_S = 0.1
LEAVE_S = 5.0


class KeeperLink:
    """The panel's side; a keeper that cannot be started, or has ended, is done without.

    :param bank: :class:`mhri.ros.driving.gates.GateBank` of the panel
    """

    def __init__(self, bank):
        self._bank = bank
        self._process = None
        self._dropped = frozenset()
        self._ending = threading.Event()
        self._closed = threading.Event()

    def start(self):
        """Start the child and look after it, on a thread."""
        threading.Thread(target=self._run, name='gate_keeper', daemon=True).start()

    def end(self):
        """Let the keeper send its zeros and end; returns within :data:`CLOSE_S`."""
        self._ending.set()
        if self._process is None:
            return
        self._say('bye')
        if not self._closed.wait(CLOSE_S):
            self._bank.take_over()

    def _run(self):
        while not self._ending.is_set():
            try:
                answers = self._spawn()
            except OSError as error:
                rospy.logwarn('no gate keeper: a robot without a watchdog would drive on if this '
                              'program were killed (%s)', error)
                return
            self._listen(answers)
            os.close(answers)
            if not self._closed.is_set():
                self._bank.take_over()
            self._process.stdin.close()
            status = self._process.wait()
            replaced, self._dropped = self._dropped, frozenset()
            if not self._ending.wait(RESTART_S) and not replaced:
                rospy.logwarn('the gate keeper has ended (%s): the panel drives the robots itself '
                              'until there is another one', status)

    def _spawn(self):
        """Start a child that knows all there is to know; return the pipe it answers by."""
        answers, answer_to = os.pipe()
        command = [sys.executable, '-c', 'from mhri.nodes.gate_keeper import main; main()',
                   str(answer_to)]
        try:
            self._process = subprocess.Popen(command, stdin=subprocess.PIPE,
                                             pass_fds=(answer_to,), start_new_session=True)
        except OSError:
            os.close(answers)
            raise
        finally:
            os.close(answer_to)
        os.set_blocking(self._process.stdin.fileno(), False)
        self._bank.meet(self._say)
        if self._ending.is_set():
            self._say('bye')
        return answers

    def _say(self, *words):
        """Write one line, never waiting; a child that does not read its pipe is ended.

        One that cannot reach a robot that is heard again is replaced.
        """
        if words[0] == 'held' and words[1] in self._dropped and not words[2]:
            words = ('leave',)
        try:
            os.write(self._process.stdin.fileno(), (json.dumps(words) + '\n').encode('ascii'))
        except BlockingIOError:
            self._process.kill()
        except (OSError, ValueError) as error:
            rospy.logdebug('the gate keeper has ended: %s', error)

    def _listen(self, answers):
        """Follow what the keeper says until it has closed or its pipe breaks."""
        rest, patience_s = b'', START_S
        while not self._closed.is_set():
            if not select.select([answers], [], [], patience_s)[0]:
                rospy.logwarn('the gate keeper has been silent for %g s: ending it', patience_s)
                self._process.kill()
            data = os.read(answers, 4096)
            if not data:
                return
            *lines, rest = (rest + data).split(b'\n')
            words = [json.loads(line) for line in lines]
            # It says nothing more while it signs off at the master.
            patience_s = LEAVE_S if ['leaves'] in words else SILENCE_S
            for word in words:
                self._take(*word)

    def _take(self, word, *rest):
        if word == 'leads':
            self._bank.follow(*rest)
        elif word == 'leaves':
            self._bank.take_over()
        elif word == 'dropped':
            self._dropped |= {rest[0]}
            self._bank.speak_for(*rest)
        elif word == 'closed':
            self._closed.set()


class Words:
    """The panel's lines, read from the very start on a thread; iterate over them.

    A node that waits for a master would never learn that its panel has ended meanwhile.

    :param stream: text lines, ends when the panel is gone
    :param on_early_end: called on the thread where the end comes before anybody has iterated: then
        there is nothing to stop yet
    """

    def __init__(self, stream, on_early_end):
        self._stream = stream
        self._on_early_end = on_early_end
        self._lines = queue.Queue()
        self._begun = threading.Event()
        threading.Thread(target=self._read, name='words', daemon=True).start()

    def _read(self):
        for line in self._stream:
            self._lines.put(line)
        if not self._begun.is_set():
            self._on_early_end()
        self._lines.put(None)

    def __iter__(self):
        self._begun.set()
        return iter(self._lines.get, None)


class Keeper:
    """The child: does what the panel says until the pipe breaks.

    :param lines: iterable of text lines, ends when the panel is gone
    :param answer: file descriptor to answer by
    :param bank: :class:`mhri.ros.driving.gates.GateBank`, started without an ear for the selection
    """

    def __init__(self, lines, answer, bank):
        self._lines = lines
        self._answer_to = answer
        self._bank = bank
        self._leads = {}
        self._held = frozenset()
        self._closed = threading.Event()
        self._speaking = threading.Lock()
        # Whatever asks the master: it may be out of reach, and a stop must not wait for it.
        self._worker = Worker('gate_keeper')

    def run(self):
        """Return when the panel has ended; return the names of robots it was driving then."""
        self._worker.start()
        threading.Thread(target=self._live, name='alive', daemon=True).start()
        for line in self._lines:
            word, *rest = json.loads(line)
            if word == 'leave':
                self._leave()
                return []
            if word == 'bye':
                self._closed.set()
                self._bank.close()
                self._answer('closed')
                time.sleep(FLUSH_S)
                return []
            self._obey(word, *rest)
        return self._last_words()

    def _leave(self):
        """Say nothing to the robots any more: the panel does, until there is another keeper."""
        with self._speaking:
            self._closed.set()
            for gate in self._bank.gates():
                gate.follow()
            self._answer('leaves')

    def _obey(self, word, *rest):
        """Follow one line of the panel."""
        if word == 'open':
            self._worker.do(self._open, *rest)
        elif word == 'close':
            self._worker.do(self._close, rest[0], self._bank.remove(rest[0]))
        elif word == 'announce':
            self._worker.do(self._bank.announce, *rest)
        else:
            {'select': self._bank.select, 'press': self._bank.press_stop,
             'withdraw': self._bank.withdraw_press, 'pace': self._bank.set_pace,
             'held': self._hold}[word](*rest)

    def _hold(self, name, held):
        """Hold a robot, or let it go; one that is still to be opened is held from then on."""
        self._held = self._held | {name} if held else self._held - {name}
        self._bank.hold(name, held)

    def _open(self, name, topics, linear_mps, angular_rad_s):
        gate = Gate(name, topics, Limits(linear_mps, angular_rad_s))
        gate.follow()
        self._bank.add(gate)
        if name in self._held:
            self._bank.hold(name, True)

    def _close(self, name, gate):
        """Give the topics back; the gate is None where it was not open yet when it was closed."""
        gate = gate or self._bank.remove(name)
        if gate:
            gate.unregister()

    def _live(self):
        """Say that all is well, and lead each robot once it is connected."""
        while True:
            with self._speaking:
                if self._closed.is_set():
                    return
                self._lead_connected()
                for name in self._bank.drop_cut():
                    self._bank.follow(name)
                    self._answer('dropped', name)
                self._answer('alive')
            self._closed.wait(ALIVE_S)

    def _lead_connected(self):
        gates = {gate.name: gate for gate in self._bank.gates()}
        self._leads = {name: gate for name, gate in self._leads.items()
                       if gates.get(name) is gate}
        for name, gate in gates.items():
            if name not in self._leads and gate.reachable():
                self._leads[name] = gate
                gate.lead()
                self._answer('leads', name)

    def _answer(self, *words):
        try:
            os.write(self._answer_to, (json.dumps(words) + '\n').encode('ascii'))
        except OSError:
            # The panel has ended: the other pipe says so, too, and that one is acted upon.
            self._closed.set()

    def _last_words(self):
        """Send zeros as the panel would have; to those that were driven, for a while."""
        self._closed.set()
        driven = [gate for gate in self._bank.gates() if gate.rule.driving]
        self._bank.take_over()
        self._bank.close()
        for _ in range(int(ZEROS_S * REPEAT_HZ) if driven else 0):
            time.sleep(1.0 / REPEAT_HZ)
            for gate in driven:
                gate.send(ZERO, time.monotonic())
        time.sleep(FLUSH_S)
        return [gate.name for gate in driven]
