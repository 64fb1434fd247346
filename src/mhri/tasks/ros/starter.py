# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Checks a goal and whether each robot can start it, and creates their runs."""
from mhri.base.config import ConfigError
from mhri.base.names import name_problem
from mhri.graph.ros.master_api import MasterError
from mhri.map.assignment import shared_out
from mhri.tasks.acts import ACT
from mhri.tasks.base import FAILED, LOST, MARK, Start, TEAM
from mhri.tasks.delegated import DelegatedRun
from mhri.tasks.goto import ROW as GOTO, target_of
from mhri.tasks.replay import ROW as REPLAY
from mhri.tasks.ros.drives import DriveError, read_drive
from mhri.tasks.ros.move_base import MoveBases
from mhri.tasks.run import RobotRun

MAX_ROBOTS = 64
# A robot has to be placed this long after it becomes known, else it is refused [s].
PLACED_WITHIN_S = 2.0


class Starter:
    """Creates the runs of goals.

    :param kinds: {key: TaskKind}
    :param seen: :class:`mhri.tasks.ros.sensed_robots.SensedRobots`
    :param places: :class:`mhri.map.ros.place_keeper.PlaceKeeper`
    :param mux: function that returns the caller id of the active mux, '' while unknown
    """

    def __init__(self, kinds, seen, places, mux, clock):
        self._kinds = kinds
        self._seen = seen
        self._places = places
        self._move_bases = MoveBases(self._odometry_frame, mux, clock)

    def _odometry_frame(self, name):
        robot = self._seen.get(name)
        return robot.odometry_frame if robot else ''

    def values_of(self, goal):
        """Return the parameters of a ``mhri/RunTaskGoal``.

        :raises ConfigError: it is invalid
        """
        kind = self._kinds.get(goal.task)
        if kind is None:
            raise ConfigError('task', '', 'no task {!r}; there are {}'.format(
                goal.task[:60], ', '.join(self._kinds)))
        origin = 'task ' + goal.task
        if not 0 < len(goal.robots) <= MAX_ROBOTS or len(set(goal.robots)) < len(goal.robots):
            raise ConfigError(origin, 'robots', 'expected 1 to {} robots, each once'.format(
                MAX_ROBOTS))
        for name in goal.robots:
            problem = name_problem(name)
            if problem:
                raise ConfigError(origin, 'robots', '{!r}: {}'.format(name[:64], problem))
        values = kind.read(goal.parameters)
        if values.team and not set(goal.robots) <= set(values.team):
            raise ConfigError(origin, TEAM, 'has to name every robot that is started')
        return values

    def sense_only(self, names):
        """Sense exactly these robots (blocking: calls the master).

        :raises MasterError: the master is unavailable
        """
        # First cancel unknown goals, since robots are driving to them.
        self._move_bases.update(names)
        self._seen.sense_only(names)

    def prepare(self, key, values, team, names):
        """Open the inputs of a goal (blocking: calls the master and reads files).

        If one of its robots does not exist, none is started, since a name may be mistyped.

        :param names: all robots
        :returns: ({robot: its recorded drive}, the reason why it cannot be started or '')
        """
        unknown = [name for name in team if name not in names]
        try:
            self.sense_only(names)
            if unknown:
                return {}, 'the drive service does not know {}: add it to the list of robots; ' \
                    'nobody was started'.format(', '.join(unknown))
            self._seen.open(team)
            bag = values.text('bag') if key == REPLAY.key else ''
            return {name: self._drive(bag, values.text('topic'), name)
                    for name in team if bag}, ''
        except (MasterError, OSError) as error:
            return {}, 'the ROS master does not answer: {}'.format(error)
        except DriveError as error:
            return {}, str(error)

    def _drive(self, bag, topic, name):
        robot = self._seen.get(name)
        return read_drive(bag, [topic] if topic else robot.odometry_topics if robot else [])

    def in_order(self, goal):
        """Return the robots of a goal in the order of its slots, so that no paths cross.

        :param goal: as for :meth:`run`; the order is unchanged if poses are unknown
        """
        names, slots = list(goal.team), self._kinds[goal.key].slots
        if slots is None or goal.values.team or len(names) < 2:
            return names
        places = slots(goal.values, len(names), self._where)
        if len(places) < len(names):
            return names
        taken = shared_out([self._where(name) for name in names], places)
        return sorted(names, key=lambda name: taken[names.index(name)])

    def _where(self, name):
        """Return the :class:`Pose` of a robot or a mark in the frame of the map, or None."""
        if name.startswith(MARK):
            return self._places.mark(name[len(MARK):])
        robot, place = self._seen.get(name), self._places.place(name)
        return place.pose(robot.pose) if robot is not None and place.is_fresh else None

    def run(self, goal, name, drives, problem, now):
        """Return the run of one robot; it has ended already if it cannot be started.

        :param goal: has ``key``, ``values`` and ``order``, the team
        :param drives: see :meth:`prepare`, as is ``problem``
        """
        robot, kind, values = self._seen.get(name), self._kinds[goal.key], goal.values
        state, made, timeout_s = FAILED, None, values.number('timeout')
        placed = kind.placed(values)
        if robot is None:
            state = LOST
            problem = problem or 'the drive service does not know it: add it to the list of robots'
        problem = problem or self._not_placed(robot, placed)
        if not problem:
            start = Start(name, goal.order, robot.body, robot.trail.places(),
                          robot.trail.ages_s(now), self._places.marks(), drives.get(name, ()),
                          robot.robot_type.accessories)
            try:
                made = self._made(kind, values, start, timeout_s, now)
            except ValueError as error:
                problem = str(error)
            except Exception as error:  # a task may come from a lab's package
                problem = 'its task cannot be started: {!r}'.format(error)[:200]
        run = made or RobotRun(name, None, robot.body if robot else None, timeout_s, now)
        run.placed = placed
        if problem:
            run.end(state, problem, now)
        return run

    def _not_placed(self, robot, placed):
        """Return why a robot that has to be placed is not, '' if it is, or need not be."""
        place = self._places.place(robot.name)
        if robot.known_s() <= PLACED_WITHIN_S or place.is_fresh:
            return ''
        if self._places.fence():
            return 'there is a fence, and ' + place.text
        return place.text if placed else ''

    def _made(self, kind, values, start, timeout_s, now):
        own = self._move_bases.get(start.robot) if kind is GOTO else None
        if own is not None:
            if values.is_given(ACT):
                raise ValueError('its own navigation (move_base) drives it: without act')
            return DelegatedRun(start.robot, target_of(values, start), own, start.body, timeout_s,
                                now)
        return RobotRun(start.robot, kind.make(values, start), start.body, timeout_s, now)
