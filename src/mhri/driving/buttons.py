# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Buttons that act once per press, however often the device repeats them."""
from typing import Dict, FrozenSet, Iterable, Tuple

from mhri.devices.profile import STOP_ALL


class ButtonEdges:
    """Stores, for each source, the actions whose buttons are held down."""

    def __init__(self) -> None:
        self._held: Dict[str, Tuple[object, FrozenSet[str]]] = {}

    def newly(self, name: str, device: object, pressed: Iterable[str]) -> FrozenSet[str]:
        """Return the actions whose buttons were pressed since the last message, as a set.

        A button already held in a device's first message has no effect, since it was pressed
        earlier; but a stop always counts.

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
