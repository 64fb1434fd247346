# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""How old sound is that comes in blocks: what a busy computer leaves in a pipe is not new."""
from mhri.voice.sound import BLOCK_S


class Backlog:
    """Compares the time that a stream has lasted with a clock.

    While nothing waits to be read, the newest block has just been spoken; whatever the stream falls
    behind from there on is the age of its sound. Clocks of sound cards are not exact, so it is
    measured anew each time that nothing waits.

    :param opened_s: when the source was opened [s] of the clock: nothing in it is older
    """

    def __init__(self, opened_s: float) -> None:
        self._lasted_s = 0.0
        self._least_s = opened_s

    def take(self, now_s: float, waits: bool) -> float:
        """Take in that a block was read now; return when it was spoken [s].

        :param waits: more of the sound waits to be read
        """
        self._lasted_s += BLOCK_S
        behind_s = now_s - self._lasted_s
        if not waits or behind_s < self._least_s:
            self._least_s = behind_s
        return now_s - (behind_s - self._least_s)
