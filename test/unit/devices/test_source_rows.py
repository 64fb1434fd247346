# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The parameter with the mux's sources, of the right and of any wrong shape."""
import pytest

from mhri.base.views import DeviceView
from mhri.devices.source_rows import labelled_by_device, MAX_SOURCES, source_rows, suspend_services

JOY = {'name': 'joy', 'label': 'Virtual joystick', 'topic': '/mux_in/joy'}


@pytest.mark.parametrize('parameter, pairs', [
    ([JOY], (('joy', 'Virtual joystick'),)), ([], ()), (None, ()), (5, ()), ('joy', ()),
    ({'name': 'joy', 'label': 'x'}, ()), ([JOY, 5, 'x', None, []], (('joy', 'Virtual joystick'),)),
    ([{'name': 'joy'}, {'label': 'x'}, {'name': 5, 'label': 'x'}, {'name': 'a', 'label': [1]},
      {'name': '', 'label': 'x'}, JOY], (('joy', 'Virtual joystick'),)),
    ([{'name': 'a', 'label': 'two\nlines'}], (('a', 'two lines'),))])
def test_rows(parameter, pairs):
    assert source_rows(parameter) == pairs


def test_bounds():
    found = source_rows([{'name': 'a' * 1000, 'label': 'b' * 1_000_000}] * 1000)
    assert len(found) == MAX_SOURCES and all(len(text) == 200 for text in found[0])


@pytest.mark.parametrize('service, found', [
    ('/mhri_joy/set_suspended', {'pad': '/mhri_joy/set_suspended'}), ('', {}), (None, {}), (5, {}),
    ('no name/x', {}), (['/a'], {})])
def test_services(service, found):
    assert suspend_services([JOY, {'name': 'pad', 'label': 'x', 'suspend_service': service}]) \
        == found


@pytest.mark.parametrize('device, label', [
    (DeviceView('pad', 'Logitech Gamepad F710'), 'Logitech Gamepad F710'),
    (DeviceView('pad', 'Logitech Gamepad F710', 'move the stick once'), 'Logitech Gamepad F710'),
    (DeviceView('pad', '', 'none is connected; plug one in'), 'PS3 pad (not connected)'),
    (DeviceView('pad'), 'PS3 pad'), (DeviceView('pedal', 'VEC'), 'PS3 pad')])
def test_a_source_is_called_by_the_device_that_is_there(device, label):
    rows = (('joy', 'Virtual joystick'), ('pad', 'PS3 pad'))
    assert labelled_by_device(rows, [device]) == (rows[0], ('pad', label))
