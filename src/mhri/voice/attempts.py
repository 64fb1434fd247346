# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Telling an operator whose voice is not understood what to do about it."""
from collections import deque
from dataclasses import replace
from typing import Deque

from mhri.voice.speech import Heard, UNCLEAR

# So many attempts in a row, none further back than this, make a voice that is not understood.
ATTEMPTS = 3
RECENT_S = 30.0
# Longer than any command is spoken: that was talk.
LONGEST_S = 4.0
_WORDS = 'not understood {} times: speak slower and close to the microphone, {}'


class Attempts:
    """Counts the attempts to say a command that were not understood."""

    def __init__(self) -> None:
        self._failed: Deque[float] = deque(maxlen=ATTEMPTS)

    def clear(self) -> None:
        """Forget the attempts so far."""
        self._failed.clear()

    def judge(self, heard: Heard, lasted_s: float, now: float, held: bool,
              taught: bool = False) -> Heard:
        """Return what was heard, its reason being what to do where nothing is understood.

        :param lasted_s: how long the utterance was [s]
        :param now: [s] of a clock that never goes back
        :param held: push-to-talk was held, which is no advice then
        :param taught: the voice was taught, which is none either
        """
        if heard.reason not in UNCLEAR:
            self.clear()
            return heard
        if lasted_s > LONGEST_S and not held:
            return heard
        self._failed.append(now)
        if len(self._failed) < ATTEMPTS or now - self._failed[0] > RECENT_S:
            return heard
        other = 'drive another way' if held else 'hold push-to-talk'
        other = 'or ' + other if taught else other + ', or teach it your voice'
        return replace(heard, reason=_WORDS.format(ATTEMPTS, other))
