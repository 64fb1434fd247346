# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A mux never has the address of the one before it: robots would not connect to it."""
import rospy

from mhri.driving.ros.mux_takeover import has_address_of_last
from mhri.graph.ros.stand_by import Memory


def test_an_address_is_refused_once_to_the_next_process(monkeypatch):
    memory, found = Memory(), []
    for port in (40001, 40003, 40003, 40005, 40003):
        monkeypatch.setattr(rospy, 'get_node_uri', 'http://127.0.0.1:{}/'.format(port).__str__)
        found.append(has_address_of_last(memory))
    assert found == [False, False, True, False, False]
