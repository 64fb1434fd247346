# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Advice for an operator whose commands are not recognised."""
from collections import deque
from dataclasses import replace
from typing import Deque

from mhri.voice.speech import UNCLEAR, Utterance

# Advice is given after this many failed attempts in a row within this time [s].
ATTEMPTS = 3
RECENT_S = 30.0
# Longer utterances are talk, not commands [s].
MAX_COMMAND_S = 4.0
_WORDS = 'not understood {} times: speak slower and close to the microphone, {}'


class Attempts:
    """Counts the failed attempts to say a command."""

    def __init__(self) -> None:
        self._failed: Deque[float] = deque(maxlen=ATTEMPTS)

    def clear(self) -> None:
        """Forget the attempts so far."""
        self._failed.clear()

    def judge(self, heard: Utterance, lasted_s: float, now: float, held: bool,
              taught: bool = False) -> Utterance:
        """Return an utterance; after several failures its reason is advice.

        :param lasted_s: duration of the utterance [s]
        :param now: [s, monotonic]
        :param held: push-to-talk was held, and is therefore not advised
        :param taught: the voice was taught, and teaching is therefore not advised
        """
        if heard.reason not in UNCLEAR:
            self.clear()
            return heard
        if lasted_s > MAX_COMMAND_S and not held:
            return heard
        self._failed.append(now)
        if len(self._failed) < ATTEMPTS or now - self._failed[0] > RECENT_S:
            return heard
        other = 'drive another way' if held else 'hold push-to-talk'
        other = 'or ' + other if taught else other + ', or teach it your voice'
        return replace(heard, reason=_WORDS.format(ATTEMPTS, other))
