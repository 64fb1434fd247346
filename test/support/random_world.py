# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Mux, gates, four robots without watchdogs and their operators, on computers of their own.

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

from support import machines
from support.reference_model import JOY, PAD, ReferenceModel
from support.ros_system import children, System, wait_for

HERE = Path(__file__).resolve().parent
PROCESS = str(HERE / 'soak_process.py')
GUARD = str(HERE.parents[1] / 'utils' / 'remote' / 'mhri_guard')
# Name and whether a guard runs on it.
ROBOTS = {'bot1': False, 'bot2': True, 'bot3': False, 'bot4': True}
OPERATORS = ('operator_a', 'operator_b')
# As mhri.launch starts again who has crashed; mux and gates that are killed or hang are replaced by
# the process that stands by.
RESTARTER = '''trap exit INT TERM
until "$@"; do sleep 0.1; done
'''
POLL_S = 0.02


class Computer:
    """A network namespace with a cable to the host, which can be cut."""

    def __init__(self, number):
        self.ip = machines.ROBOT_IP.format(number)
        self.cable = 'cable{}'.format(number)
        self._holder = subprocess.Popen(['setpriv', '--pdeathsig', 'KILL', 'unshare', '--net',
                                         'sleep', 'infinity'], stdin=subprocess.DEVNULL)
        own = os.readlink('/proc/self/ns/net')
        place = '/proc/{}/ns/net'.format(self._holder.pid)
        wait_for(lambda: os.readlink(place) != own, 10.0, 'the namespace')
        machines.run('ip', 'link', 'add', self.cable, 'type', 'veth', 'peer', 'name', 'eth0',
                     'netns', str(self._holder.pid))
        machines.run('ip', 'link', 'set', self.cable, 'master', 'lan', 'up')
        for words in ('link set lo up', 'addr add {}/24 dev eth0'.format(self.ip),
                      'link set eth0 up'):
            machines.run(*self.command('ip', *words.split()))

    def command(self, *words):
        """Return a command line that runs another on this computer."""
        return ['nsenter', '--target', str(self._holder.pid), '--net', '--'] + list(words)

    def close(self):
        """Let the computer go."""
        self._holder.kill()
        self._holder.wait(10)


