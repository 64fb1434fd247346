# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What a subject adds to the screen: pages, lines, buttons and keys, all of one shape.

A row of :mod:`mhri.screen.parts` names each; the screen makes, shows and closes them in turn and
knows none by its name. One that is not there is missed by nobody.
"""
from dataclasses import dataclass
from typing import Any, Callable, Mapping, Optional


@dataclass(frozen=True)
class Desk:
    """What a part may use.

    :param screen: :class:`mhri.screen.gui.screen.ScreenWidget`
    :param backend: :class:`mhri.screen.ros.backend.ScreenBackend`
    :param events: :class:`mhri.screen.presenters.event_host.EventHost`
    :param save_stills: saves every picture on show
    :param parts: {key: part} of those made before
    """

    screen: Any
    backend: Any
    events: Any
    save_stills: Callable[[], None]
    parts: Mapping[str, 'Part']


class Part:
    """One part; everything is called on the GUI thread and returns at once.

    A part is made by its class method ``of(desk)``, of a :class:`Desk`.
    """

    #: for how long this part has been recording the session [s], None while it is not
    recorded_s: Optional[float] = None

    def show_view(self, view: Any) -> None:
        """Take in the :class:`mhri.base.views.PanelView` of this moment."""

    def mark(self) -> None:
        """Mark this moment, if that is this part's job."""

    def disable(self) -> None:
        """Take away what would do something: the screen only looks, at a replay."""

    def close(self) -> None:
        """End."""
