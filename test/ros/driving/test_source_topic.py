# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The topic of a source: what counts as another device."""
from types import SimpleNamespace

import pytest

from mhri.devices.profile import Axis, Profile
import mhri.driving.ros.source_topic as module
from mhri.driving.sources import Source


@pytest.mark.parametrize('gone', [True, False])
def test_a_node_that_was_started_anew_is_another_device(monkeypatch, gone):
    """It has the same name; that it had gone may be noticed before or after its first word."""
    monkeypatch.setattr(module, 'link_of', lambda message: message.link)
    monkeypatch.setattr(module, 'caller_of', lambda message: '/mhri_joy')
    topic = module.SourceTopic(
        Source('pad', 'Pad', '/pad', Profile('stick', Axis(1, 1.0), Axis(0, 1.0))))
    found = []
    for _ in range(3):
        message = SimpleNamespace(link=object(), frame_id='pad')
        assert topic.device_of(message) == topic.device_of(message)
        found.append(topic.device_of(message)[0])
        topic.on_heard('/mhri_joy', '/mhri_joy')
        assert not gone or topic.has_gone()
    assert len(set(found)) == 3
