# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Converts a stream of sound to events: stops at once, commands after their end."""
from dataclasses import dataclass
import time
from typing import Optional

from mhri.voice.endpointing import BEGIN, Endpointer, GO_ON
from mhri.voice.io.recogniser import Hypothesis
from mhri.voice.sound import BLOCK_S


@dataclass(frozen=True)
class Began:
    """Speech has begun; ``at_s`` is the time in the stream [s], also below."""

    at_s: float


@dataclass(frozen=True)
class Spotted:
    """A stop or a wake word was detected within an utterance."""

    at_s: float
    word: str


@dataclass(frozen=True)
class Ended:
    """An utterance has ended; ``hypothesis`` is None if it matches no command.

    ``computed_s`` is the processor time of its recognition [s], without waiting.
    """

    began_s: float
    at_s: float
    hypothesis: Optional[Hypothesis]
    computed_s: float = 0.0


# A short utterance is checked after this much silence already: noise may have hidden a stop from
# the spotter, and a stop must not wait for the end of a pause.
_EARLY_S = 0.16
_SHORT_S = 2.2
_NOT_LOOKED = object()


class Listener:
    """Feeds the utterances of the endpointer to the recogniser.

    In silence only the level is checked, which costs next to nothing.

    :param recogniser: :class:`mhri.voice.io.recogniser.Recogniser`
    :param is_stop: function that returns whether a :class:`Hypothesis` is a valid stop
    """

    def __init__(self, recogniser, is_stop):
        self._recogniser = recogniser
        self._is_stop = is_stop
        self._endpointer = Endpointer()
        self._sound = []
        self._at_s = self._began_s = 0.0
        self._early = _NOT_LOOKED
        self._computed_s = 0.0

    @property
    def floor_db(self):
        """The level of silence [dB of one step of 16 bit]."""
        return self._endpointer.floor_db

    @property
    def speaking(self):
        """Whether an utterance is open."""
        return self._endpointer.speaking

    def feed(self, block):
        """Handle one block; return its events."""
        self._at_s += BLOCK_S
        state = self._endpointer.feed(block)
        if state == BEGIN:
            lead = self._endpointer.lead()
            self._sound, self._began_s = [lead], self._at_s
            self._early, self._computed_s = _NOT_LOOKED, 0.0
            return [Began(self._at_s)] + self._spotted(self._recogniser.begin(lead))
        if state == GO_ON:
            self._sound.append(block)
            return self._spotted(self._recogniser.go_on(block)) or self._look()
        return self.finish()

    def _spotted(self, word):
        """Return the events for a spotted word, [] for ''."""
        return [Spotted(self._at_s, word)] if word else []

    def _look(self):
        """Check for a hidden stop in each pause of a short utterance."""
        silent_s = self._endpointer.silent_s
        if silent_s < _EARLY_S:
            # The utterance goes on: discard an earlier result.
            self._early = self._early if silent_s else _NOT_LOOKED
            return []
        if self._early is not _NOT_LOOKED or self._at_s - self._began_s > _SHORT_S:
            return []
        self._early = found = self._recognise(b''.join(self._sound))
        return [Spotted(self._at_s, found.text)] if found and self._is_stop(found) else []

    def finish(self):
        """End the open utterance, also at the end of the stream; return its events."""
        if not self._sound:
            return []
        sound, self._sound = b''.join(self._sound), []
        self._recogniser.end()
        found = self._early
        if found is _NOT_LOOKED:
            found = self._recognise(sound)
        return [Ended(self._began_s, self._at_s, found, self._computed_s)]

    def _recognise(self, sound):
        """Recognise a sound, and add up the processor time."""
        before_s = time.thread_time()
        found = self._recogniser.recognise(sound)
        self._computed_s += time.thread_time() - before_s
        return found
