# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Mux, gates, tasks, an operator and simulated robots on patrol, each a process that can be killed.

With a :class:`support.machines.Lan` each robot has a computer of its own, whose link can be cut;
without one all of it is on this computer.
"""
import contextlib
import os
import signal
import subprocess
import sys
import time

import actionlib
import psutil
import rospy
from std_srvs.srv import SetBool

from mhri.msg import ControlMode, RunTaskAction, RunTaskGoal, TaskList
from support import machines
from support.fake_mux import StateEar
from support.random_world import Computer, GUARD, HERE, PROCESS, RESTARTER
from support.ros_system import System, wait_for

PATIENCE_S = 90.0
NODES = ('mux', 'gates', 'tasks')
OPERATOR = 'operator_a'
# Name: (robot_type, model, its velocity topics, lane y [m], whether a guard runs on it).
ROBOTS = {'bot1': ('turtlebot2', '', ('teleop/input', 'cmd_vel_mux/input/teleop'), 1.0, True),
          'bot2': ('turtlebot3', 'waffle', ('cmd_vel',), 2.1, False),
          'bot3': ('turtlebot3', 'burger', ('cmd_vel',), 3.2, True)}
LANE_M = (3.0, 8.0)


class RobotLog:
    """What one robot was told, and how its body moved: rows (when [s], m/s, rad/s)."""

    def __init__(self, path):
        self.path = path

    def rows(self, what):
        """Return all rows of ``told`` or ``moved``."""
        try:
            with open('{}.{}'.format(self.path, what)) as log:
                return [tuple(map(float, line.split())) for line in log if line.endswith('\n')]
        except FileNotFoundError:
            return []

    def drives(self):
        """Tell whether its last command was to move, and its body does."""
        told, moved = self.rows('told')[-1:], self.rows('moved')[-1:]
        return bool(told and moved) and any(told[0][1:]) and abs(moved[0][1]) > 0.05

    def stands_from(self, since, what, least=0.0):
        """Return when it stands for good: the first row after which no other moves it.

        None where it never does.
        """
        rows = self.rows(what)
        moves = [index for index, row in enumerate(rows)
                 if max(abs(row[1]), abs(row[2])) > least]
        after = rows[moves[-1] + 1:] if moves else rows
        return max(since, after[0][0]) if after else None


class TaskSystem:
    """The whole of it; use it as a context manager.

    :param lan: :class:`support.machines.Lan`, None for one computer
    """

    def __init__(self, folder, lan):
        self.folder = folder
        self.system = System(adopt=False)
        if lan is not None:
            self.system.env.update(
                ROS_MASTER_URI='http://{}:{}'.format(machines.HOST_IP, self.system.port),
                ROS_IP=machines.HOST_IP)
        os.environ.update({key: self.system.env[key] for key in (
            'ROS_MASTER_URI', 'ROS_IP', 'ROS_HOME', 'ROS_LOG_DIR')})
        self.computers = {name: Computer(11 + number)
                          for number, name in enumerate(ROBOTS)} if lan is not None else {}
        self.logs = {name: RobotLog(str(folder / name)) for name in ROBOTS}
        self.processes = {}
        self._restarter = folder / 'roslaunch'
        self._restarter.write_text(RESTARTER)

    def __enter__(self):
        self.system.start_master()
        rospy.init_node('random_stops', disable_signals=True)
        self._mode = rospy.Publisher('/mux_in/mode_select', ControlMode, queue_size=1, latch=True)
        self._mode.publish('joy')
        rospy.set_param('/mhri/robots', list(ROBOTS))
        for key in NODES:
            self._start(key, ['bash', str(self._restarter), sys.executable, '-c',
                              'from mhri.nodes.{} import main; main()'.format(key)]
                        # As mhri.launch starts them.
                        + (['--stand-by'] if key in ('mux', 'gates') else []))
        for name in ROBOTS:
            self._start_robot(name)
        self.start_operator()
        self.state = StateEar()
        self.runs = []
        rospy.Subscriber('/mhri_tasks/list', TaskList, self._hear_list, queue_size=1)
        self._client = actionlib.ActionClient('/mhri_tasks/run', RunTaskAction)
        return self

    def __exit__(self, *_):
        rospy.signal_shutdown('done')
        for process in self.processes.values():
            for one in self._family(process):
                with contextlib.suppress(psutil.NoSuchProcess):
                    one.kill()
        self.system.close()
        for computer in self.computers.values():
            computer.close()

    def _hear_list(self, message):
        self.runs = message.runs

    def _start(self, key, words, env=None):
        with (self.folder / '{}.log'.format(key)).open('ab') as log:
            self.processes[key] = subprocess.Popen(
                words, env=dict(self.system.env, **(env or {})), stdin=subprocess.PIPE, stdout=log,
                stderr=log, start_new_session=True)

    def _start_robot(self, name):
        kind, model, topics, y_m, guarded = ROBOTS[name]
        rospy.set_param('/{}/robot_type'.format(name), kind)
        if model:
            rospy.set_param('/{}/robot_model'.format(name), model)
        rospy.set_param('/{}/mhri_guard/command'.format(name), topics[0])
        env = {'ROS_NAMESPACE': '/' + name}
        computer = self.computers.get(name)
        if computer is not None:
            env['ROS_IP'] = computer.ip
        sim = [sys.executable, str(HERE / 'logged_sim.py'), self.logs[name].path, *topics,
               '_x:="{}"'.format(LANE_M[0]), '_y:="{}"'.format(y_m), '_mocap:=true', '_seed:=1']
        for key, words in (('robot_' + name, sim),
                           ('guard_' + name, [sys.executable, PROCESS, 'guard', GUARD])):
            if key.startswith('robot') or guarded:
                self._start(key, computer.command(*words) if computer else words, env)

    def start_operator(self):
        """Start who is in control: nobody is checked, the stick is centred."""
        self._start('operator', [sys.executable, PROCESS, 'operator', OPERATOR])
        self.check()

    def check(self, *names):
        """Check exactly these robots."""
        stream = self.processes['operator'].stdin
        stream.write((' '.join(('select',) + names) + '\n').encode())
        stream.flush()

    @staticmethod
    def _family(process):
        try:
            first = psutil.Process(process.pid)
            return [first] + first.children(recursive=True)
        except psutil.NoSuchProcess:
            return []

    def kill(self, key):
        """Send SIGKILL to a node, which is started again, or to the operator, who is not."""
        # The youngest one works: those before it start it again.
        os.kill(wait_for(lambda: [one.pid for one in self._family(self.processes[key])
                                  if 'python' in one.name()
                                  and one.status() != psutil.STATUS_ZOMBIE], 30.0, key)[-1],
                signal.SIGKILL)

    def cut(self, name, down):
        """Cut the link of a robot, or mend it."""
        machines.run('ip', 'link', 'set', self.computers[name].cable, 'down' if down else 'up')

    def stop(self, stopped):
        """Engage or release stop-all; return whether that was done."""
        try:
            return rospy.ServiceProxy('/mux/set_stop_all', SetBool)(stopped).success
        except (rospy.ServiceException, rospy.ROSException, OSError):
            return False

    def ready(self):
        """Wait until every robot could be given a task."""
        wait_for(lambda: self.stop(False), PATIENCE_S, 'the release of the stop', 0.1)
        wait_for(lambda: self._client.wait_for_server(rospy.Duration(1.0)), PATIENCE_S, 'the tasks')
        for name in ROBOTS:
            self.state.wait_robot(
                name, lambda gate: gate.topic and not gate.obeys and not gate.stands
                and gate.guarded == ROBOTS[name][4] and time.monotonic() - self.state.at < 0.9,
                lambda: 'the gate of {}: {}'.format(name, self.state.robot(name)), PATIENCE_S)

    def patrol(self, least_s=0.0):
        """Send every robot on patrol; return when all of them drive, and so much time has passed.

        Again, whose task did not reach it in time: of a busy computer that is to be expected.
        """
        goals, begun = {}, time.monotonic()

        def going():
            for name, (_, _, _, y_m, _) in ROBOTS.items():
                if name not in goals or goals[name].get_comm_state() == actionlib.CommState.DONE:
                    goals[name] = self._client.send_goal(RunTaskGoal(
                        'patrol', [name], '{{route: {}, speed: 0.2}}'.format(
                            [[LANE_M[1], y_m], [LANE_M[0], y_m]])))
            return time.monotonic() - begun >= least_s and all(
                log.drives() for log in self.logs.values())
        wait_for(going, PATIENCE_S, lambda: 'all to drive; {}'.format(
            [(row.robot, row.state, row.text) for run in self.runs for row in run.robots]), 0.01)

    def on_task(self):
        """Return the robots that have a task."""
        return {row.robot for run in self.runs for row in run.robots
                if row.state in ('running', 'waiting')}

    def cancel(self):
        """End all tasks."""
        self._client.cancel_all_goals()


__all__ = ['NODES', 'ROBOTS', 'TaskSystem']
