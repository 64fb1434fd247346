# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Time as a test has it."""


class Clock:
    """A clock that is set by hand."""

    now = 100.0

    def __call__(self):
        return self.now
