# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What is left of a program that is dead for a while: it waits, and is then that program again."""
import os
import sys
import time


def main():
    """Wait for the seconds of the first argument, then run the rest of them, a command."""
    time.sleep(float(sys.argv[1]))
    os.execv(sys.argv[2], sys.argv[2:])