class World:
    """The whole of it; events are methods. Use it as a context manager.

    :param lan: :class:`support.machines.Lan`, of which this process is the host
    """

    def __init__(self, lan):
        self.facts = []
        self.model = ReferenceModel(ROBOTS, OPERATORS)
        self.system = System(adopt=False)
        self.system.env.update(
            ROS_MASTER_URI='http://{}:{}'.format(machines.HOST_IP, self.system.port),
            ROS_IP=machines.HOST_IP)
        os.environ.update({key: self.system.env[key] for key in (
            'ROS_MASTER_URI', 'ROS_IP', 'ROS_HOME', 'ROS_LOG_DIR')})
        self.folder = lan.folder
        self.computers = {name: Computer(11 + number) for number, name in enumerate(ROBOTS)}
        self.processes = {}
        self.due = []
        self._calls = threading.Lock()
        self._restarter = self.folder / 'restarter'
        self._restarter.write_text(RESTARTER)

    def __enter__(self):
        self.system.start_master()
        import rospy
        from mhri.graph.ros.master_watch import MasterWatch
        from mhri.msg import ControlMode
        # As the node of the pad: it may choose the mode.
        rospy.init_node('mhri_joy', disable_signals=True)
        MasterWatch().start()
        self._mode = rospy.Publisher('/mux_in/mode_select', ControlMode, queue_size=1, latch=True)
        for key in ['mux', 'gates'] + [
                (kind, name) for name in ROBOTS for kind in ('robot', 'guard')
                if kind == 'robot' or ROBOTS[name]] + ['pad', ('operator', OPERATORS[0])]:
            self.start(key)
        return self

    def __exit__(self, *_):
        import rospy
        rospy.signal_shutdown('done')
        for key in self.processes:
            for process in self._family(key):
                try:
                    process.kill()
                except psutil.NoSuchProcess:
                    pass
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
        """Tell whether a program is there and does not hang, and so may be told something."""
        return self.model.parts[key].well

    def start(self, key):
        """Start a program that is not there."""
        if key in self.processes and self.processes[key].poll() is None:
            return
        kind, name = key if isinstance(key, tuple) else (key, None)
        env, words = dict(self.system.env), [sys.executable, PROCESS, kind]
        if kind in ('robot', 'guard'):
            env.update(ROS_NAMESPACE='/' + name, ROS_IP=self.computers[name].ip)
            words.append(self.log_of(name) if kind == 'robot' else GUARD)
            words = self.computers[name].command(*words)
        elif kind == 'operator':
            words.append(name)
        elif kind in ('mux', 'gates'):
            words = ['bash', str(self._restarter), sys.executable, '-c',
                     'from mhri.nodes.{} import main; main()'.format(kind), '--stand-by']
        path = self.folder / '{}.log'.format('_'.join(filter(None, (kind, name))))
        with path.open('ab') as log:
            process = subprocess.Popen(words, env=env, stdin=subprocess.PIPE, stdout=log,
                                       stderr=log, start_new_session=True)
        process.number = None
        self.processes[key] = process
        if kind in ('pad', 'operator'):
            self.tell('stick', PAD if kind == 'pad' else name, False)
        if kind == 'pad':
            self.tell('dead_man', True)
        if kind not in ('mux', 'gates'):
            self.tell('mend', key)

    def log_of(self, robot):
        """Return the path of what a robot obeyed."""
        return str(self.folder / (robot + '.moved'))

    def _family(self, key):
        try:
            process = psutil.Process(self.processes[key].pid)
            return [process] + process.children(recursive=True)
        except psutil.NoSuchProcess:
            return []

    def _pid(self, key):
        """Return the number of the program itself, None where it is not running."""
        process = self.processes[key]
        if process.poll() is not None:
            return None
        if key not in ('mux', 'gates'):
            return process.pid
        return next((pid for standing_by in children(process.pid)
                     for pid in children(standing_by)), None)

    def _notice(self):
        """Tell where mux or gates were started again, or were ended because they hung."""
        for key in ('mux', 'gates'):
            process = self.processes.get(key)
            if process is None:
                continue
            number = self._pid(key)
            if number == process.number:
                continue
            if process.number is not None:
                self.tell('fail', key, 'killed')
            process.number = number
            if number is not None:
                self.tell('mend', key)

    def end(self, key, number, how):
        """End a program: SIGTERM or SIGKILL."""
        pid = self._pid(key)
        if pid is None:
            return False
        os.kill(pid, number)
        if number != signal.SIGKILL and self.model.parts[key].how == 'hung' and not self.well(key):
            os.kill(pid, signal.SIGCONT)
        self.tell('fail', key, how)
        if key in ('mux', 'gates'):
            self.processes[key].number = None
            # What is ended in order stays away until it is started again, but for one that hung.
            wait_for(lambda: self._pid(key) != pid and (
                how == 'killed' or self._pid(key) or self.processes[key].poll() is not None),
                10.0, 'the end of {}'.format(key))
        else:
            self.processes[key].wait(10)
        return True

    def hang(self, key, seconds):
        """Stop a program for a while."""
        pid = self._pid(key)
        if pid is None or not self.well(key):
            return False
        os.kill(pid, signal.SIGSTOP)
        self.tell('fail', key, 'hung')

        def go_on():
            if self._pid(key) == pid and not self.well(key):
                self.tell('mend', key)
                os.kill(pid, signal.SIGCONT)
        self.later(seconds, go_on)
        return True

    def cut(self, name, seconds):
        """Cut the link of a robot for a while."""
        key, cable = ('link', name), self.computers[name].cable
        if not self.well(key):
            return False
        machines.run('ip', 'link', 'set', cable, 'down')
        self.tell('fail', key, 'cut')

        def plug():
            self.tell('mend', key)
            machines.run('ip', 'link', 'set', cable, 'up')
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
        self.processes[key].stdin.write((line + '\n').encode())
        self.processes[key].stdin.flush()
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
        if not (self.well('gates') and self.well('master')) or not self.say(
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
                answer.append(rospy.ServiceProxy('/mux/set_stop_all', SetBool)(stopped).success)
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
