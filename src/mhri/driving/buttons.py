# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Buttons that act once for each press, however often the device repeats them."""
from typing import Dict, FrozenSet, Iterable, Tuple

from mhri.devices.profile import STOP_ALL


class ButtonEdges:
    """Remembers, for each source, which actions are held down."""

    def __init__(self) -> None:
        self._held: Dict[str, Tuple[object, FrozenSet[str]]] = {}

    def newly(self, name: str, device: object, pressed: Iterable[str]) -> FrozenSet[str]:
        """Return the actions whose buttons have gone down since the last message, as a set.

        A button already held in a device's first message does nothing, since nobody pressed it
        for us; but a stop always counts.

        :param name: the source
        :param device: identifies the device
        :param pressed: set of actions (:meth:`mhri.devices.profile.Profile.pressed`)
        """
        known, held = self._held.get(name, (None, frozenset()))
        down = frozenset(pressed)
        self._held[name] = (device, down)
        if known != device or known is None:
            return down & {STOP_ALL}
        return down - held
