# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The executable ``mhri_types``: lists the robot types, including those that were left out.

``rosrun mhri mhri_types [--from-joy-teleop FILE]``. With a file of joy_teleop it prints rows of
``accessories`` for a robot type instead, see :mod:`mhri.devices.joy_teleop`. It needs no master.
The exit status is 1 if a type was left out, or if the file cannot be read.
"""
import argparse
import sys

from mhri.base.config import ConfigError
from mhri.devices.joy_teleop import as_yaml, read_joy_teleop
from mhri.graph.ros.resources import read_text, robot_types


def lines_of(types):
    """Return a line for each type: name, limits, velocity topics, window."""
    return ['{:<14} {:5.2f} m/s {:5.2f} rad/s  {}  window {}'.format(
        name, kind.limits.linear_mps, kind.limits.angular_rad_s, ', '.join(kind.command),
        kind.window) for name, kind in sorted(types.items())]


def imported(path):
    """Print the accessories of a file of joy_teleop; return the exit status."""
    try:
        print(as_yaml(*read_joy_teleop(read_text(path), path), path), end='')
    except (ConfigError, OSError, ValueError) as error:
        print(error, file=sys.stderr)
        return 1
    return 0


def main():
    """Print the types, or what was imported, and exit."""
    parser = argparse.ArgumentParser(
        prog='mhri_types', description='Lists the robot types that mhri knows.')
    parser.add_argument('--from-joy-teleop', metavar='FILE', help='print accessories for a robot '
                        'type from a configuration of joy_teleop instead')
    path = parser.parse_args().from_joy_teleop
    if path is not None:
        sys.exit(imported(path))
    types, errors = robot_types()
    print('\n'.join(lines_of(types)))
    for error in errors:
        print('left out: {}'.format(error), file=sys.stderr)
    sys.exit(1 if errors else 0)
