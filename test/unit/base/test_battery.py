# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The charge of a battery, in whichever unit its driver reports it."""
import math

import pytest

from mhri.base.battery import Charge

CASES = {
    'a_fraction': ('', (1.0, 0.6, 0.05), (1.0, 0.6, 0.05)),
    'a_little_over_one': ('', (1.13, 0.9), (1.0, 0.9)),
    'percent_down_to_the_last': ('', (80.0, 1.6, 1.4, 1.0, 0.6), (0.8, 0.016, 0.014, 0.01, 0.006)),
    'percent_of_the_type': ('percent', (1.4, 80.0), (0.014, 0.8)),
    'a_fraction_of_the_type': ('fraction', (0.8, 80.0, 1.1), (0.8, None, 1.0)),
    'what_cannot_be': ('', (-1.0, 111.0, math.nan, math.inf, 0.4), (None,) * 4 + (0.4,)),
    'an_impossible_one_is_no_percent': ('', (0.5, 1e30, 0.5), (0.5, None, 0.5))}


@pytest.mark.parametrize('unit, reported, charges', CASES.values(), ids=CASES)
def test_the_charge(unit, reported, charges):
    charge = Charge(unit)
    assert [charge.read(value) for value in reported] == [
        value if value is None else pytest.approx(value) for value in charges]
