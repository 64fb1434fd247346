# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The three tones of the screen as samples; they are short and differ in rhythm and pitch."""
from typing import Any, Dict, Tuple

import numpy as np

from mhri.events.events import ATTENTION_TONE, CALM_TONE, LOST_TONE

#: {tone: (loudness in [0, 1], ((pitch [Hz], 0 for a pause; length [s]), ...))}, most urgent first;
#: below 1 kHz, to be audible also with noise-induced hearing loss
TONES: Dict[str, Tuple[float, Tuple[Tuple[float, float], ...]]] = {
    LOST_TONE: (0.8, ((880.0, 0.18), (440.0, 0.18), (880.0, 0.18), (440.0, 0.3))),
    ATTENTION_TONE: (0.5, ((660.0, 0.12), (0.0, 0.08), (660.0, 0.12))),
    CALM_TONE: (0.25, ((523.0, 0.2),)),
}
# Duration of fading each pitch in and out, to avoid clicks.
_FADE_S = 0.015
_FULL = 32767


def urgency(tone: str) -> int:
    """Return the urgency of a tone, 1 for the least urgent, 0 for no tone."""
    return len(TONES) - list(TONES).index(tone) if tone in TONES else 0


def samples(tone: str, rate_hz: int, channels: int = 1) -> Any:
    """Return a tone as an array of 16 bit samples, shape (samples, channels).

    :param tone: a key of :data:`TONES`
    :raises KeyError: the tone is unknown
    """
    loudness, parts = TONES[tone]
    waves = []
    for pitch_hz, length_s in parts:
        time_s = np.arange(round(length_s * rate_hz)) / rate_hz
        fade = np.clip(np.minimum(time_s, length_s - time_s) / _FADE_S, 0.0, 1.0)
        waves.append(fade * np.sin(2.0 * np.pi * pitch_hz * time_s))
    whole = np.rint(loudness * _FULL * np.concatenate(waves)).astype(np.int16)
    return np.repeat(whole[:, np.newaxis], channels, axis=1)
