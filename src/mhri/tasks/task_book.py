# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What the screen knows of all tasks: who is on which, how each ended, and what can be continued.

List, feedback and result come over connections of their own, in any order: a run counts from the
first that names it, and is over with its result.
"""
from dataclasses import dataclass, replace
from typing import Dict, List, NamedTuple, Optional, Tuple

import yaml

from mhri.base.task_views import KindView, Progress, RunView, TasksView, TaskView
from mhri.base.task_words import ended_line, STARTED
from mhri.base.text import tidy_text
from mhri.tasks.base import ENDS, LOST, RESUMES, TEAM, WAITING

# A goal without an answer, and a run that is listed no more without a result [s].
ANSWER_S, RESULT_S = 5.0, 2.0
_MOST_ENDED = 500


class News(NamedTuple):
    """What is worth an event: a kind of :data:`mhri.events.events.KINDS`, robot, sentence."""

    kind: str
    robot: str
    text: str


@dataclass(frozen=True)
class Goal:
    """What was, or is to be, asked for; ``parameters`` is YAML."""

    key: str
    robots: Tuple[str, ...]
    parameters: str


def with_team(parameters: str, robots: Tuple[str, ...]) -> str:
    """Return parameters (YAML) by which a robot keeps its place among others, started alone."""
    try:
        values = yaml.safe_load(parameters or '{}')
    except yaml.YAMLError:
        return parameters
    if len(robots) < 2 or not isinstance(values, dict):
        return parameters
    return str(yaml.safe_dump({TEAM: list(robots), **values}, default_flow_style=True))


class TaskBook:
    """Takes in what is heard of the tasks; times are monotonic seconds."""

    def __init__(self) -> None:
        self._kinds: Tuple[KindView, ...] = ()
        self._runs: Dict[str, RunView] = {}
        self._asked: Dict[str, Tuple[Goal, float]] = {}
        # Since when a run is listed no more.
        self._leaving: Dict[str, float] = {}
        self._ended: Dict[str, None] = {}
        self._left: Dict[str, Goal] = {}
        # Whom of a run the operator ended, () for all of it.
        self._cancelled: Dict[str, Tuple[str, ...]] = {}
        self._marks: Tuple[str, ...] = ()
        self._news: List[News] = []

    def view(self, problem: str = '') -> TasksView:
        """Return what there is to show."""
        return TasksView(problem, self._kinds, tuple(self._runs.values()), self._marks)

    def take_news(self) -> List[News]:
        """Return what is new since the last call, the oldest first."""
        news, self._news = self._news, []
        return news

    def ask(self, goal_id: str, goal: Goal, now_s: float) -> None:
        """Take note of a goal that was sent from here."""
        self._asked[goal_id] = goal, now_s

    def cancel(self, goal_id: str, robots: Tuple[str, ...] = ()) -> None:
        """Take note that the operator ended a run, or these robots' part: nobody continues it."""
        before = self._cancelled.get(goal_id)
        self._cancelled[goal_id] = () if before == () or not robots else (before or ()) + robots

    def keep_on(self, robots: Tuple[str, ...], why: str) -> None:
        """Take in that the tasks of robots could not be ended."""
        self._news += [News('task.refused', robot, 'its task is not ended: ' + why)
                       for robot in robots]

    def _is_cancelled(self, goal_id: str, robot: str) -> bool:
        robots = self._cancelled.get(goal_id)
        return robots is not None and (not robots or robot in robots)

    def hear_list(self, kinds: Tuple[KindView, ...], runs: Tuple[RunView, ...],
                  now_s: float, marks: Tuple[str, ...] = ()) -> None:
        """Take in what can be started, what is under way, and the names of the marks."""
        self._kinds, self._marks = kinds, marks
        for run in runs:
            self._leaving.pop(run.id, None)
            if run.id not in self._ended:
                self._hear(run)
        listed = {run.id for run in runs}
        for run_id in self._runs:
            if run_id not in listed:
                self._leaving.setdefault(run_id, now_s)

    def hear_feedback(self, run_id: str, robots: Tuple[Progress, ...]) -> None:
        """Take in how the robots of a run are getting on; the list has to tell of it first."""
        if run_id in self._runs:
            self._hear(replace(self._runs[run_id], robots=robots))

    def _hear(self, run: RunView) -> None:
        """Take in the newest of a run, and report what has changed."""
        before = self._runs.get(run.id)
        self._asked.pop(run.id, None)
        self._runs[run.id] = run
        old = {robot.robot: robot for robot in before.robots} if before else {}
        for robot in run.robots:
            self._tell(run, robot, old.get(robot.robot))

    def _tell(self, run: RunView, robot: Progress, old: Optional[Progress]) -> None:
        """Report what one robot has begun, said and ended."""
        label = self.view().label(run.key)
        if old is None and robot.state not in ENDS:
            self._left.pop(robot.robot, None)
            self._news.append(News('task.begun', robot.robot, label.lower() + STARTED))
        said = robot.said[len(old.said) if old else 0:]
        self._news += [
            News('task.said', robot.robot, '{}: {}'.format(label.lower(), tidy_text(line)))
            for line in said if line != robot.text or robot.state not in ENDS]
        if robot.state in ENDS and (old is None or old.state not in ENDS):
            self._news.append(News('task.' + robot.state, robot.robot,
                                   ended_line(label, robot.state, robot.text)))
            # Whoever cancelled it meant it. Who got another task is on that, whichever is heard of
            # first.
            if robot.state in RESUMES and not self._is_cancelled(
                    run.id, robot.robot) and self.of(robot.robot) is None:
                self._left[robot.robot] = Goal(run.key, (robot.robot,), with_team(
                    run.parameters, tuple(one.robot for one in run.robots)))

    def hear_result(self, run_id: str, text: str, robots: Tuple[Progress, ...],
                    cancelled: bool = False) -> None:
        """Take in how a goal ended; without robots it was refused, and ``text`` says why."""
        if run_id in self._ended:
            return
        if cancelled:
            self.cancel(run_id)
        asked = self._asked.get(run_id)
        run = self._runs.get(run_id)
        if robots and run is not None:
            self._hear(replace(run, robots=robots))
        elif robots and asked is not None:
            # It ended before the list told of it.
            self._hear(RunView(run_id, asked[0].key, asked[0].parameters, robots))
        elif asked is not None:
            self._refuse(asked[0], text or 'it was refused')
        self._end(run_id)

    def _refuse(self, goal: Goal, why: str) -> None:
        robot = goal.robots[0] if len(goal.robots) == 1 else ''
        self._news.append(News('task.refused', robot, '{} not started: {}'.format(
            self.view().label(goal.key).lower(), why)))

    def _end(self, run_id: str) -> None:
        """Forget a run, and that it was."""
        for kept in (self._runs, self._asked, self._leaving, self._cancelled):
            kept.pop(run_id, None)
        self._ended[run_id] = None
        while len(self._ended) > _MOST_ENDED:
            del self._ended[next(iter(self._ended))]

    def lose(self, why: str) -> None:
        """Take in that whoever runs the tasks has gone: every run is over."""
        for run in tuple(self._runs.values()):
            self._lose(run, why)
            # Not as ended: it may have been the connection alone.
            self._ended.pop(run.id, None)

    def _lose(self, run: RunView, why: str) -> None:
        self._hear(replace(run, robots=tuple(
            robot if robot.state in ENDS else replace(robot, state=LOST, text=why)
            for robot in run.robots)))
        self._end(run.id)

    def tick(self, now_s: float) -> None:
        """Let time pass: what is not answered is said."""
        for goal_id, (goal, asked_s) in tuple(self._asked.items()):
            if now_s - asked_s > ANSWER_S:
                self._refuse(goal, 'the task service has not answered')
                # Should it begin after all, it is shown as any other.
                del self._asked[goal_id]
        for run_id, since_s in tuple(self._leaving.items()):
            if now_s - since_s > RESULT_S:
                self._lose(self._runs[run_id], 'nobody said how it ended')

    def of(self, robot: str) -> Optional[TaskView]:
        """Return the task that a robot is on, None for none."""
        for run in self._runs.values():
            for one in run.robots:
                if one.robot == robot and one.state not in ENDS:
                    return TaskView(self.view().label(run.key), one.text, one.state == WAITING,
                                    one.left_m)
        return None

    def parts_of(self, robots: Tuple[str, ...]) -> List[Tuple[str, Tuple[str, ...]]]:
        """Return of the goals that any of these robots is busy with (id, which of them are it).

        None of them is named where nobody else is busy with the goal.
        """
        parts = []
        for run in self._runs.values():
            busy = [one.robot for one in run.robots if one.state not in ENDS]
            meant = tuple(robot for robot in busy if robot in robots)
            if meant:
                parts.append((run.id, () if len(meant) == len(busy) else meant))
        return parts

    def left(self, robot: str) -> Optional[Goal]:
        """Return what a robot could continue, None for nothing, and while it is asked for."""
        asked = any(robot in goal.robots for goal, _ in self._asked.values())
        return None if asked else self._left.get(robot)
