# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What the rows of the shipped robot types put into real messages, and read from them."""
import sys

import pytest
from std_msgs.msg import Bool, Float64MultiArray, Int32MultiArray, UInt8MultiArray

from mhri.driving.ros.accessory_line import filled, packed
from mhri.graph.ros.messages import MessageMissing, message_class, read_field
from mhri.graph.ros.resources import robot_types
from support.paths import MESSAGES


@pytest.mark.parametrize('kind, pairs, wanted', [
    (Float64MultiArray, {'data': (0.01, 2)}, [0.01, 2]),
    (UInt8MultiArray, {'data': (3, 7)}, b'\x03\x07'),
    (Float64MultiArray, {'data[2]': 0.5}, [0, 0, 0.5]), (Int32MultiArray, {'data[0]': 2.0}, [2]),
    (Float64MultiArray, {'data[1]': 1.0, 'data[0]': 2.0}, [2.0, 1.0]),
    (UInt8MultiArray, {'data[1]': 7}, [0, 7])])
def test_an_array_and_its_elements(kind, pairs, wanted):
    message = filled(kind(), pairs.items())
    assert message.data == wanted
    assert len(packed(message)) > len(packed(kind()))


@pytest.mark.parametrize('kind, pairs', [
    (Bool, {'data': (1, 2)}), (Bool, {'data[0]': 1}), (Float64MultiArray, {'data': 0.5}),
    (Float64MultiArray, {'layout[0]': 0.5}), (UInt8MultiArray, {'data': 'on'}),
    (Bool, {'lamp': 1})])
def test_what_does_not_fit_is_refused(kind, pairs):
    with pytest.raises(MessageMissing):
        packed(filled(kind(), pairs.items()))


def test_an_element_that_is_not_there_is_no_field():
    message = Float64MultiArray(data=[0.5])
    assert read_field(message, 'data[0]') == 0.5
    for field in ('data[1]', 'layout[0]', 'nose[0]'):
        with pytest.raises(AttributeError):
            read_field(message, field)


def test_the_shipped_rows_fit_their_messages(monkeypatch):
    """The real kobuki_msgs; turtlebot3_msgs has the same kinds of fields."""
    monkeypatch.setattr(sys, 'path', sys.path + [MESSAGES])
    rows = {row.key: row for row in robot_types()[0]['turtlebot2'].accessories}
    sent = {(key, choice): packed(filled(message_class(row.type)(), pairs))[-1]
            for key, row in rows.items() for choice, pairs in row.choices}
    assert sent[('led2', 'off')] == 0 and sent[('led1', 'red')] == 3 and sent[('sound', 'end')] == 6
    core = message_class('kobuki_msgs/SensorState')(bumper=6, cliff=1, wheel_drop=0)
    assert [(rows[key].reading(read_field(core, *rows[key].fields)),
             rows[key].warns(read_field(core, *rows[key].fields)))
            for key in ('bumper', 'cliff', 'wheel_drop')] == [
        ('centre, left', True), ('right', True), ('–', False)]
