# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Which topic a robot's commands go to, whoever else listens; who else commands it."""
import pytest

from mhri.robots.listeners import first_obeying, obeying, other_commanders


@pytest.mark.parametrize('listeners, chosen', [
    ([], None),
    ([set(), set()], None),
    ([{'/bot1/base'}, {'/bot1/mux'}], 0),
    ([set(), {'/bot1/mux'}], 1),
    ([{'/rostopic_12_99'}, {'/bot1/mux'}], 1),
    ([{'/record_17'}, {'/driver'}], 1),
    ([{'/record_17', '/rostopic_1'}, set()], None),
    ([{'/logger'}, {'/bot1/mux'}], 1),
    ([{'/logger'}, {'/driver'}], 0),
    ([{'/bot10/base'}, {'/bot1/base'}], 1),
    ([{'/rqt_gui_py_node_1', '/mhri_panel', '/driver'}], 0),
], ids=str)
def test_the_first_topic_that_the_robot_listens_to(listeners, chosen):
    assert first_obeying('bot1', listeners) == chosen


def test_a_multiplexer_outside_of_the_robot_counts_before_its_base():
    listeners = [{'/twist_mux', '/rostopic_1'}, {'/bot1/base', '/logger'}]
    assert obeying('bot1', listeners) == [frozenset(), {'/bot1/base'}]
    assert obeying('bot1', listeners, [False, True]) == [{'/twist_mux'}, {'/bot1/base'}]


IN, OUT, NAVI = '/bot1/teleop/input', '/bot1/mux/teleop', '/bot1/mux/navi'


@pytest.mark.parametrize('found, others', [
    (set(), set()),
    # Its smoother passes on what it reads.
    ({('/bot1/smoother', OUT)}, set()),
    ({('/bot1/smoother', OUT), ('/nav', OUT)}, {('/nav', OUT)}),
    ({('/bot1/smoother', IN)}, {('/bot1/smoother', IN)}),
    # What reads the same topic, or another than ours, passes nothing on.
    ({('/bot1/base', OUT)}, {('/bot1/base', OUT)}),
    ({('/bot1/smoother', NAVI)}, {('/bot1/smoother', NAVI)}),
    ({('/mux', IN), ('/bot1/mhri_guard', OUT)}, set()),
], ids=str)
def test_who_else_commands_a_robot(found, others):
    listeners = {IN: {'/bot1/smoother'}, OUT: {'/bot1/base'}}
    assert other_commanders(found, listeners, {'/mux', '/bot1/mhri_guard'}) == others
