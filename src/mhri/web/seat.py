# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The stick of the page: one viewer holds it, from a centred stick on, while its frames come."""
from typing import Callable, Optional, Sequence, Tuple

# Longest pause between two frames of the stick [s]: as in mux.yaml.
SILENT_S = 0.3
# Deflection that counts as centred: as in pads/virtual.yaml.
NEUTRAL = 0.02
CENTRE = 0.0, 0.0, 0.0

Stick = Tuple[float, float, float]


class Seat:
    """Who has the stick, and which of its frames may drive.

    ``holder`` is the id of a viewer, None while nobody holds; ``why`` a sentence: why the last one
    lost it, '' if it let go. Whoever ends a hold has the centre published
    once; :meth:`stick` alone yields anything else.

    :param clock: returns monotonic seconds
    """

    def __init__(self, clock: Callable[[], float]) -> None:
        self._clock = clock
        self.holder: Optional[str] = None
        self.why = ''
        self._heard_at = 0.0
        self._centred = False

    def take(self, viewer: str, problem: str) -> bool:
        """Take the stick; return whether it is taken now.

        :param problem: why this viewer may not drive now, '' if it may
        """
        if problem or self.holder not in (None, viewer):
            return False
        if self.holder is None:
            self.holder, self.why = viewer, ''
            self._heard_at, self._centred = self._clock(), False
        return True

    def stick(self, viewer: str, values: Sequence[float]) -> Optional[Stick]:
        """Return what to publish for a frame of the stick, None for nothing.

        Nothing comes of frames of others, before the stick was seen centred, and after a pause:
        frames that were held up on their way are old.
        """
        if viewer != self.holder or self.silent():
            return None
        self._heard_at = self._clock()
        turn, ahead, sideways = values
        if all(abs(value) <= NEUTRAL for value in values):
            self._centred = True
        return (turn, ahead, sideways) if self._centred else CENTRE

    def silent(self) -> bool:
        """Return whether the holder's frames have stopped, though it has not let go."""
        return self.holder is not None and self._clock() - self._heard_at > SILENT_S

    def leave(self, viewer: Optional[str], why: str) -> bool:
        """End a hold; return whether there was one: then publish the centre once.

        :param viewer: None: whoever holds
        """
        if self.holder is None or viewer not in (None, self.holder):
            return False
        self.holder, self.why = None, why
        return True
