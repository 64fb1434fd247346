# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""One module for each executable: reads parameters, connects the parts, runs, shuts down."""
import signal


class Interrupted(KeyboardInterrupt, SystemExit):
    """Ctrl-C while a program is loading or waiting: if not caught, it ends without a traceback."""


def _interrupt(number, _):
    ended = Interrupted()
    ended.code = 128 + number
    raise ended


try:
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, _interrupt)
except ValueError:
    pass  # not on the main thread: the importing program has its own signal handlers
