# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""One module for each executable: reads parameters, wires, runs, shuts down."""
import signal


class Interrupted(KeyboardInterrupt, SystemExit):
    """Ctrl-C while a program is loaded or waits: who does not look at it ends without a word."""


def _interrupt(number, _):
    ended = Interrupted()
    ended.code = 128 + number
    raise ended


try:
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, _interrupt)
except ValueError:
    pass  # not on the main thread: whoever imports this has signals of its own
