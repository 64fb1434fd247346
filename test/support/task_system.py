# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Mux, tasks, an operator and simulated robots on patrol, each a process that can be killed.

With a :class:`support.machines.Lan` each robot has a computer of its own, whose link can be cut;
without one all of it is on this computer.
"""
import collections
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
from support import graph
from support import machines
from support.fake_mux import StateEar
from support.random_world import GUARD, HERE, PROCESS
from support.robots import RobotLog
from support.ros_system import family_of, node_words, say_insisted, System, tell, wait_for

TIMEOUT_S = 90.0
NODES = ('mux', 'tasks')
OPERATOR = 'operator_a'
# Name: (robot_type, model, its velocity topics, lane y [m], whether a guard runs on it).
ROBOTS = {'bot1': ('turtlebot2', '', ('teleop/input', 'cmd_vel_mux/input/teleop'), 1.0, True),
          'bot2': ('turtlebot3', 'waffle', ('cmd_vel',), 2.1, False),
          'bot3': ('turtlebot3', 'burger', ('cmd_vel',), 3.2, True)}
LANE_M = (3.0, 8.0)


class TaskSystem:
    """The whole of it; use it as a context manager.

    :param lan: :class:`support.machines.Lan`, None for one computer
    """

    def __init__(self, folder, lan):
        self.folder = folder
        self.system = System() if lan is None else System(ip=machines.HOST_IP)
        self.computers = {name: machines.Computer(11 + number)
                          for number, name in enumerate(ROBOTS)} if lan is not None else {}
        self.logs = {name: RobotLog(str(folder / name)) for name in ROBOTS}
        self.processes = {}

    def __enter__(self):
        self.system.start_master()
        rospy.init_node('random_stops', disable_signals=True)
        self._mode = rospy.Publisher(graph.MODE_SELECT, ControlMode, queue_size=1, latch=True)
        self._mode.publish('joy')
        rospy.set_param('/mhri/robots', list(ROBOTS))
        for key in NODES:
            # As mhri.launch starts them.
            self._start(key, node_words(key, '--stand-by'))
        for name in ROBOTS:
            self._start_robot(name)
        self.start_operator()
        self.state = StateEar()
        self.runs = []
        rospy.Subscriber(graph.TASK_LIST, TaskList, self._hear_list, queue_size=1)
        self._client = actionlib.ActionClient(graph.RUN_TASK, RunTaskAction)
        return self

    def __exit__(self, *_):
        rospy.signal_shutdown('done')
        for process in self.processes.values():
            self.system.kill(process)
        self.system.close()
        for computer in self.computers.values():
            computer.close()

    def _hear_list(self, message):
        self.runs = message.runs

    def _start(self, key, words, env=None):
        self.processes[key] = self.system.start(
            *words, log=str(self.folder / (key + '.log')), env=env, stdin=subprocess.PIPE)

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
        tell(self.processes['operator'], ' '.join(('select',) + names))

    def kill(self, key):
        """Send SIGKILL to a node, which is started again, or to the operator, who is not."""
        # The youngest one works: the one before it starts it again.
        os.kill(wait_for(lambda: [one.pid for one in family_of(self.processes[key])
                                  if 'python' in one.name()
                                  and one.status() != psutil.STATUS_ZOMBIE], 30.0, key)[-1],
                signal.SIGKILL)

    def stop(self, stopped):
        """Engage or release stop-all; return whether that was done."""
        try:
            return rospy.ServiceProxy(graph.SET_STOP_ALL, SetBool)(stopped).success
        except (rospy.ServiceException, rospy.ROSException, OSError):
            return False

    def ready(self):
        """Wait until every robot could be given a task."""
        wait_for(lambda: self.stop(False), TIMEOUT_S, 'the release of the stop', 0.1)
        wait_for(lambda: self._client.wait_for_server(rospy.Duration(1.0)), TIMEOUT_S, 'the tasks')
        for name in ROBOTS:
            self.state.wait_robot(
                name, lambda gate: gate.topic and not gate.obeys and not gate.stands
                and gate.guarded == ROBOTS[name][4] and time.monotonic() - self.state.at < 0.9,
                lambda: 'the gate of {}: {}'.format(name, self.state.robot(name)), TIMEOUT_S)

    def patrol(self, least_s=0.0):
        """Send every robot on patrol; return when all of them drive, and so much time has passed.

        Again, whose task did not reach it in time.
        """
        goals, sent, begun = {}, collections.Counter(), time.monotonic()

        def going():
            for name, (_, _, _, y_m, _) in ROBOTS.items():
                if name not in goals or goals[name].get_comm_state() == actionlib.CommState.DONE:
                    sent[name] += 1
                    goals[name] = self._client.send_goal(RunTaskGoal(
                        'patrol', [name], '{{route: {}, speed: 0.2}}'.format(
                            [[LANE_M[1], y_m], [LANE_M[0], y_m]])))
            return time.monotonic() - begun >= least_s and all(
                log.drives() for log in self.logs.values())
        wait_for(going, TIMEOUT_S, lambda: 'all to drive; {}'.format(
            [(row.robot, row.state, row.text) for run in self.runs for row in run.robots]), 0.01)
        say_insisted(max(sent.values()), 'all to be on patrol')

    def on_task(self):
        """Return the robots that have a task."""
        return {row.robot for run in self.runs for row in run.robots
                if row.state in ('running', 'waiting')}

    def cancel(self):
        """End all tasks."""
        self._client.cancel_all_goals()


__all__ = ['NODES', 'ROBOTS', 'TaskSystem']
