# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Where things are in the checkout."""
from pathlib import Path

REPO = Path(__file__).resolve().parents[2]
SUPPORT = REPO / 'test' / 'support'
RESOURCE = REPO / 'resource'
GUARD = str(REPO / 'utils' / 'remote' / 'mhri_guard')
PLAIN_ROBOT = str(SUPPORT / 'plain_robot.py')
TURTLES = str(SUPPORT / 'turtles.py')
# Messages of robots whose packages are not installed.
MESSAGES = str(SUPPORT / 'messages')
