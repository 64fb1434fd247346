# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The parameters of the panel: defaults, values, and every way of being wrong."""
import pytest

from mhri.screen.settings import PanelSettings, parse_settings

BEFORE = PanelSettings(thumbnail_hz=7.0, record_warn_free_mb=900.0)


def test_nothing_set_is_the_default():
    assert parse_settings(None, BEFORE) == (PanelSettings(), [])
    assert parse_settings({}) == (PanelSettings(), [])


def test_values():
    settings, errors = parse_settings({'thumbnail_hz': 2, 'thumbnail_width_px': 160,
                                       'record_warn_free_mb': 50, 'record_stop_free_mb': 20.5,
                                       'camera_budget_mbit_s': 20})
    assert not errors
    assert settings == PanelSettings(2.0, 160, 50.0, 20.5, False, 20.0)
    limits = settings.recording_limits()
    assert (limits.warn_free_bytes, limits.stop_free_bytes) == (50_000_000, 20_500_000)


@pytest.mark.parametrize('parameters, word', [
    ({'thumbnail_hz': 0}, 'thumbnail_hz'), ({'thumbnail_hz': 'fast'}, 'thumbnail_hz'),
    ({'thumbnail_width_px': float('nan')}, 'thumbnail_width_px'),
    ({'camera_budget_mbit_s': -0.5}, 'camera_budget_mbit_s'),
    ({'record_stop_free_mb': -1}, 'record_stop_free_mb'), ({'thumbnail_hertz': 5}, 'unknown key'),
    ({'record_warn_free_mb': 10, 'record_stop_free_mb': 20}, 'too late'), ('five', 'mapping')])
def test_what_is_wrong_is_named_and_the_rest_stays(parameters, word):
    settings, errors = parse_settings(parameters, BEFORE)
    assert len(errors) == 1 and word in str(errors[0]) and '/mhri/panel' in str(errors[0])
    assert settings.record_warn_free_mb >= settings.record_stop_free_mb
    assert 0.1 <= settings.thumbnail_hz <= 60.0


def test_one_wrong_value_does_not_hide_a_good_one():
    settings, errors = parse_settings({'thumbnail_hz': 'x', 'thumbnail_width_px': 64}, BEFORE)
    assert settings.thumbnail_hz == 7.0 and settings.thumbnail_width_px == 64 and len(errors) == 1
