# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The state of all tasks for the screen: robots, results, and tasks that can be continued.

List, feedback and result arrive on separate connections, in any order: a run starts with the first
of them that names it, and ends with its result.
"""
from dataclasses import dataclass, replace
from typing import Dict, List, Optional, Tuple

from mhri.base.config import yaml_text, yaml_value
from mhri.base.task_views import KindView, Progress, RunView, TasksView, TaskView
from mhri.base.task_words import ended_line
from mhri.base.text import tidy_text
from mhri.base.views import Change
from mhri.tasks.base import ENDS, LOST, RESUMES, TEAM, WAITING

# Time limits of the answer to a goal, and of the result of a run that is no longer listed [s].
ANSWER_S, RESULT_S = 5.0, 2.0
_MAX_ENDED = 500


@dataclass(frozen=True)
class Goal:
    """A requested task; ``parameters`` is YAML."""

    key: str
    robots: Tuple[str, ...]
    parameters: str


def with_team(parameters: str, robots: Tuple[str, ...]) -> str:
    """Return parameters (YAML) that keep a robot's place in a team when it starts alone."""
    try:
        values = yaml_value(parameters or '{}')
    except ValueError:
        return parameters
    if len(robots) < 2 or not isinstance(values, dict):
        return parameters
    return yaml_text({TEAM: list(robots), **values})


