# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What rospy logs for every message is logged once a second, and nothing else is left out."""
import logging

import pytest

from mhri.graph.ros.log_throttle import OncePerSecond
from support.clock import Clock

READ = 'cannot deserialize message: EXCEPTION Traceback\n  File x\nstruct.error: {}'
READ_ONCE = 'Traceback\n' + '  File x\n' * 99 + 'genpy.DeserializationError: cannot deserialize: {}'
TORN = '[/bot1/odom] error deserializing incoming request: unpack requires {} bytes'
CALLBACK = 'bad callback: <bound method X.hear>\nTraceback ...{}'


@pytest.mark.parametrize('texts, passed', [
    ([TORN.format(number) for number in range(100)], 1),
    ([READ.format(number) for number in range(100)], 1),
    ([READ_ONCE.format(number) for number in range(100)], 1),
    ([CALLBACK.format(number) for number in range(100)], 1),
    ([TORN.replace('bot1', 'bot{}'.format(number)) for number in range(5)] * 3, 5),
    ([CALLBACK.replace('X', 'X{}'.format(number)) for number in range(5)] * 3, 5),
    (['the robot stands'] * 100, 100),
    (['a name: ' + 'x' * 1000 + ' bad callback' + 'x' * 1000] * 3, 3)])
def test_within_a_second(texts, passed):
    clock = Clock()
    quiet = OncePerSecond(clock)
    records = [logging.LogRecord('rosout', 40, 'f', 1, '%s', (text,), None) for text in texts]
    assert sum(quiet.filter(record) for record in records) == passed
    clock.now += 1.0
    assert quiet.filter(records[0]), 'a second later it is said again'
