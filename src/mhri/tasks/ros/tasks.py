# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The node of the tasks: robots on a task are given their velocities, 20 times a second.

Interfaces (global names; SI units):

- serves the action ``/mhri_tasks/run`` (``mhri/RunTask``), any number of goals at a time, and
  ``/mhri_tasks/end`` (``mhri/EndTask``), which takes single robots out of their goals
- publishes ``/mux_in/task`` (``mhri/TeamTwist``, 20 Hz while a robot is on a task, with zeros for
  0.6 s after it) and ``/mhri_tasks/list`` (``mhri/TaskList``, latched, on change)
- subscribes ``/gates/state`` (``mhri/GatesState``) and ``/robot_controller/stop_all``
  (``std_msgs/Bool``), each from the node in force alone; of every robot that the gates know its
  odometry and ``/vrpn_client_node/<robot>/pose``; of robots on a task laser, or depth
  camera, and battery as well
- knows where robots are placed: :mod:`mhri.map.ros.place_keeper`

The action server has a lock of its own, held while it calls :meth:`Tasks._on_goal`: nothing of it
is called while this object's lock is held.
"""
import math
import threading
import time

from geometry_msgs.msg import Twist
import rospy
from std_msgs.msg import Bool

from mhri.base.config import ConfigError, short
from mhri.base.limits import ZERO
from mhri.graph.ros.in_force import InForce, STOP_SERVICE, TAKE_SERVICE
from mhri.graph.ros.master_api import MasterError
from mhri.graph.ros.prompt import PromptPublisher
from mhri.graph.ros.worker import Worker
from mhri.map.ros.map_source import MapSource
from mhri.map.ros.place_keeper import PlaceKeeper
from mhri.map.ros.place_services import PlaceServices
from mhri.msg import (
    GatesState, RunTaskAction, RunTaskActionResult, RunTaskFeedback, RunTaskResult, TaskList,
    TaskRun, TeamTwist)
from mhri.robots.ros.convert import to_twist
from mhri.robots.ros.tf_feed import TfFeed
from mhri.srv import EndTask, EndTaskResponse
from mhri.tasks.base import DONE, FAILED, LOST, STOPPED, TAKEN_OVER
from mhri.tasks.ros.run_server import RunServer
from mhri.tasks.ros.seen_robots import SeenRobots
from mhri.tasks.ros.starter import Starter
from mhri.tasks.ros.words import kind_message, state_message
from mhri.tasks.rows import BY_KEY
from mhri.tasks.run import ENDED, Facts

TICK_S = 0.05
FEEDBACK_EVERY = 4
# Zeros for so long after a task has ended [s]: then its gate lets go of it.
ZEROS_S = 0.6
# The gates speak at 2 Hz: a word late by this much is a word that does not come [s].
SILENT_S = 0.9
# So long the end waits for a status that is being published.
JOIN_S = 0.5


class _Goal:
    """A goal that was accepted: its handle, and the run of each of its robots."""

    def __init__(self, handle, goal, values):
        self.handle = handle
        self.id = handle.get_goal_id().id
        self.key = goal.task
        self.parameters = goal.parameters
        self.team = tuple(goal.robots)
        # In whose order places are counted: see Starter.in_order.
        self.order = values.team or self.team
        self.values = values
        self.cancelled = False
        self.runs = []
        self.ready = False

    def over(self):
        """Tell whether every robot has ended."""
        return self.ready and all(run.phase == ENDED for run in self.runs)

    def message(self):
        """Return its ``mhri/TaskRun``."""
        return TaskRun(id=self.id, task=self.key, parameters=self.parameters,
                       robots=[state_message(run) for run in self.runs])


class Tasks:
    """The tasks of all robots.

    :param types: {name: RobotType}
    :param kinds: {key: TaskKind} of the tasks that can be started
    :param grid: of a map that is to be published; None: whatever map there is
    :param keeps_to_map: no robot on a task leaves the free floor of that map
    :param beat: called in every step: see :func:`mhri.graph.ros.stand_by.stand_by`
    :param clock: seconds, monotonic
    """

    def __init__(self, types, kinds=BY_KEY, grid=None, clock=time.monotonic,
                 keeps_to_map=True, beat=lambda: None):
        self._kinds = kinds
        self._beat = beat
        self._clock = clock
        self._lock = threading.RLock()
        self._wake = threading.Event()
        self._done = threading.Event()
        frames = TfFeed(clock)
        self._seen = SeenRobots(types, clock, frames)
        self._map = MapSource(grid)
        self._keeps_to_map = keeps_to_map
        self.places = PlaceKeeper(self._seen, self._map, clock, frames)
        self._gates_force = InForce(TAKE_SERVICE)
        self._mux_force = InForce(STOP_SERVICE)
        self._starter = Starter(kinds, self._seen, self.places, lambda: self._gates_force.caller,
                                clock)
        self._goals = {}
        # {robot: its newest RobotRun}: a robot has one task.
        self._runs = {}
        self._gates = {}
        self._heard_at = None
        self._gates_stop = self._mux_stop = False
        self._operator = ''
        self._told = None
        self._worker = Worker('tasks_calls', self._between_calls)
        self._server = None

    def start(self):
        """Listen, serve and begin to tick; returns at once."""
        self._task = PromptPublisher('/mux_in/task', TeamTwist)
        self._list = rospy.Publisher('/mhri_tasks/list', TaskList, queue_size=1, latch=True)
        self._gates_force.subscribe('/gates/state', GatesState, self._on_gates, queue_size=10,
                                    tcp_nodelay=True)
        self._mux_force.subscribe('/robot_controller/stop_all', Bool, self._on_stop, queue_size=10,
                                  tcp_nodelay=True)
        self._map.start()
        self.places.start()
        PlaceServices(self._seen, self.places, self._map, self.is_busy, self._worker).start()
        rospy.Service('/mhri_tasks/end', EndTask, self._on_end)
        self._gates_force.start()
        self._mux_force.start()
        self._worker.start()
        self._server = RunServer('/mhri_tasks/run', RunTaskAction, self._on_goal,
                                 self._on_cancel, auto_start=False)
        self._server.start()
        # Whoever asked while this node was coming up may not be connected yet when a short task
        # ends: its result waits for it.
        self._result = rospy.Publisher('/mhri_tasks/run/result', RunTaskActionResult,
                                       queue_size=50, latch=True)
        self._tell(0)
        threading.Thread(target=self._run, name='tasks', daemon=True).start()
        return self

    def close(self):
        """End every task with a zero."""
        with self._lock:
            now = self._clock()
            for run in self._runs.values():
                run.end(FAILED, 'mhri_tasks was ended', now)
            self._publish(now)
        self._finish()
        self._done.set()
        self._worker.stop()
        # It would go on to publish on topics that are closed by then.
        timer = getattr(self._server, 'status_timer', None)
        if timer is not None:
            timer.shutdown()
            timer.join(JOIN_S)

    def is_busy(self, name):
        """Tell whether a robot is on a task."""
        with self._lock:
            return name in self._runs and self._runs[name].phase != ENDED

    def summary(self):
        """Return {robot: (task state, sentence)} of the robots on a task."""
        with self._lock:
            return {name: (run.state, run.text) for name, run in self._runs.items()
                    if run.phase != ENDED}

    def _between_calls(self):
        """Write what was drawn, and look at a new map (on the worker)."""
        self.places.keep()
        self._map.look()

    def _on_gates(self, message):
        with self._lock:
            names = set(self._gates)
            self._gates = {robot.name: robot for robot in message.robots}
            self._heard_at = self._clock()
            self._gates_stop = message.stop_all
            self._watch_operator(message.operator if message.leased else '')
            if names != set(self._gates):
                self._worker.do(self._know)
        self._wake.set()

    def _watch_operator(self, operator):
        """End every task if the operator in control has gone or fallen silent.

        Who began tasks with nobody in control, from a terminal, goes on without.
        """
        before, self._operator = self._operator, operator
        if before and operator != before:
            for run in self._runs.values():
                run.end(LOST, 'nobody is in control any more: {} has gone or fallen silent'.format(
                    before) if not operator else '{} took control'.format(operator), self._clock())

    def _on_stop(self, message):
        with self._lock:
            self._mux_stop = message.data
        if message.data:
            self._wake.set()

    def _know(self):
        """See the robots that the gates know; tried again where the master does not answer."""
        try:
            self._starter.know(list(self._gates))
        except (MasterError, OSError) as error:
            rospy.logwarn_throttle(5.0, 'the robots cannot be looked at: {}'.format(error))
            if not self._done.wait(1.0):
                self._worker.do(self._know)

    def _on_goal(self, handle):
        """Accept a goal that can be understood, and begin it on the worker."""
        goal = handle.get_goal()
        try:
            values = self._starter.values_of(goal)
        except ConfigError as error:
            handle.set_rejected(RunTaskResult(), short(error))
            return
        handle.set_accepted('started')
        accepted = _Goal(handle, goal, values)
        with self._lock:
            self._goals[accepted.id] = accepted
        self._worker.do(self._begin, accepted)

    def _on_cancel(self, handle):
        with self._lock:
            goal = self._goals.get(handle.get_goal_id().id)
            if goal is not None:
                goal.cancelled = True
                for run in goal.runs:
                    run.end(STOPPED, 'it was cancelled', self._clock())
        self._wake.set()

    def _on_end(self, request):
        """End what robots are busy with; the others on the same goals go on."""
        with self._lock:
            busy = [name for name in dict.fromkeys(request.robots) if self.is_busy(name)]
            for name in busy:
                self._runs[name].end(STOPPED, 'it was ended', self._clock())
        self._wake.set()
        return EndTaskResponse(bool(busy), 'ended: ' + ', '.join(busy) if busy
                               else 'none of these robots is on a task')

    def _begin(self, goal):
        """Open what the robots of a goal need, and begin their runs (on the worker)."""
        try:
            self._map.look()
            drives, problem = self._starter.prepare(goal.key, goal.values, goal.team,
                                                    list(self._gates))
            goal.team = tuple(self._starter.in_order(goal))
        except Exception as error:  # a task may be a lab's own, a bag anybody's
            drives, problem = {}, 'its task cannot be begun: {!r}'.format(error)[:200]
        goal.order = goal.values.team or goal.team
        with self._lock:
            now = self._clock()
            for name in goal.team:
                run = self._starter.run(goal, name, drives, problem, now)
                before = self._runs.get(name)
                if before is not None:
                    before.end(TAKEN_OVER, 'it got another task: {}'.format(goal.key), now)
                self._runs[name] = run
                goal.runs.append(run)
                if goal.cancelled:
                    run.end(STOPPED, 'it was cancelled', now)
            goal.ready = True

    def _run(self):
        number = 0
        due = self._clock()
        while not (self._done.is_set() or rospy.is_shutdown()):
            # Never further off than a step, however often it was woken before its time.
            now = self._clock()
            due = min(max(due + TICK_S, now), now + TICK_S)
            self._wake.wait(due - now)
            self._wake.clear()
            number += 1
            self._beat()
            try:
                self._tick(number)
            except Exception as error:  # without this thread no task would ever end
                rospy.logerr_throttle(1.0, 'the tasks failed: {!r}'.format(error))
                with self._lock:
                    for run in self._runs.values():
                        run.end(FAILED, 'an error of mhri_tasks: {!r}'.format(error)[:200],
                                self._clock())

    def _tick(self, number):
        self._seen.look()
        self.places.look()
        with self._lock:
            self._publish(self._clock())
        self._finish()
        self._tell(number)

    def _publish(self, now):
        """Publish what every robot on a task shall do; called with the lock held."""
        busy = {name for name, run in self._runs.items() if run.phase != ENDED}
        message = TeamTwist()
        for name, run in self._runs.items():
            if run.phase == ENDED:
                if now - run.ended_s <= ZEROS_S:
                    message.robots.append(name)
                    message.twists.append(Twist())
                continue
            velocity = self._ticked(run, now, busy)
            if not run.drives:
                continue
            message.robots.append(name)
            message.twists.append(to_twist(velocity.linear_mps, velocity.angular_rad_s))
        if message.robots:
            message.header.stamp = rospy.Time.now()
            self._task.publish(message)

    def _ticked(self, run, now, busy):
        """Return what a robot shall do; a task that fails ends its own run alone."""
        try:
            return run.tick(self._facts(run, now, busy))
        except Exception as error:  # a task may be a lab's own
            rospy.logerr('%s: its task failed: %r', run.robot, error)
            run.end(FAILED, 'its task failed: {!r}'.format(error)[:200], now)
            return ZERO

    def _facts(self, run, now, busy):
        """Return the :class:`Facts` of a robot."""
        name = run.robot
        gate, robot = self._gates.get(name), self._seen.get(name)
        known = dict(stop_all=self._mux_stop or self._gates_stop, known=gate is not None,
                     answers=self._heard_at is not None and now - self._heard_at <= SILENT_S)
        if gate is not None:
            known.update(obeys=gate.obeys, stands=gate.stands)
        if robot is not None:
            known.update(robot.ages(), has_laser=robot.has_eye, looks=robot.looks(),
                         unplaced=robot.has_unplaced(),
                         battery=robot.charge, senses=self._seen.senses(
                             robot, now, busy, self.places.place, self.places.fence(),
                             self._map.floor if self._keeps_to_map else None))
        if run.placed or self.places.fence():
            place = self.places.place(name)
            age_s = 0.0 if math.isnan(place.age_s) else place.age_s
            known.update(place_age_s=None if place.odometry is None else age_s,
                         place_text=place.text, settling=self.places.settling(name))
        return Facts(now, **known)

    def _finish(self):
        """Tell the results of the goals that are over; called without the lock."""
        with self._lock:
            over = [goal for goal in self._goals.values() if goal.over()]
            for goal in over:
                del self._goals[goal.id]
        for goal in over:
            result = RunTaskResult(robots=[state_message(run) for run in goal.runs])
            words = '; '.join('{}: {}'.format(run.robot, run.text) for run in goal.runs)
            rospy.loginfo('task %s ended: %s', goal.key, words)
            if goal.cancelled:
                goal.handle.set_canceled(result, words)
            elif all(run.state == DONE for run in goal.runs):
                goal.handle.set_succeeded(result, words)
            else:
                goal.handle.set_aborted(result, words)

    def _tell(self, number):
        """Publish feedback five times a second, and the list on change."""
        if number % FEEDBACK_EVERY:
            return
        with self._lock:
            goals = [goal for goal in self._goals.values() if goal.ready]
            runs = [goal.message() for goal in goals]
        for goal, run in zip(goals, runs):
            goal.handle.publish_feedback(RunTaskFeedback(robots=run.robots))
        told = [(run.id, [(robot.robot, robot.state) for robot in run.robots]) for run in runs]
        marks = sorted(self.places.marks())
        if (told, marks) != self._told:
            self._told = told, marks
            message = TaskList(tasks=[kind_message(kind) for kind in self._kinds.values()],
                               runs=runs, marks=marks)
            message.header.stamp = rospy.Time.now()
            self._list.publish(message)
