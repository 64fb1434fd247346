# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Whether another node is heard: mux and gates, which repeat their state twice a second."""
from typing import Optional, Tuple

SILENT_S = 0.9
# A look that comes this late was held up itself, and knows nothing about the other node.
_OWN_SLEEP_S = 0.5
# One that hangs has been replaced by then, if anybody looks after it (:mod:`mhri.ros.stand_by`).
_REPLACED_S = 5.0


class Neighbour:
    """Knows by its heartbeat whether a node is silent.

    Times are seconds of a clock that never goes back. :meth:`beat` and :meth:`look` may be called
    on different threads.

    :param label: its name in words, e.g. ``the gates``
    """

    def __init__(self, label: str) -> None:
        self._label = label
        self._heard: Optional[Tuple[str, float]] = None
        self._looked_at: Optional[float] = None
        self.silent = False

    def beat(self, caller: str, now: float) -> None:
        """Note that the node was heard."""
        self._heard = caller, now

    def look(self, now: float) -> str:
        """Set ``silent``; call it at least every 0.4 s.

        :returns: the line to log if the node has fallen silent or is heard again, else ''
        """
        late = self._looked_at is not None and now - self._looked_at > _OWN_SLEEP_S
        self._looked_at = now
        if self._heard is None:
            return ''
        caller, at = self._heard
        if late:
            self._heard = caller, now
            at = now
        was, self.silent = self.silent, now - at > SILENT_S
        if self.silent == was:
            return ''
        return '{} ({}): {}'.format(self._label, caller, 'silent for {:.1f} s'.format(
            now - at) if self.silent else 'heard again')

    def words(self, now: float) -> str:
        """Return what is known about it, in words for the diagnostics."""
        if self._heard is None:
            return 'not heard yet'
        caller, at = self._heard
        if not self.silent:
            return '{} is heard'.format(caller)
        return '{} has been silent for {:.0f} s{}'.format(
            caller, now - at, ': end it and start it again' if now - at > _REPLACED_S else '')
