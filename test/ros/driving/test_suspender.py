# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Input nodes that are looked for while they are not there."""
import logging

import pytest

from mhri.driving.ros import suspender as module
from mhri.driving.ros.suspender import Suspender
from support.ros_system import wait_for

PAD, VOICE = '/pad/set_suspended', '/voice/set_suspended'


class Master:
    """Takes the place of the master: knows the services that are ``there``, counts the asking."""

    there, asked = set(), []

    def __init__(self, *_, **__):
        pass

    def call_many(self, calls):
        (method, service), = calls
        assert method == 'lookupService'
        self.asked.append(service)
        return [service if service in self.there else None]


@pytest.fixture
def called(monkeypatch):
    """Return a list of (service, suspended) of every call."""
    made = []

    def proxy(service, _):
        def call(suspended):
            made.append((service, suspended))
            return module.SetSuspended._response_class(True, '')
        return call
    monkeypatch.setattr(module, 'MasterApi', Master)
    monkeypatch.setattr(module.rospy, 'ServiceProxy', proxy)
    monkeypatch.setattr(module, 'RETRY_S', 0.01)
    monkeypatch.setattr(Master, 'there', set())
    monkeypatch.setattr(Master, 'asked', [])
    return made


def test_a_node_that_is_not_there_is_looked_for_and_fills_no_log(called, caplog):
    """Nor is it called: rospy would log an error each time."""
    suspender = Suspender([PAD, VOICE])
    with caplog.at_level(logging.INFO):
        suspender.activate(PAD)
        wait_for(lambda: Master.asked.count(PAD) >= 20, what='it to be looked for')
    assert called == []
    assert [word for word in caplog.messages if PAD in word] == []
    Master.there = {PAD}
    wait_for(lambda: (PAD, False) in called, what='it to be resumed once it is there')
    assert Master.asked.count(VOICE) <= 1, 'it begins suspended'
