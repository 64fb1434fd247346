# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The node of the tasks: sends velocities to robots on a task, 20 times a second.

Interfaces (global names; SI units):

- serves the action ``/mhri_tasks/run`` (``mhri/RunTask``), any number of goals at a time, and
  ``/mhri_tasks/end`` (``mhri/EndTask``), which takes single robots out of their goals
- publishes ``/mux_in/task`` (``mhri/TeamTwist``, 20 Hz while a robot is on a task, without those
  that their own navigation drives; with zeros for 0.6 s after it), ``/mux_in/accessory``
  (``mhri/Accessory``, as tasks ask for) and ``/mhri_tasks/list`` (``mhri/TaskList``, latched, on
  change)
- subscribes ``/mux/state`` (``mhri/DriveState``), only from the mux in force; odometry, battery
  and ``/vrpn_client_node/<robot>/pose`` of every robot of the mux; laser or depth camera of robots
  on a task
- keeps the places of robots: :mod:`mhri.map.ros.place_keeper`

The action server has its own lock, held while it calls :meth:`Tasks._on_goal`: it is never called
while this object's lock is held.
"""
import math
import threading
import time

from geometry_msgs.msg import Twist
import rospy

from mhri.base.config import ConfigError, short
from mhri.base.limits import ZERO
from mhri.base.reasons import NO_LISTENER, Reason
from mhri.graph.ros.master_api import MasterError
from mhri.graph.ros.non_blocking import NonBlockingPublisher
from mhri.graph.ros.service_owner import ServiceOwner, STOP_SERVICE
from mhri.graph.ros.worker import Worker
from mhri.map.ros.map_source import MapSource
from mhri.map.ros.place_keeper import PlaceKeeper
from mhri.map.ros.place_services import PlaceServices
from mhri.msg import (
    Accessory, DriveState, RunTaskAction, RunTaskActionResult, RunTaskFeedback, RunTaskResult,
    TaskList, TaskRun, TeamTwist)
from mhri.robots.ros.convert import to_twist
from mhri.robots.ros.tf_feed import TfFeed
from mhri.srv import EndTask, EndTaskResponse
from mhri.tasks.base import DONE, FAILED, LOST, STOPPED, TAKEN_OVER
from mhri.tasks.ros.run_server import RunServer
from mhri.tasks.ros.sensed_robots import SensedRobots
from mhri.tasks.ros.starter import Starter
from mhri.tasks.ros.words import kind_message, state_message
from mhri.tasks.rows import BY_KEY
from mhri.tasks.run import ENDED, Facts

TICK_S = 0.05
FEEDBACK_EVERY = 4
# Duration of zeros after a task [s]: by then the mux has released the robot.
ZEROS_S = 0.6
# The mux publishes at 2 Hz: its state is lost if it is later than this [s].
SILENT_S = 0.9
# Time that the shutdown waits for a status being published [s].
JOIN_S = 0.5


class _Goal:
    """An accepted goal: its handle, and the run of each of its robots."""

    def __init__(self, handle, goal, values):
        self.handle = handle
        self.id = handle.get_goal_id().id
        self.key = goal.task
        self.parameters = goal.parameters
        self.team = tuple(goal.robots)
        # The robots in the order of the slots: see Starter.in_order.
        self.order = values.team or self.team
        self.values = values
        self.cancelled = False
        self.runs = []
        self.ready = False

    def over(self):
        """Return whether every robot has ended."""
        return self.ready and all(run.phase == ENDED for run in self.runs)

    def message(self):
        """Return its ``mhri/TaskRun``."""
        return TaskRun(id=self.id, task=self.key, parameters=self.parameters,
                       robots=[state_message(run) for run in self.runs])


class Tasks:
    """The tasks of all robots.

    :param types: {name: RobotType}
    :param kinds: {key: TaskKind}
    :param grid: grid of a map to publish; None: use the published map
    :param keeps_to_map: whether robots on a task stay on the free floor of that map
    :param beat: called in every step: :meth:`mhri.graph.ros.undertaker.Undertaker.beat`
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
        self._seen = SensedRobots(types, clock, frames)
        self._map = MapSource(grid)
        self._keeps_to_map = keeps_to_map
        self.places = PlaceKeeper(self._seen, self._map, clock, frames)
        self._force = ServiceOwner(STOP_SERVICE)
        self._starter = Starter(kinds, self._seen, self.places, lambda: self._force.caller, clock)
        self._goals = {}
        # {robot: its newest RobotRun}: a robot has one task.
        self._runs = {}
        # {robot: its newest mhri/RobotDrive}
        self._drives = {}
        self._heard_at = None
        self._stop_all = False
        self._operator = ''
        self._reported = None
        self._worker = Worker('tasks_calls', self._between_calls)
        self._server = None

    def start(self):
        """Start the subscribers, services and threads."""
        self._task = NonBlockingPublisher('/mux_in/task', TeamTwist)
        self._accessory = rospy.Publisher('/mux_in/accessory', Accessory, queue_size=50,
                                          tcp_nodelay=True)
        self._list = rospy.Publisher('/mhri_tasks/list', TaskList, queue_size=1, latch=True)
        self._force.subscribe('/mux/state', DriveState, self._on_state, queue_size=10,
                              tcp_nodelay=True)
        self._map.start()
        self.places.start()
        PlaceServices(self._seen, self.places, self._map, self.is_busy, self._worker).start()
        rospy.Service('/mhri_tasks/end', EndTask, self._on_end)
        self._force.start()
        self._worker.start()
        self._server = RunServer('/mhri_tasks/run', RunTaskAction, self._on_goal,
                                 self._on_cancel, auto_start=False)
        self._server.start()
        # Latched: a client that sent a goal while this node was starting may not be connected yet
        # when a short task ends.
        self._result = rospy.Publisher('/mhri_tasks/run/result', RunTaskActionResult,
                                       queue_size=50, latch=True)
        self._report(0)
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
        # Its timer would continue to publish on closed topics.
        timer = getattr(self._server, 'status_timer', None)
        if timer is not None:
            timer.shutdown()
            timer.join(JOIN_S)

    def is_busy(self, name):
        """Return whether a robot is on a task."""
        with self._lock:
            return name in self._runs and self._runs[name].phase != ENDED

    def summary(self):
        """Return {robot: (task state, sentence)} of the robots on a task."""
        with self._lock:
            return {name: (run.state, run.text) for name, run in self._runs.items()
                    if run.phase != ENDED}

    def _between_calls(self):
        """Save drawn marks and fences, and process a new map (on the worker)."""
        self.places.keep()
        self._map.look()

    def _on_state(self, message):
        with self._lock:
            names = set(self._drives)
            self._drives = {robot.name: robot for robot in message.robots}
            self._heard_at = self._clock()
            self._stop_all = message.stop_all
            self._watch_operator(message.operator if message.leased else '')
            if names != set(self._drives):
                self._worker.do(self._update_robots)
        self._wake.set()

    def _watch_operator(self, operator):
        """End every task if the operator in control has left or timed out.

        Tasks started without an operator in control, from a terminal, continue.
        """
        before, self._operator = self._operator, operator
        if before and operator != before:
            for run in self._runs.values():
                run.end(LOST, 'nobody is in control: {} has gone or has stopped sending'.format(
                    before) if not operator else '{} took control'.format(operator), self._clock())

    def _update_robots(self):
        """Sense the robots of the mux; retried while the master does not respond."""
        try:
            self._starter.sense_only(list(self._drives))
        except (MasterError, OSError) as error:
            rospy.logwarn_throttle(5.0, 'cannot query the robots: {}'.format(error))
            if not self._done.wait(1.0):
                self._worker.do(self._update_robots)

    def _on_goal(self, handle):
        """Accept a valid goal, and start it on the worker."""
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
        """End the tasks of robots; other robots on the same goals continue."""
        with self._lock:
            busy = [name for name in dict.fromkeys(request.robots) if self.is_busy(name)]
            for name in busy:
                self._runs[name].end(STOPPED, 'it was ended', self._clock())
        self._wake.set()
        return EndTaskResponse(bool(busy), 'ended: ' + ', '.join(busy) if busy
                               else 'none of these robots is on a task')

    def _begin(self, goal):
        """Open the inputs of a goal, and start the runs of its robots (on the worker)."""
        try:
            self._map.look()
            drives, problem = self._starter.prepare(goal.key, goal.values, goal.team,
                                                    list(self._drives))
            goal.team = tuple(self._starter.in_order(goal))
        except Exception as error:  # a task may come from a lab's package, a bag from anywhere
            drives, problem = {}, 'its task cannot be started: {!r}'.format(error)[:200]
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
            # The next step is at most one period away, even after many early wake-ups.
            now = self._clock()
            due = min(max(due + TICK_S, now), now + TICK_S)
            self._wake.wait(due - now)
            self._wake.clear()
            number += 1
            self._beat()
            try:
                self._tick(number)
            except Exception as error:  # this thread must not end: it stops tasks
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
        self._report(number)

    def _publish(self, now):
        """Publish the velocities of all robots on a task; called with the lock held."""
        busy = {name for name, run in self._runs.items() if run.phase != ENDED}
        message = TeamTwist()
        for name, run in self._runs.items():
            if run.phase == ENDED:
                if now - run.ended_s <= ZEROS_S:
                    message.robots.append(name)
                    message.twists.append(Twist())
                continue
            velocity = self._ticked(run, now, busy)
            self._act(run)
            if not run.drives:
                continue
            message.robots.append(name)
            message.twists.append(to_twist(*velocity))
        # Also without robots: the mux cancels what nobody supervises.
        if message.robots or busy:
            message.header.stamp = rospy.Time.now()
            self._task.publish(message)

    def _act(self, run):
        """Use the accessories that a task asks for; the drive refuses what may not be now."""
        acts, run.acts = run.acts, []
        drive = self._drives.get(run.robot)
        states = {state.key: state for state in drive.accessories} if drive else {}
        for key, choice in acts:
            state = states.get(key)
            problem = 'the drive service knows none' if state is None else \
                Reason(NO_LISTENER).sentence if state.stands == NO_LISTENER else ''
            run.said.append(' '.join(filter(None, (key, choice))) + (': ' + problem if problem
                                                                     else ''))
            self._accessory.publish(robots=[run.robot], key=key, choice=choice)

    def _ticked(self, run, now, busy):
        """Return the velocity of a robot; an error in a task only ends its own run."""
        try:
            return run.tick(self._facts(run, now, busy))
        except Exception as error:  # a task may come from a lab's package
            rospy.logerr('%s: its task failed: %r', run.robot, error)
            run.end(FAILED, 'its task failed: {!r}'.format(error)[:200], now)
            return ZERO

    def _facts(self, run, now, busy):
        """Return the :class:`Facts` of a robot."""
        name = run.robot
        drive, robot = self._drives.get(name), self._seen.get(name)
        known = dict(stop_all=self._stop_all, known=drive is not None,
                     answers=self._heard_at is not None and now - self._heard_at <= SILENT_S)
        if drive is not None:
            known.update(obeys=drive.obeys, stands=drive.stands)
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
        """Publish the results of ended goals; called without the lock."""
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

    def _report(self, number):
        """Publish feedback five times a second, and the list on change."""
        if number % FEEDBACK_EVERY:
            return
        with self._lock:
            goals = [goal for goal in self._goals.values() if goal.ready]
            runs = [goal.message() for goal in goals]
        for goal, run in zip(goals, runs):
            goal.handle.publish_feedback(RunTaskFeedback(robots=run.robots))
        reported = [(run.id, [(robot.robot, robot.state) for robot in run.robots]) for run in runs]
        marks = sorted(self.places.marks())
        if (reported, marks) != self._reported:
            self._reported = reported, marks
            message = TaskList(tasks=[kind_message(kind) for kind in self._kinds.values()],
                               runs=runs, marks=marks)
            message.header.stamp = rospy.Time.now()
            self._list.publish(message)
