# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Parts of the screen (pages, lines, buttons and keys of a subject), with one interface.

Each has a row in :mod:`mhri.screen.parts`. The screen creates, updates and closes them in a loop
without referring to any by name, and works without them.
"""
from dataclasses import dataclass
from typing import Any, Callable, Dict, Mapping, Optional, Sequence

#: the jobs of the operator; the drawer has a page for each, to which parts add sections
ROBOTS, MISSION, SETUP = 'robots', 'mission', 'setup'


@dataclass(frozen=True)
class ScreenContext:
    """The services of the screen that a part may use.

    :param screen: :class:`mhri.screen.gui.screen.ScreenWidget`
    :param backend: :class:`mhri.screen.ros.backend.ScreenBackend`
    :param tiles: :class:`mhri.screen.presenters.tiles_presenter.TilesPresenter`
    :param parts: {key: part} of the parts created before
    :param select: function that selects exactly the robots of a list
    :param note: function of (kind, text, robot, data) that passes an event to every part
    :param guard: function that creates the
        :class:`mhri.screen.presenters.draw_guard.DrawGuard` of a widget
    """

    screen: Any
    backend: Any
    tiles: Any
    parts: Mapping[str, 'Part']
    select: Callable[[Sequence[str]], None]
    note: Callable[..., None]
    guard: Callable[[Any], Any]


class Part:
    """One part; every method is called on the GUI thread and returns at once.

    Its class method ``of(context)`` creates it from a :class:`ScreenContext`.
    """

    #: for how long this part has been recording the session [s], None while it is not
    recorded_s: Optional[float] = None

    def start(self) -> None:
        """Start; the screen is complete by now."""

    def amend(self, view: Any) -> Any:
        """Return a :class:`mhri.base.views.ScreenView` with this part's data about the robots."""
        return view

    def show_view(self, view: Any) -> None:
        """Update it from the newest :class:`mhri.base.views.ScreenView`."""

    def note(self, kind: str, text: str, robot: str = '',
             data: Optional[Mapping[str, Any]] = None) -> None:
        """Handle an event that is in no view, e.g. ``('request.refused', 'not done: ...')``.

        :param kind: a key of :data:`mhri.events.events.KINDS`
        :param data: as in :class:`mhri.base.views.Change`
        """

    def mark(self) -> None:
        """Mark this moment, if this part records it."""

    def disable(self) -> None:
        """Disable all actions on robots or files: the screen shows a replay."""

    def save_settings(self) -> Dict[str, Any]:
        """Return the settings to keep between runs: JSON values."""
        return {}

    def restore_settings(self, settings: Mapping[str, Any]) -> None:
        """Restore a dict of :meth:`save_settings`, even if keys are missing."""

    def close(self, forget: bool = False) -> None:
        """Close the part; return at once.

        :param forget: also unregister from the master, since the node outlives the screen
        """
