# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Rows of input devices: those that are shipped, one of a lab, and wrong ones."""
from pathlib import Path

import pytest
import yaml

from mhri.base.config import ConfigError
from mhri.devices.io.pad import PadReader
from mhri.devices.ros.device import Device, find_device
from mhri.graph.ros.resources import resource_path

ORIGIN = resource_path('inputs.yaml')
SHIPPED = Path(ORIGIN).read_text()


@pytest.mark.parametrize('key', list(yaml.safe_load(SHIPPED)))
def test_the_topic_of_a_shipped_row_is_one_that_drives(key):
    topic, make = find_device(key, SHIPPED, ORIGIN)
    sources = yaml.safe_load(Path(resource_path('mux.yaml')).read_text())['sources']
    assert topic in [source['topic'] for source in sources]
    assert callable(make)


def test_a_subclass_of_reader_is_a_device():
    row = 'mouse: {topic: /mux_in/mouse, device: mhri.devices.io.pad.PadReader}'
    assert find_device('mouse', row, 'x') == ('/mux_in/mouse', PadReader)
    assert Device(PadReader(list)).parameters == {}


@pytest.mark.parametrize('row, key', [
    ('', 'mouse'), ('{topic: /a}', 'mouse.device'),
    ('{device: mhri.devices.io.pad.PadReader}', 'mouse.topic'),
    ('{topic: /a, device: mhri.nowhere.Mouse}', 'mouse.device'),
    ('{topic: /a, device: mhri.devices.io.pad.Mouse}', 'mouse.device'),
    ('{topic: /a, device: Mouse}', 'mouse.device'),
    ('{topic: /a, device: mhri.devices.io.pad.PadReader, kind: mouse}', 'mouse.kind')])
def test_what_is_wrong_is_named(row, key):
    with pytest.raises(ConfigError) as error:
        find_device('mouse', 'mouse: ' + row if row else 'pad: {topic: /a}', '/a/inputs.yaml')
    assert error.value.key == key
