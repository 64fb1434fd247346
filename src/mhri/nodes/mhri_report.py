# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The executable ``mhri_report``: a page, a map and a video of a recorded session.

It needs no master, and never writes into the session. The exit status is 0 if everything is
written, 1 if the folder is not a session or a file cannot be written, 130 if it was cancelled.
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
from mhri.session.ros.session_reader import opened, ReportBuilder


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
    """Write everything, and print the files and the time it took."""
    began = time.monotonic()
    with opened(options.session) as session:
        folder = options.output or folder_for(session.name, os.environ)
        if os.path.realpath(folder) == os.path.realpath(session.path):
            raise NotASession('{}: a report is not written into its session; --output takes '
                              'another folder'.format(folder))
        builder = ReportBuilder(session)
        report = builder.read(Progress('report', 's'))
        print_summary(write_report(report, builder.grid, session.path, folder), began)
        if options.film:
            began = time.monotonic()
            print_summary([Film(session, builder, report).write(
                folder, options.fps, Progress('film', 'frames'))], began)


class Progress:
    """Shows the progress of a step: in place on a terminal, else as a line for every tenth.

    :param what: the label
    :param unit: the unit of the count
    """

    def __init__(self, what, unit, stream=None):
        self._what, self._unit = what, unit
        self._stream = stream or sys.stderr
        self._there = -1

    def __call__(self, done, count):
        """Show that ``done`` of ``count`` are done."""
        step = 1 if self._stream.isatty() else 10
        percent = 100 * min(done, count) // count // step * step
        if percent != self._there:
            self._there = percent
            end = '\r' if step == 1 and done < count else '\n'
            self._stream.write('{}: {} %, {} of {} {}{}'.format(
                self._what, percent, done, count, self._unit, end))
            self._stream.flush()


def print_summary(paths, began):
    """Print the written files, their sizes, and the time since ``began`` [s, monotonic]."""
    for path in paths:
        size = os.path.getsize(path)
        print('{}  {}'.format(path, size_text(size) if size >= 1000 else '{} bytes'.format(size)))
    print('made in {:.1f} s'.format(time.monotonic() - began), flush=True)


def _cancel(*_):
    raise KeyboardInterrupt


def main():
    """Run the command line, and exit."""
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
