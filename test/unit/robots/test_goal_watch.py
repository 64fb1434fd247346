# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A goal that nobody supervises any more is cancelled."""
from mhri.robots.goal_watch import GoalWatch, OVERLAP_S, SILENT_S


def test_a_goal_is_overdue_once_its_sender_is_silent():
    watch = GoalWatch()
    watch.on_goal('/tasks', 'goal', 0.0)
    watch.on_command('/tasks', False, 1.0)
    watch.on_command('/other', False, 2.0)
    assert watch.overdue(1.0 + SILENT_S - 0.01) == []
    assert watch.overdue(1.0 + SILENT_S) == ['goal']
    assert watch.overdue(100.0) == [], 'once'


def test_one_whose_sender_never_spoke_is_overdue_too():
    watch = GoalWatch()
    watch.on_goal('/tasks', 'goal', 0.0)
    assert watch.overdue(SILENT_S) == ['goal']


def test_the_end_of_the_task_before_does_not_end_a_new_goal():
    watch = GoalWatch()
    watch.on_goal('/tasks', 'goal', 0.0)
    watch.on_command('/tasks', True, OVERLAP_S - 0.01)
    assert watch.overdue(SILENT_S) == [], 'it was heard since'
    assert watch.overdue(OVERLAP_S + SILENT_S) == ['goal']


def test_a_goal_that_has_ended_is_not_overdue():
    watch = GoalWatch()
    for sender in ('/tasks', '/more'):
        watch.on_goal(sender, sender, 0.0)
    watch.on_command('/tasks', True, 1.0)
    assert watch.on_gone('/tasks') is None and watch.on_gone('/more') == '/more'
    assert watch.overdue(100.0) == []
