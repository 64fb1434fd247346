# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Detects begin and end of speech in a stream of sound, by its energy over an adaptive floor."""
from collections import deque
from typing import Deque, Iterable

import numpy as np

from mhri.voice.sound import BLOCK_S

BEGIN, GO_ON, END, QUIET = 'begin', 'go_on', 'end', 'quiet'

# Sound kept from before the detection of speech, for a soft first sound.
LEAD_S = 0.3
# A longer pause ends an utterance.
PAUSE_S = 0.4
# Longer than any command: talk, or the onset of a noise.
MAX_UTTERANCE_S = 6.0
_BEGIN_BLOCKS = 4
_BEGIN_OF = 6
# Levels over the floor for the begin of speech, and for the soft end of a word [dB].
_OVER_DB = 6.0
_STILL_DB = 4.0
# The minimum of the floor: a microphone's own hiss [dB of one step of 16 bit].
_LOWEST_DB = 20.0
# The floor is a low percentile of the last sound: speech has pauses, noise has none.
_FLOOR_S = 3.0
_FLOOR_PERCENT = 20.0


def loudness_db(block: bytes) -> float:
    """Return the level of a block of 16 bit samples [dB of one step]; -10.0 for digital silence."""
    samples = np.frombuffer(block, dtype='<i2').astype(np.float32)
    if not samples.size:
        return -10.0
    samples -= samples.mean()
    return float(10.0 * np.log10(np.dot(samples, samples) / samples.size + 0.1))


def has_speech(blocks: Iterable[bytes], floor_db: float) -> bool:
    """Return whether there is speech in some blocks, over a floor of an :class:`Endpointer`."""
    return sum(loudness_db(block) > floor_db + _OVER_DB for block in blocks) >= _BEGIN_BLOCKS


class Endpointer:
    """Splits a stream into utterances.

    Feed it blocks in the form of :mod:`mhri.voice.sound`. Each block is classified as BEGIN
    (:meth:`lead` has the sound so far, including the block), GO_ON, END (the block does not belong
    to the utterance) or QUIET.
    """

    def __init__(self) -> None:
        self._lead: Deque[bytes] = deque(maxlen=int(LEAD_S / BLOCK_S) + _BEGIN_OF)
        self._loud: Deque[bool] = deque(maxlen=_BEGIN_OF)
        self._levels: Deque[float] = deque(maxlen=int(_FLOOR_S / BLOCK_S))
        self._floor_db = _LOWEST_DB
        self._speaking = False
        self._silent_s = 0.0
        self._spoken_s = 0.0
        self._until_floor = 0

    @property
    def speaking(self) -> bool:
        """Whether an utterance is open."""
        return self._speaking

    @property
    def silent_s(self) -> float:
        """The duration of the present silence in the open utterance [s]."""
        return self._silent_s

    @property
    def floor_db(self) -> float:
        """The level of silence [dB of one step of 16 bit]."""
        return self._floor_db

    def lead(self) -> bytes:
        """Return the sound since shortly before the begin of speech."""
        return b''.join(self._lead)

    def feed(self, block: bytes) -> str:
        """Handle one block; return BEGIN, GO_ON, END or QUIET."""
        level = loudness_db(block)
        self._follow(level)
        self._lead.append(block)
        if self._speaking:
            return self._go_on(level)
        self._loud.append(level > self._floor_db + _OVER_DB)
        if sum(self._loud) < _BEGIN_BLOCKS:
            return QUIET
        self._speaking = True
        self._silent_s = self._spoken_s = 0.0
        return BEGIN

    def _go_on(self, level: float) -> str:
        """Classify a block of an open utterance."""
        self._spoken_s += BLOCK_S
        self._silent_s = 0.0 if level > self._floor_db + _STILL_DB else self._silent_s + BLOCK_S
        if self._silent_s < PAUSE_S and self._spoken_s < MAX_UTTERANCE_S:
            return GO_ON
        self._speaking = False
        self._loud.clear()
        self._lead.clear()
        # Update the floor at once: otherwise a new noise would begin the next utterance.
        self._until_floor = 0
        return END

    def _follow(self, level: float) -> None:
        """Update the floor from the noise, five times a second."""
        self._levels.append(level)
        self._until_floor -= 1
        if self._until_floor <= 0:
            self._until_floor = int(0.2 / BLOCK_S)
            floor_db = max(_LOWEST_DB, float(np.percentile(self._levels, _FLOOR_PERCENT)))
            # A long sentence must not raise the floor; noise is ended by MAX_UTTERANCE_S.
            self._floor_db = min(floor_db, self._floor_db) if self._speaking else floor_db
