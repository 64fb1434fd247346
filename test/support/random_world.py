# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The mux, four robots without watchdogs and their operators, on computers of their own.

Everything that happens to them is done here, and told: ``facts`` is what the reference model is to
hear, (time [s, monotonic], event, arguments).
"""
import os
from pathlib import Path
import signal
import subprocess
import sys
import threading
import time

import psutil

from support import graph
from support import machines
from support.journals import Journal
from support.reference_model import JOY, PAD, ReferenceModel
from support.ros_system import children, freeze, node_words, System, tell, wait_for

HERE = Path(__file__).resolve().parent
PROCESS = str(HERE / 'soak_process.py')
GUARD = str(HERE.parents[1] / 'utils' / 'remote' / 'mhri_guard')
# Name and whether a guard runs on it.
ROBOTS = {'bot1': False, 'bot2': True, 'bot3': False, 'bot4': True}
OPERATORS = ('operator_a', 'operator_b')
POLL_S = 0.02
# A drive without its undertaker has ended after this time [s].
ENDS_S = 3.0


def _lives(process):
    """Return whether a ``psutil.Process`` has not ended."""
    try:
        return process.is_running() and process.status() != psutil.STATUS_ZOMBIE
    except psutil.NoSuchProcess:
        return False


class World:
    """The whole of it; events are methods. Use it as a context manager.

    :param lan: :class:`support.machines.Lan`, of which this process is the host
    """

    def __init__(self, lan):
        self.facts = []
        self.model = ReferenceModel(ROBOTS, OPERATORS)
        self.system = System(ip=machines.HOST_IP)
        self.folder, self.journal = lan.folder, Journal(lan.folder)
        self.computers = {name: machines.Computer(11 + number)
                          for number, name in enumerate(ROBOTS)}
        self.processes = {}
        self.due = []
        # (time, what the mux waits for), as it says
        self.said = []
        # Drives without an undertaker: those that should end, and when; those that have not
        self._ends, self.left = [], []
        self._calls = threading.Lock()

    def __enter__(self):
        self.system.start_master()
        import rospy
        from mhri.graph.ros.master_watch import MasterWatch
        from mhri.msg import ControlMode, DriveState
        # As the node of the pad: it may choose the mode.
        rospy.init_node('mhri_joy', disable_signals=True)
        MasterWatch().start()
        self._mode = rospy.Publisher(graph.MODE_SELECT, ControlMode, queue_size=1, latch=True)
        rospy.Subscriber(graph.DRIVE_STATE, DriveState, lambda state: self.said.append(
            (time.monotonic(), state.waits_for)), queue_size=10, tcp_nodelay=True)
        for key in ['mux'] + [
                (kind, name) for name in ROBOTS for kind in ('robot', 'guard')
                if kind == 'robot' or ROBOTS[name]] + ['pad', ('operator', OPERATORS[0])]:
            self.start(key)
        return self

    def __exit__(self, *_):
        import rospy
        rospy.signal_shutdown('done')
        for process in self.processes.values():
            self.system.kill(process)
        self.system.close()
        for computer in self.computers.values():
            computer.close()

    # What is told.

    def tell(self, what, *args, at=None):
        """Tell the models what has happened."""
        now = time.monotonic() if at is None else at
        with self._calls:
            self.facts.append((now, what, args))
            self.model.tell(now, what, *args)

    def wait(self, seconds):
        """Let time pass: what was put off is done when it is due, who was restarted is noticed."""
        until = time.monotonic() + seconds
        while True:
            now = time.monotonic()
            for entry in [entry for entry in self.due if entry[0] <= now]:
                self.due.remove(entry)
                entry[1]()
            self._notice()
            for entry in [entry for entry in self._ends if entry[0] <= now]:
                self._ends.remove(entry)
                if _lives(entry[1]):
                    self.left.append(entry[1])
            if now >= until:
                return
            time.sleep(min(POLL_S, until - now))

    def later(self, seconds, call):
        """Put something off."""
        self.due.append((time.monotonic() + seconds, call))

    def hurry(self):
        """Do now what was put off."""
        due, self.due = self.due, []
        for _, call in due:
            call()

    # Programs.

    def well(self, key):
        """Return whether a program is there and does not hang, and so may be told something."""
        return self.model.parts[key].well

    def start(self, key):
        """Start a program that is not there."""
        if key in self.processes and self.processes[key].poll() is None:
            return
        kind, name = key if isinstance(key, tuple) else (key, None)
        env, words = {}, [sys.executable, PROCESS, kind]
        if kind in ('robot', 'guard'):
            env = {'ROS_NAMESPACE': '/' + name, 'ROS_IP': self.computers[name].ip}
            words.append(self.log_of(name) if kind == 'robot' else GUARD)
            words = self.computers[name].command(*words)
        elif kind == 'operator':
            words.append(name)
        elif kind == 'mux':
            words = node_words('mux', '--stand-by', self.journal.argument)
        path = self.folder / '{}.log'.format('_'.join(filter(None, (kind, name))))
        self.processes[key] = self.system.start(
            *words, log=str(path), env=env, stdin=subprocess.PIPE)
        self.processes[key].number = None
        if kind in ('pad', 'operator'):
            self.tell('stick', PAD if kind == 'pad' else name, False)
        if kind == 'pad':
            self.tell('dead_man', True)
        if kind != 'mux':
            self.tell('mend', key)

    def log_of(self, robot):
        """Return the path of what a robot obeyed."""
        return str(self.folder / (robot + '.moved'))

    def _pid(self, key):
        """Return the number of the program itself, None where it is not running."""
        process = self.processes['mux' if key == 'undertaker' else key]
        if process.poll() is not None:
            return None
        if key != 'mux':
            return process.pid
        # While the undertaker hangs, one that has ended is still its child.
        return next((pid for pid in children(process.pid)
                     if psutil.pid_exists(pid) and _lives(psutil.Process(pid))), None)

    def _notice(self):
        """Return whether the mux was started again, or was ended because it hung."""
        process = self.processes.get('mux')
        number = self._pid('mux')
        if process is None or number == process.number:
            return
        if process.number is not None:
            self.tell('fail', 'mux', 'killed')
        process.number = number
        if number is not None:
            self.tell('mend', 'mux')

    def end(self, key, number, how):
        """End a program: SIGTERM or SIGKILL."""
        pid = self._pid(key)
        if pid is None:
            return False
        drives = key == 'mux'
        # Nobody follows if the undertaker is told to end.
        os.kill(self.processes[key].pid if drives and number != signal.SIGKILL else pid, number)
        for hung in (key, 'undertaker') if drives else (key,):
            if number != signal.SIGKILL and not self.well(hung):
                os.kill(self._pid(hung), signal.SIGCONT)
        self.tell('fail', key, how)
        if drives:
            self.processes[key].number = None
        if drives and number == signal.SIGKILL:
            wait_for(lambda: self._pid(key) != pid, 10.0, 'the end of {}'.format(key))
        else:
            self.processes[key].wait(60)
        return True

    def end_undertaker(self, both=False):
        """Kill the undertaker, and the mux at once, or let that end by itself."""
        pid = self._pid('mux')
        if pid is None:
            return False
        drive = psutil.Process(pid)
        self.processes['mux'].kill()
        if both:
            drive.kill()
        self.tell('fail', 'mux', 'both killed' if both else 'orphaned')
        self.processes['mux'].number = None
        self.processes['mux'].wait(60)
        self._ends.append((time.monotonic() + ENDS_S, drive))
        return True

    def hang(self, key, seconds):
        """Stop a program, or the undertaker, for a while."""
        pid = self._pid(key)
        if pid is None or not self.well(key):
            return False
        freeze(pid)
        self.tell('fail', key, 'hung')

        def go_on():
            if self._pid(key) == pid and not self.well(key):
                self.tell('mend', key)
                os.kill(pid, signal.SIGCONT)
        self.later(seconds, go_on)
        return True

    def cut(self, name, seconds):
        """Cut the link of a robot for a while."""
        key, computer = ('link', name), self.computers[name]
        if not self.well(key):
            return False
        computer.unplug()
        self.tell('fail', key, 'cut')

        def plug():
            self.tell('mend', key)
            computer.plug()
        self.later(seconds, plug)
        return True

    def end_master(self, seconds):
        """Kill the master, and start another one later."""
        if not self.well('master'):
            return False
        self.system.kill(self.system.master)
        self.tell('fail', 'master', 'killed')

        def start():
            self.system.start_master()
            self.tell('mend', 'master')
        self.later(seconds, start)
        return True

    # What operators do.

    def say(self, key, line, *fact):
        """Tell a program something; False where it cannot hear.

        :param fact: what the models are told of it, before it is done
        """
        if not self.well(key):
            return False
        if fact:
            self.tell(*fact)
        tell(self.processes[key], line)
        return True

    def stick(self, name, out):
        """Deflect or centre a stick."""
        word = 'out' if out else 'centred'
        key, line = (('operator', name), 'stick ' + word) if name != PAD else (
            'pad', '{} {:d}'.format(word, self.model.sticks[PAD].held))
        return self.say(key, line, 'stick', name, out)

    def dead_man(self, held):
        """Press or let go the dead-man button."""
        word = 'out' if self.model.sticks[PAD].out else 'centred'
        return self.say('pad', '{} {:d}'.format(word, held), 'dead_man', held)

    def press_once(self):
        """Hold the dead-man button; where the mux has not seen it released, it is let go before."""
        if self.model.sticks[PAD].held:
            if self.model.sticks[PAD].let_go:
                return True
            self.dead_man(False)
            self.wait(0.4)
        return self.dead_man(True)

    def check(self, operator, names):
        """Check exactly these robots."""
        names = sorted(names)
        return self.say(('operator', operator), ' '.join(['select'] + names), 'check', operator,
                        names)

    def take(self, operator):
        """Take control; waits until it is done."""
        log = self.folder / 'operator_{}.log'.format(operator)
        count = log.read_text().count('taken')
        if not (self.well('mux') and self.well('master')) or not self.say(
                ('operator', operator), 'take'):
            return False
        try:
            wait_for(lambda: log.read_text().count('taken') > count, 3.0, 'the take-over')
        except AssertionError:
            # Nobody knows now who is in control: this one has to go.
            self.end(('operator', operator), signal.SIGKILL, 'killed')
            self.later(0.5, lambda: self.start(('operator', operator)))
            return False
        self.tell('take', operator)
        return True

    def mode(self, mode):
        """Ask for another mode."""
        self.tell('mode', mode)
        self._mode.publish(mode)
        return True

    def stop(self, stopped):
        """Engage or release stop-all; return whether the mux has done so."""
        import rospy
        from std_srvs.srv import SetBool
        answer, asked = [], time.monotonic()

        def call():
            try:
                answer.append(rospy.ServiceProxy(graph.SET_STOP_ALL, SetBool)(stopped).success)
            except (rospy.ServiceException, rospy.ROSException, OSError):
                answer.append(None)
        thread = threading.Thread(target=call, daemon=True)
        if stopped:
            self.tell('unknown')
        thread.start()
        thread.join(3.0)
        if not answer or answer[0] is None:
            self.tell('unknown')
            return False
        if stopped:
            self.tell('stop')
        elif answer[0]:
            self.tell('release', at=asked)
        return answer[0]

    def active(self):
        """Return the name of the stick that drives, as far as is known."""
        if self.model.mode == PAD:
            return PAD
        return next(iter(sorted(self.model.holders)), OPERATORS[0])

    def recover(self, rival):
        """Make all well: everything is there, one operator has checked every robot, all centred.

        :param rival: whether there is a second operator that has no control
        """
        self.hurry()
        second = ('operator', OPERATORS[1])
        if second in self.processes:
            self.end(second, signal.SIGKILL, 'killed')
        for key in list(self.processes):
            if key != second:
                self.start(key)
        self.wait(0.2)
        wait_for(lambda: self.wait(0.05) or all(
            part.well for key, part in self.model.parts.items() if key != second),
            20.0, 'everything to be there')
        if self.model.holders != {OPERATORS[0]}:
            self.take(OPERATORS[0])
        self.check(OPERATORS[0], ROBOTS)
        if rival:
            self.wait(max(0.0, self.model.well_since - time.monotonic()))
            self.start(second)
            self.wait(1.5)
            self.check(OPERATORS[1], list(ROBOTS)[2:])
            self.stick(OPERATORS[1], True)
        self.check(OPERATORS[0], ROBOTS)
        self.dead_man(True)
        self.stick(PAD, False)
        self.stick(OPERATORS[0], False)
        self.wait(max(0.0, self.model.well_since - time.monotonic()))
        self.wait(0.3)
        wait_for(lambda: self.stop(False) or self.wait(0.2), 20.0, 'the release of the stop')
        self.wait(max(0.0, self.model.well_since - time.monotonic()) + 0.5)


__all__ = ['JOY', 'OPERATORS', 'PAD', 'ROBOTS', 'World']
