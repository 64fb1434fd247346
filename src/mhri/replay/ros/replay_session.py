# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The marks of a replayed session, from its lines."""
from mhri.session.ros.session_client import SessionClient


class ReplaySession(SessionClient):
    """A :class:`SessionClient` for a session that may jump in time; it records nothing.

    :param history: :class:`mhri.session.history.SessionHistory`
    :param wall: function that returns the time of the session [s since 1970]
    """

    def __init__(self, history, wall):
        super().__init__()
        self._history = history
        self._wall = wall

    def start(self):
        """Do nothing: a replay has no recorder."""

    def flags(self):
        """Return the flags of the marks so far."""
        return self._history.flags(self._wall())
