# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The executable ``mhri_types``: lists every robot type, and each that was left out.

It needs no master. The exit status is 1 if a type was left out.
"""
import sys

from mhri.graph.ros.resources import robot_types


def lines_of(types):
    """Return a line for each type: name, limits, velocity topics, window."""
    return ['{:<14} {:5.2f} m/s {:5.2f} rad/s  {}  window {}'.format(
        name, kind.limits.linear_mps, kind.limits.angular_rad_s, ', '.join(kind.command),
        kind.window) for name, kind in sorted(types.items())]


def main():
    """Print them and exit."""
    types, errors = robot_types()
    print('\n'.join(lines_of(types)))
    for error in errors:
        print('left out: {}'.format(error), file=sys.stderr)
    sys.exit(1 if errors else 0)
