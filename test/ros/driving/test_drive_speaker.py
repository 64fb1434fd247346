# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""How often the drive says its state. The one period is so long that only the other one counts."""
import threading

import pytest
import rospy

from mhri.driving.ros import drive_speaker
from mhri.msg import DriveState
from support.ros_system import wait_for

FOR_EVER_S = 3600.0


class Said:
    """Takes the place of the topic until the node ends; notes when each state was sent."""

    def __init__(self, *_, **options):
        self.latched, self.stamps, self.ended = options['latch'], [], threading.Event()

    def publish(self, message):
        if self.ended.is_set():
            raise rospy.ROSException('the node has ended')
        self.stamps.append(message.header.stamp)


@pytest.fixture
def speaks(monkeypatch):
    """Return a function from what moves to (speaker, what it says); they end with the test."""
    topics, speakers = [], []

    def advertise(*words, **options):
        topics.append(Said(*words, **options))
        return topics[-1]
    monkeypatch.setattr(drive_speaker.rospy, 'Publisher', advertise)

    def speak(moving):
        speakers.append(drive_speaker.DriveSpeaker(DriveState, lambda: moving))
        speakers[-1].start()
        return speakers[-1], topics[-1]
    yield speak
    for topic, speaker in zip(topics, speakers):
        topic.ended.set()
        speaker.on_change()


def test_at_2_hz_at_rest_and_at_10_hz_while_anything_moves():
    assert (drive_speaker.PERIOD_S, drive_speaker.MOVING_S) == (0.5, 0.1)


@pytest.mark.parametrize('moving, other', [(set(), 'MOVING_S'), ({'bot1'}, 'PERIOD_S')])
def test_it_is_said_again_and_again_and_stamped(monkeypatch, speaks, moving, other):
    monkeypatch.setattr(drive_speaker, other, FOR_EVER_S)
    _, said = speaks(moving)
    wait_for(lambda: len(said.stamps) >= 4, what='four states')
    assert said.latched and all(stamp.to_sec() > 0.0 for stamp in said.stamps[:4])


def test_a_change_is_said_at_once(monkeypatch, speaks):
    monkeypatch.setattr(drive_speaker, 'PERIOD_S', FOR_EVER_S)
    speaker, said = speaks(set())
    for count in (1, 2, 3):
        speaker.on_change()
        wait_for(lambda count=count: len(said.stamps) >= count, what='the change')
