# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Measures the age of sound read in blocks, which waits in a pipe on a busy computer."""
from mhri.voice.sound import BLOCK_S


class Backlog:
    """Compares the duration of a stream with a clock.

    While no sound is waiting, the newest block has just been spoken; from then on the age of the
    sound is the delay of the stream. Clocks of sound cards are not exact, so the reference is
    updated each time that nothing waits.

    :param opened_s: time at which the source was opened [s]: no sound is older
    """

    def __init__(self, opened_s: float) -> None:
        self._lasted_s = 0.0
        self._least_s = opened_s

    def take(self, now_s: float, waits: bool) -> float:
        """Handle that a block was read now; return the time at which it was spoken [s].

        :param waits: whether more sound is waiting
        """
        self._lasted_s += BLOCK_S
        behind_s = now_s - self._lasted_s
        if not waits or behind_s < self._least_s:
            self._least_s = behind_s
        return now_s - (behind_s - self._least_s)
