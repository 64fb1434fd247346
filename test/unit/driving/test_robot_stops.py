# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Requests to stop single robots: every press is sent, and again until the drive answers."""
import pytest

from mhri.driving.robot_stops import RobotStops

BOTH = ('bot1', 'bot2')
EVENTS = {
    'press': lambda stops: stops.ask(['bot1']), 'press both': lambda stops: stops.ask(BOTH),
    'call': lambda stops: stops.take(), 'no answer': lambda stops: stops.failed(BOTH),
    'answer': lambda stops: stops.answered(BOTH), 'state': lambda stops: stops.on_state()}


@pytest.mark.parametrize('events, to_send, shown', [
    (['press'], ('bot1',), True),
    (['press', 'press'], ('bot1',), True),
    (['press both'], BOTH, True),
    (['press', 'call'], (), True),
    (['press', 'call', 'no answer'], ('bot1',), True),
    (['press', 'call', 'answer'], (), True),
    (['press', 'call', 'state', 'no answer'], ('bot1',), True),
    (['press', 'call', 'answer', 'state'], (), False),
    # The answer is to the call before the second press, which may be a new stop.
    (['press', 'call', 'press', 'answer', 'state'], ('bot1',), True),
    (['press', 'call', 'answer', 'state', 'press'], ('bot1',), True),
    (['press', 'call', 'press', 'no answer'], ('bot1',), True),
    (['call', 'no answer', 'answer', 'state'], (), False),
], ids=str)
def test_what_is_sent_and_shown(events, to_send, shown):
    stops = RobotStops()
    for event in events:
        EVENTS[event](stops)
    assert ('bot1' in stops) == shown
    assert stops.take() == to_send
