# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The placeholder of a crashed program: waits, then executes that program again."""
import os
import sys
import time


def main():
    """Wait for as many seconds as the first argument, then execute the others as a command."""
    time.sleep(float(sys.argv[1]))
    os.execv(sys.argv[2], sys.argv[2:])
