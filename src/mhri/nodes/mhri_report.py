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

from mhri.base.config import short
from mhri.recording.folder import NotASession
from mhri.recording.recording import size_text
from mhri.session.ros.film import Film
from mhri.session.ros.report_files import folder_for, write_report
from mhri.session.ros.told import opened, Teller


def parse(argv):
    """Return the options of a command line."""
    parser = argparse.ArgumentParser(
        prog='mhri_report', description='Make a page, a map and a film of a recorded session.')
    parser.add_argument('session', metavar='FOLDER', help='of the session')
    parser.add_argument('--output', metavar='FOLDER', help='where the files go; else '
                        '$ROS_HOME/mhri/reports/<name of the session>')
    parser.add_argument('--film', action='store_true',
                        help='a film of the cameras, too; takes a while')
    parser.add_argument('--fps', type=float, default=10.0, metavar='N',
                        help='frames of the film in a second, 1 to 60 (10)')
    options = parser.parse_args(argv)
    if not 1.0 <= options.fps <= 60.0:
        parser.error('--fps: expected 1 to 60, got {:g}'.format(options.fps))
    return options


def make(options):
    """Write everything, and print what and how long it took."""
    began = time.monotonic()
    with opened(options.session) as session:
        folder = options.output or folder_for(session.name, os.environ)
        if os.path.realpath(folder) == os.path.realpath(session.path):
            raise NotASession('{}: a report is not written into its session; --output takes '
                              'another folder'.format(folder))
        teller = Teller(session)
        report = teller.read(Progress('report', 's'))
        told(write_report(report, teller.grid, session.path, folder), began)
        if options.film:
            began = time.monotonic()
            told([Film(session, teller, report).write(
                folder, options.fps, Progress('film', 'frames'))], began)


class Progress:
    """Shows how far something is: on a terminal in place, else a line for every tenth.

    :param what: the word before it
    :param unit: of what it counts
    """

    def __init__(self, what, unit, stream=None):
        self._what, self._unit = what, unit
        self._stream = stream or sys.stderr
        self._there = -1

    def __call__(self, done, count):
        """Take in how many are done, of how many."""
        step = 1 if self._stream.isatty() else 10
        percent = 100 * min(done, count) // count // step * step
        if percent != self._there:
            self._there = percent
            end = '\r' if step == 1 and done < count else '\n'
            self._stream.write('{}: {} %, {} of {} {}{}'.format(
                self._what, percent, done, count, self._unit, end))
            self._stream.flush()


def told(paths, began):
    """Print what was written, how large it is, and how long it took [s, monotonic]."""
    for path in paths:
        size = os.path.getsize(path)
        print('{}  {}'.format(path, size_text(size) if size >= 1000 else '{} bytes'.format(size)))
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
