# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Random drives and random goals in a small kinematic world, with the obstacle brake and without.

Every seed is that of its number, so that what went wrong can be looked at again. The exit status is
1 where a robot with its brake on touched anything, or was stuck without a word.
"""
import argparse
import collections
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..'))

from support.task_world import random_drive, random_goal  # noqa: E402

DRIVE_S = 25.0


def main():
    """Run them, and print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--short', action='store_true', help='a tenth of it')
    share = 10 if parser.parse_args().short else 1
    drives, goals, touched = range(200 // share), range(100 // share), []
    for brake in (True, False):
        found = [seed for seed in drives if random_drive(seed, DRIVE_S, brake).contacts]
        ends, met = collections.Counter(), []
        for seed in goals:
            robot = random_goal(seed, brake)
            ends[robot.run.state] += 1
            if robot.contacts:
                met.append(seed)
        print('brake {}: {} of {} drives touched something {}; {} of {} goals {}; goals ended: {}'
              .format('on' if brake else 'off', len(found), len(drives), found[:9], len(met),
                      len(goals), met[:9], dict(ends)), flush=True)
        touched += found + met if brake else []
    return 1 if touched else 0


if __name__ == '__main__':
    sys.exit(main())
