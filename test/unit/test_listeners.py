# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Which topic a robot's commands go to, whoever else listens."""
import pytest

from mhri.robots.listeners import first_obeying


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
