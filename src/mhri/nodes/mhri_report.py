# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The executable ``mhri_report``: a page, a map and a film of a recorded session.

It needs no master, and never writes into the session. The exit status is 0 if all is written, 1 if
it is no session or something cannot be written, 130 if it was cancelled.
"""
import argparse
import os
import signal
import sys
import time

from mhri.core.config import short
from mhri.core.recording.recording import size_text
from mhri.core.session.folder import NotASession
from mhri.ros.session.report_files import folder_for, write_report
from mhri.ros.session.told import opened, Teller


def parse(argv):
    """Return the options of a command line."""
    parser = argparse.ArgumentParser(
        prog='mhri_report', description='Make a page and a map of a recorded session.')
    parser.add_argument('session', metavar='FOLDER', help='of the session')
    parser.add_argument('--output', metavar='FOLDER', help='where the files go; else '
                        '$ROS_HOME/mhri/reports/<name of the session>')
    return parser.parse_args(argv)


def make(options):
    """Write everything, and print what and how long it took."""
    began = time.monotonic()
    with opened(options.session) as session:
        folder = options.output or folder_for(session.name, os.environ)
        if os.path.realpath(folder) == os.path.realpath(session.path):
            raise NotASession('{}: a report is not written into its session; --output takes '
                              'another folder'.format(folder))
        teller = Teller(session)
        report = teller.read()
        told(write_report(report, teller.grid, session.path, folder), began)


def told(paths, began):
    """Print what was written, how large it is, and how long it took [s, monotonic]."""
    for path in paths:
        print('{}  {}'.format(path, size_text(os.path.getsize(path))))
    print('made in {:.1f} s'.format(time.monotonic() - began), flush=True)


def _cancel(*_):
    raise KeyboardInterrupt


def main():
    """Do what the command line says, and exit."""
    options = parse(sys.argv[1:])
    signal.signal(signal.SIGTERM, _cancel)
    try:
        make(options)
    except (NotASession, OSError) as error:
        print('mhri_report: {}'.format(short(error)), file=sys.stderr)
        sys.exit(1)
    except KeyboardInterrupt:
        print('mhri_report: cancelled', file=sys.stderr)
        sys.exit(130)