class TaskBook:
    """Collects the reports about tasks; times are monotonic seconds."""

    def __init__(self) -> None:
        self._kinds: Tuple[KindView, ...] = ()
        self._runs: Dict[str, RunView] = {}
        self._asked: Dict[str, Tuple[Goal, float]] = {}
        # Times since which runs are no longer listed.
        self._leaving: Dict[str, float] = {}
        self._ended: Dict[str, None] = {}
        self._left: Dict[str, Goal] = {}
        # The robots of a run that the operator ended, () for all of them.
        self._cancelled: Dict[str, Tuple[str, ...]] = {}
        self._marks: Tuple[str, ...] = ()
        self._news: List[Change] = []

    def view(self, problem: str = '') -> TasksView:
        """Return the view for the screen."""
        return TasksView(problem, self._kinds, tuple(self._runs.values()), self._marks)

    def take_news(self) -> List[Change]:
        """Return the news since the last call, the oldest first.

        ``data`` of a begin or an end are ``task``, its key, and ``carry_on``, the key of the task
        that the robot can continue from then on, '' without one.
        """
        news, self._news = self._news, []
        return news

    def ask(self, goal_id: str, goal: Goal, now_s: float) -> None:
        """Record a goal sent from here."""
        self._asked[goal_id] = goal, now_s

    def cancel(self, goal_id: str, robots: Tuple[str, ...] = ()) -> None:
        """Record that the operator ended a run, or the part of these robots, for good."""
        before = self._cancelled.get(goal_id)
        self._cancelled[goal_id] = () if before == () or not robots else (before or ()) + robots

    def keep_on(self, robots: Tuple[str, ...], why: str) -> None:
        """Record that the tasks of robots could not be ended."""
        self._news += [Change(robot, 'task.refused', 'its task could not be ended: ' + why)
                       for robot in robots]

    def _is_cancelled(self, goal_id: str, robot: str) -> bool:
        robots = self._cancelled.get(goal_id)
        return robots is not None and (not robots or robot in robots)

    def on_list(self, kinds: Tuple[KindView, ...], runs: Tuple[RunView, ...],
                now_s: float, marks: Tuple[str, ...] = ()) -> None:
        """Handle the list of tasks, runs and marks."""
        self._kinds, self._marks = kinds, marks
        for run in runs:
            self._leaving.pop(run.id, None)
            if run.id not in self._ended:
                self._update(run)
        listed = {run.id for run in runs}
        for run_id in self._runs:
            if run_id not in listed:
                self._leaving.setdefault(run_id, now_s)

    def on_feedback(self, run_id: str, robots: Tuple[Progress, ...]) -> None:
        """Handle the progress of a run, which has to be listed first."""
        if run_id in self._runs:
            self._update(replace(self._runs[run_id], robots=robots))

    def _update(self, run: RunView) -> None:
        """Update a run, and report the changes."""
        before = self._runs.get(run.id)
        self._asked.pop(run.id, None)
        self._runs[run.id] = run
        old = {robot.robot: robot for robot in before.robots} if before else {}
        for robot in run.robots:
            self._report(run, robot, old.get(robot.robot))

    def _report(self, run: RunView, robot: Progress, old: Optional[Progress]) -> None:
        """Report the start, lines and end of one robot's part."""
        label = self.view().label(run.key)
        if old is None and robot.state not in ENDS:
            self._left.pop(robot.robot, None)
            self._report_state(run, robot.robot, 'begun', label.lower() + ' started')
        said = robot.said[len(old.said) if old else 0:]
        self._news += [
            Change(robot.robot, 'task.said', '{}: {}'.format(label.lower(), tidy_text(line)))
            for line in said if line != robot.text or robot.state not in ENDS]
        if robot.state in ENDS and (old is None or old.state not in ENDS):
            # Not after a cancel, nor if the robot is already on another task: messages arrive in
            # any order.
            if robot.state in RESUMES and not self._is_cancelled(
                    run.id, robot.robot) and self.of(robot.robot) is None:
                self._left[robot.robot] = Goal(run.key, (robot.robot,), with_team(
                    run.parameters, tuple(one.robot for one in run.robots)))
            self._report_state(run, robot.robot, robot.state,
                               ended_line(label, robot.state, robot.text))

    def _report_state(self, run: RunView, robot: str, state: str, text: str) -> None:
        """Report that a robot starts or ends its part of a run."""
        left = self._left.get(robot)
        self._news.append(Change(robot, 'task.' + state, text, data={
            'task': run.key, 'carry_on': left.key if left else ''}))

    def on_result(self, run_id: str, text: str, robots: Tuple[Progress, ...],
                  cancelled: bool = False) -> None:
        """Handle the result of a goal; without robots it was refused for the reason ``text``."""
        if run_id in self._ended:
            return
        if cancelled:
            self.cancel(run_id)
        asked = self._asked.get(run_id)
        run = self._runs.get(run_id)
        if robots and run is not None:
            self._update(replace(run, robots=robots))
        elif robots and asked is not None:
            # It ended before it was listed.
            self._update(RunView(run_id, asked[0].key, asked[0].parameters, robots))
        elif asked is not None:
            self._refuse(asked[0], text or 'it was refused')
        self._end(run_id)

    def _refuse(self, goal: Goal, why: str) -> None:
        robot = goal.robots[0] if len(goal.robots) == 1 else ''
        self._news.append(Change(robot, 'task.refused', '{} not started: {}'.format(
            self.view().label(goal.key).lower(), why)))

    def _end(self, run_id: str) -> None:
        """Forget a run completely."""
        for kept in (self._runs, self._asked, self._leaving, self._cancelled):
            kept.pop(run_id, None)
        self._ended[run_id] = None
        while len(self._ended) > _MAX_ENDED:
            del self._ended[next(iter(self._ended))]

    def lose(self, why: str) -> None:
        """Handle the end of the task service: every run is over."""
        for run in tuple(self._runs.values()):
            self._lose(run, why)
            # It may be listed again: perhaps only the connection broke.
            self._ended.pop(run.id, None)

    def _lose(self, run: RunView, why: str) -> None:
        self._update(replace(run, robots=tuple(
            robot if robot.state in ENDS else replace(robot, state=LOST, text=why)
            for robot in run.robots)))
        self._end(run.id)

    def tick(self, now_s: float) -> None:
        """Report requests without an answer."""
        for goal_id, (goal, asked_s) in tuple(self._asked.items()):
            if now_s - asked_s > ANSWER_S:
                self._refuse(goal, 'the task service has not answered')
                # If it starts later, it is shown like any other.
                del self._asked[goal_id]
        for run_id, since_s in tuple(self._leaving.items()):
            if now_s - since_s > RESULT_S:
                self._lose(self._runs[run_id], 'its result is unknown')

    def of(self, robot: str) -> Optional[TaskView]:
        """Return the task of a robot, or None."""
        for run in self._runs.values():
            for one in run.robots:
                if one.robot == robot and one.state not in ENDS:
                    return TaskView(self.view().label(run.key), one.text, one.state == WAITING,
                                    one.left_m)
        return None

    def parts_of(self, robots: Tuple[str, ...]) -> List[Tuple[str, Tuple[str, ...]]]:
        """Return (id, these robots) of the goals that any of these robots is on.

        The robots are () if no other robot is on the goal.
        """
        parts = []
        for run in self._runs.values():
            busy = [one.robot for one in run.robots if one.state not in ENDS]
            meant = tuple(robot for robot in busy if robot in robots)
            if meant:
                parts.append((run.id, () if len(meant) == len(busy) else meant))
        return parts

    def left(self, robot: str) -> Optional[Goal]:
        """Return the task that a robot could continue; None without one, or while requested."""
        asked = any(robot in goal.robots for goal, _ in self._asked.values())
        return None if asked else self._left.get(robot)
