# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What a subject adds to the screen: pages, lines, buttons and keys, all with one interface.

Each has a row in :mod:`mhri.screen.parts`. The screen creates, updates and closes them in a loop
and knows none of them by name: everything else works without them.
"""
from dataclasses import dataclass
from typing import Any, Callable, Mapping, Optional


@dataclass(frozen=True)
class ScreenContext:
    """What a part may use of the screen.

    :param screen: :class:`mhri.screen.gui.screen.ScreenWidget`
    :param backend: :class:`mhri.screen.ros.backend.ScreenBackend`
    :param events: :class:`mhri.screen.presenters.event_host.EventHost`
    :param save_stills: saves every picture on show
    :param parts: {key: part} of those created before
    """

    screen: Any
    backend: Any
    events: Any
    save_stills: Callable[[], None]
    parts: Mapping[str, 'Part']


class Part:
    """One part; every method is called on the GUI thread and returns at once.

    Its class method ``of(context)`` creates it from a :class:`ScreenContext`.
    """

    #: for how long this part has been recording the session [s], None while it is not
    recorded_s: Optional[float] = None

    def show_view(self, view: Any) -> None:
        """Update it from the newest :class:`mhri.base.views.PanelView`."""

    def mark(self) -> None:
        """Mark this moment, if this part records it."""

    def disable(self) -> None:
        """Disable whatever acts on robots or files: the screen shows a replay."""

    def close(self) -> None:
        """End."""
