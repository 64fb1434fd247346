# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The active screen: of the screens of a process, which share one node, only one drives."""
import threading


class ActiveScreen:
    """One seat for many screens; the first one keeps it until it leaves or another takes it."""

    def __init__(self):
        self._lock = threading.Lock()
        self._holder = None

    def holds(self, screen):
        """Return whether a screen has the seat; assign a free seat to it."""
        with self._lock:
            if self._holder is None:
                self._holder = screen
            return self._holder is screen

    def take(self, screen):
        """Assign the seat to a screen, regardless of its holder."""
        with self._lock:
            self._holder = screen

    def leave(self, screen):
        """Release the seat if this screen holds it."""
        with self._lock:
            if self._holder is screen:
                self._holder = None


SEAT = ActiveScreen()
