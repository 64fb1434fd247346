# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Replays a journal of the drive: ``python3 -m mhri.driving.io.journal_file FILE``."""
import sys

from mhri.driving.journal import replay


def replay_file(path):
    """Return the :class:`mhri.driving.journal.Report` of a file.

    :raises OSError: the file cannot be read
    :raises ValueError: it is not a journal, or has another version
    """
    with open(path, encoding='utf-8', errors='replace') as lines:
        return replay(lines)


def main(argv):
    """Print the result of a replay; return 1 if the drive differs, 2 without a valid journal."""
    if len(argv) != 2:
        print('name the journal to replay', file=sys.stderr)
        return 2
    try:
        report = replay_file(argv[1])
    except (OSError, ValueError) as error:
        print(error, file=sys.stderr)
        return 2
    print('runs of the drive: {}; events: {}; velocities that left: {}'.format(
        report.runs, report.events, report.velocities))
    if report.difference:
        print(report.difference, *report.shortest, sep='\n')
    return bool(report.difference)


if __name__ == '__main__':
    sys.exit(main(sys.argv))
