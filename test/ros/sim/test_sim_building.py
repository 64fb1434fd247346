# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Which simulated robots share a building: those of one master and one plan."""
import socket
from types import SimpleNamespace

import pytest

from mhri.nodes.sim_robot import building_key

HERE = 'http://localhost:11311'


def key(uri, monkeypatch, plan='lab'):
    monkeypatch.setenv('ROS_MASTER_URI', uri)
    return building_key(SimpleNamespace(name=plan))


@pytest.mark.parametrize('uri, plan, same', [
    ('http://127.0.0.1:11311', 'lab', True),
    ('http://localhost:11311/', 'lab', True),
    ('http://{}:11311'.format(socket.gethostname()), 'lab', True),
    ('http://localhost:11312', 'lab', False),
    ('http://localhost:11311', 'hut', False),
    ('http://203.0.113.7:11311', 'lab', False),
])
def test_building(uri, plan, same, monkeypatch):
    assert (key(uri, monkeypatch, plan) == key(HERE, monkeypatch)) == same
