# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Buttons that act once when they go down, however often the device repeats them."""
from typing import Dict, FrozenSet, Iterable, Tuple

from mhri.core.driving.profile import STOP_ALL


class ButtonEdges:
    """Remembers, for each source, which actions are held down."""

    def __init__(self) -> None:
        self._held: Dict[str, Tuple[object, FrozenSet[str]]] = {}

    def newly(self, name: str, device: object, pressed: Iterable[str]) -> FrozenSet[str]:
        """Return the actions whose buttons have gone down since the last message, as a set.

        What is held in a device's first message was not pressed for us and does nothing; but a
        stop counts whenever it is seen.

        :param name: the source
        :param device: whatever tells one device from another
        :param pressed: set of actions (:meth:`mhri.core.driving.profile.Profile.pressed`)
        """
        known, held = self._held.get(name, (None, frozenset()))
        down = frozenset(pressed)
        self._held[name] = (device, down)
        if known != device or known is None:
            return down & {STOP_ALL}
        return down - held
