# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Which screen of a process drives: to the gates they are all one node."""
import threading


class Seat:
    """One seat for many screens; the first to ask has it until it leaves or another takes it."""

    def __init__(self):
        self._lock = threading.Lock()
        self._holder = None

    def holds(self, screen):
        """Tell whether a screen has the seat; a free seat is given to it."""
        with self._lock:
            if self._holder is None:
                self._holder = screen
            return self._holder is screen

    def take(self, screen):
        """Give the seat to a screen, whoever has it."""
        with self._lock:
            self._holder = screen

    def leave(self, screen):
        """Free the seat if this screen has it."""
        with self._lock:
            if self._holder is screen:
                self._holder = None


SEAT = Seat()
