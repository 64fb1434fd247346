# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The executable ``mhri_task``: starts a task from a terminal and prints its progress.

``rosrun mhri mhri_task bot1 goto 2.0 1.5``; see ``--help``. The exit status is 0 if every robot is
done, 1 if one is not (with ``--help``: if a lab's task was left out), 2 if the command line is
invalid.
"""
import sys

import actionlib
import rospy

from mhri.base.config import yaml_text
from mhri.graph.ros.master_api import MasterApi, MasterError
from mhri.graph.ros.rospy_inside import name_in
from mhri.msg import RunTaskAction, RunTaskGoal, TaskState
from mhri.tasks.ros.exported import task_kinds
from mhri.tasks.words import parameters_of, TaskWordsError, usage

NODE_S = 5.0
CANCEL_S = 3.0


class Printer:
    """Prints the news of each robot, one line each."""

    def __init__(self):
        self._said = {}

    def on_feedback(self, feedback):
        """Print the lines since the last time, and each other sentence at most once in a row.

        The remaining distance is printed once per metre or change of state.
        """
        for robot in feedback.robots:
            lines, before = self._said.get(robot.robot, (0, None))
            for line in robot.said[lines:]:
                print('{}: {}'.format(robot.robot, line), flush=True)
            now = (robot.state, int(robot.left_m) if robot.left_m == robot.left_m else None)
            if now != before:
                print('{}: {}'.format(robot.robot, robot.text), flush=True)
            self._said[robot.robot] = (len(robot.said), now)

    def on_result(self, result):
        """Print the result; return whether every robot is done."""
        for robot in result.robots:
            lines, _ = self._said.get(robot.robot, (0, None))
            for line in robot.said[lines:]:
                if line != robot.text:
                    print('{}: {}'.format(robot.robot, line))
            print('{}: {}: {}'.format(robot.robot, robot.state.replace('_', ' '), robot.text))
        return bool(result.robots) and all(
            robot.state == TaskState.DONE for robot in result.robots)


def wait(client):
    """Wait for the result; cancel on Ctrl-C. Return whether there was a result."""
    connected = False
    while not client.wait_for_result(rospy.Duration(0.2)):
        here = client.action_client.pub_goal.get_num_connections() > 0
        connected = connected or here
        if connected and not here:
            return False
    return True


def run(robots, key, parameters):
    """Run one task to its end; return the exit status."""
    client = actionlib.SimpleActionClient('/mhri_tasks/run', RunTaskAction)
    if not client.wait_for_server(rospy.Duration(NODE_S)):
        print('mhri_tasks is not running: start mhri.launch', file=sys.stderr)
        return 1
    printer = Printer()
    client.send_goal(RunTaskGoal(key, robots, parameters), feedback_cb=printer.on_feedback)
    try:
        ended = wait(client)
    except KeyboardInterrupt:
        client.cancel_goal()
        ended = client.wait_for_result(rospy.Duration(CANCEL_S))
    if not ended:
        print('mhri_tasks has ended; its robots have stopped', file=sys.stderr)
        return 1
    result = client.get_result()
    if not result.robots:
        print(client.get_goal_status_text(), file=sys.stderr)
        return 2
    return 0 if printer.on_result(result) else 1


def main():
    """Parse the command line, run the task, and exit."""
    words = rospy.myargv(sys.argv)[1:]
    kinds, errors = task_kinds()
    for error in errors:
        print('left out: {}'.format(error), file=sys.stderr)
    if not words or words[0] in ('-h', '--help'):
        print(usage(list(kinds.values())))
        sys.exit((1 if errors else 0) if words else 2)
    try:
        robots, key, parameters = parameters_of(words, kinds)
        MasterApi('/mhri_task', timeout_s=2.0).call('getPid')
    except (TaskWordsError, MasterError) as error:
        sys.exit('mhri_task: {}'.format(error))
    name_in()
    rospy.init_node('mhri_task', anonymous=True, disable_signals=True, disable_rostime=True)
    status = run(robots, key, yaml_text(parameters))
    rospy.signal_shutdown('done')
    sys.exit(status)
