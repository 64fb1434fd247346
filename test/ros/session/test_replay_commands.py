# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Which recorded topics a replay leaves out since they commanded accessories."""
import pytest

pytest.importorskip('rospy')

from mhri.graph.ros.resources import robot_types  # noqa: E402
from mhri.nodes.mhri_replay import commands_of  # noqa: E402

ROWS = {'flipper': {'kind': 'hold', 'topic': 'flip', 'type': 'std_msgs/Float64',
                    'state': 'flip_state', 'on_stop': 'stop'},
        'gas': {'kind': 'readout', 'topic': 'gas', 'type': 'std_msgs/Float32'}}


@pytest.mark.parametrize('entry, commands', [
    ({'type': 'generic', 'parameters': {'mhri': {'accessories': ROWS}}}, {'/bot1/flip'}),
    ({'type': 'generic', 'parameters': {}}, set()),
    ({'type': 'generic', 'parameters': 'damaged'}, set()),
    ({'type': 7, 'parameters': {'mhri': {'accessories': 'none'}}}, set()),
    ({}, set())])
def test_by_the_recorded_parameters(entry, commands):
    types, _ = robot_types()
    assert commands_of({'bot1': entry}, types) == commands
