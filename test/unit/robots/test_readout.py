# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The value of a sensor of any kind: what holds one, and for how long a short one is shown."""
import math

import pytest

from mhri.base.accessories import Accessory, READOUT
from mhri.robots.readout import is_number, PEAK_S, Readout

BUMPER = Accessory(name='bumper', key='bumper', kind=READOUT, warn_above=0.5)


@pytest.mark.parametrize('found, good', [(3, True), (math.nan, True), (True, True), ('3', False),
                                         (b'3', False), ((3,), False), (None, False)])
def test_which_fields_hold_a_number(found, good):
    assert is_number(found) is good


def test_what_is_beyond_for_less_than_a_redraw_is_shown():
    bumper = Readout(BUMPER)
    assert bumper.value(0.0) == ()
    for value, at_s in ((0.0, 1.0), (1.0, 2.0), (0.0, 2.01)):
        bumper.on_value(value, at_s)
    assert bumper.value(2.02) == (1.0,) and bumper.value(2.0 + PEAK_S) == (0.0,)


def test_the_newest_counts():
    bumper = Readout(BUMPER)
    for value, at_s in ((1.0, 2.0), (3.0, 2.01)):
        bumper.on_value(value, at_s)
    assert bumper.value(2.02) == bumper.value(99.0) == (3.0,)
    bumper.on_value(math.nan, 100.0)
    assert math.isnan(bumper.value(100.0)[0])
