# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Rudder pedals: found among joysticks, read once every axis is known, lost.

The joysticks are made up here; test/e2e/devices/test_pedal.py has SDL's own.
"""
import pytest

from mhri.devices.io.pedal import PedalReader
from mhri.devices.io.pedal_axes import PedalAxes
from mhri.devices.io.reader import DeviceAbsent, DeviceLost, Reading
from mhri.devices.pads import PadInfo
from mhri.devices.pedals import AXES, DRIVE

from support.pedal_desk import PROFILES

SAITEK = PadInfo(0, 'Saitek Pro Flight Rudder Pedals', '03000000a30600006307000011010000')
PAD = PadInfo(1, 'Sony PLAYSTATION(R)3 Controller', '030000004c0500006802000011010000')
REST = Reading((0.0, 0.0), (0, 0, 0, 0))


class Joystick:
    """An open joystick; ``script`` holds the axes that it shows from wait to wait."""

    def __init__(self, script, axis_count=3):
        self.axis_count = axis_count
        self._script = list(script)
        self.is_open = True

    def state(self):
        """Return what is shown now; the end of the script is the end of the device."""
        if not self._script:
            raise DeviceLost('it was unplugged or switched off')
        return self._script[0], ()

    def wait(self, timeout_s):
        """Go on in the script."""
        del self._script[0]

    def close(self):
        """Note it."""
        assert self.is_open
        self.is_open = False


class Joysticks:
    """What is connected; ``opened`` is handed out."""

    def __init__(self, infos, opened=None, problem=None):
        self.infos = infos
        self.opened = opened
        self.asked_for = []
        self.problem = problem

    def look(self):
        """Return what is connected."""
        if self.problem:
            raise DeviceAbsent(self.problem)
        return self.infos

    def open(self, info):
        """Hand the joystick out."""
        self.asked_for.append(info)
        return self.opened


def reader_of(joysticks):
    """Return a reader of these joysticks alone."""
    return PedalReader(lambda: PROFILES, DRIVE, {AXES: PedalAxes(DRIVE, joysticks)})


def test_read_once_every_axis_is_known():
    """Nothing before; then what is pressed, after it has been seen at rest."""
    joystick = Joystick([(None, None, None), (-1.0, None, 0.0), (-1.0, 1.0, 0.0),
                         (-1.0, -1.0, 0.0), (-1.0, 1.0, 0.0)])
    joysticks = Joysticks([PAD, SAITEK], joystick)
    reader = reader_of(joysticks)
    assert 'rudder_pedals' in reader.open() and joysticks.asked_for == [SAITEK]
    assert all(name in reader.note for name in ('left toe', 'right toe', 'bar'))
    assert reader.read(0.0) is None
    assert reader.read(60.0) == REST
    assert reader.read(0.0) is None, 'no change'
    assert 'right toe' in reader.note and 'bar' not in reader.note
    assert reader.read(60.0) == Reading((0.0, 1.0), (1, 1, 0, 0))
    assert reader.note == ''
    with pytest.raises(DeviceLost, match='unplugged'):
        reader.read(60.0)
    reader.close()
    reader.close()
    assert not joystick.is_open
    with pytest.raises(DeviceLost):
        reader.read(0.0)


def test_too_few_axes():
    """Named, closed again, and with a remedy."""
    joystick = Joystick([], axis_count=2)
    with pytest.raises(DeviceAbsent, match='rudder_pedals.*~profile'):
        reader_of(Joysticks([SAITEK], joystick)).open()
    assert not joystick.is_open


def test_pygame_is_missing():
    """Said beside what was looked for; a foot switch works all the same."""
    with pytest.raises(DeviceAbsent, match='no foot pedal.*; pygame cannot be loaded'):
        reader_of(Joysticks([], problem='pygame cannot be loaded')).open()
