# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A screen that began without its saved settings."""


class FreshStart:
    """Whether the operator has changed robots or mode, so that the settings may be overwritten.

    Create it when the robots of the command line are in the list.

    :param presenter: :class:`mhri.screen.presenters.screen_presenter.ScreenPresenter`
    """

    def __init__(self, presenter):
        self._selection = presenter.operator.selection
        self._robots = self._selection.robots
        self._has_mode = False
        # The mux publishes a mode by itself, so a mode need not be the operator's choice.
        presenter.screen.mode_combo.mode_requested.connect(self._on_mode)

    def _on_mode(self, *_):
        self._has_mode = True

    @property
    def is_changed(self):
        """Whether robots or mode have been changed."""
        return self._has_mode or self._robots != self._selection.robots
