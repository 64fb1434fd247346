# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The tones as samples: loud enough, short, and without a click."""
import numpy as np
import pytest

from mhri.events.tones import samples, TONES, urgency


@pytest.mark.parametrize('tone', TONES)
def test_samples(tone):
    rate_hz, channels = 48000, 2
    loudness, parts = TONES[tone]
    sound = samples(tone, rate_hz, channels)
    assert sound.dtype == np.int16 and sound.shape == (
        sum(round(length_s * rate_hz) for _, length_s in parts), channels)
    assert abs(np.abs(sound).max() - loudness * 32767) < 0.02 * 32767
    assert np.abs(np.diff(sound[:, 0].astype(int))).max() < 0.21 * 32767, 'it would click'
    assert (sound[:, 0] == sound[:, -1]).all() and len(sound) < 1.0 * rate_hz


def test_the_tone_of_a_lost_robot_is_the_most_urgent():
    assert sorted(TONES, key=urgency) == ['calm', 'attention', 'lost']
