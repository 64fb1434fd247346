# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The executable ``mhri_doctor``: examines the ROS system, reports problems and their remedies.

``rosrun mhri mhri_doctor [robot ...] [--json] [--quick] [--watchdog [--yes]]``; exit status 0:
no findings, 1: findings, 2: wrong usage. See :mod:`mhri.doctor.ros.examination`. It is not a node,
except with ``--watchdog`` (``mhri_doctor_*``, which publishes ``/<robot>/<command>``,
``geometry_msgs/Twist``, for a moment).
"""
import argparse
import json
import signal
import sys
import time

import rosgraph

from mhri.base.names import name_problem, tidy_name
from mhri.graph.ros.process_start import started_s

_WARNING = """
WARNING: {} WILL TURN, and perhaps not stop for 3 s.
Go on only if it is simulated, or stands on blocks with its wheels in the air, and somebody has a
hand on its switch. It is turned at 0.3 rad/s for a second; then nothing is sent, to see whether it
stops by itself; at the end it is sent zeros in any case.
"""


def _robot(text):
    """Parse the name of a robot."""
    name = tidy_name(text)
    problem = name_problem(name)
    if problem:
        raise argparse.ArgumentTypeError('{!r} cannot be the name of a robot: {}'.format(
            text, problem))
    return name


def _parse(arguments):
    """Parse the command line; exit with 2 if it is invalid."""
    parser = argparse.ArgumentParser(
        prog='mhri_doctor', description='Examine the ROS system: variables, master, nodes, robots. '
        'Exit status: 0 nothing wrong, 1 findings, 2 wrong use.')
    parser.add_argument('robot', nargs='*', type=_robot, help='judge these robots only')
    parser.add_argument('--json', action='store_true', help='print the findings for scripts')
    parser.add_argument('--quick', action='store_true', help='do not watch whether programs take '
                        'a name from each other: a second less')
    parser.add_argument('--watchdog', action='store_true', help='turn the named robots for a '
                        'moment to see whether they stop by themselves: on blocks, or simulated')
    parser.add_argument('--yes', action='store_true', help='do not ask before --watchdog')
    options = parser.parse_args(arguments)
    if options.watchdog and not options.robot:
        parser.error('--watchdog moves robots: name each one that is on blocks or simulated')
    if options.yes and not options.watchdog:
        parser.error('--yes is for --watchdog')
    if options.watchdog and not options.yes and not sys.stdin.isatty():
        parser.error('--watchdog asks first, and nobody can answer here: add --yes where the '
                     'robot is on blocks or simulated')
    return options


def _agreed(options):
    """Warn and ask; return whether the trial may start."""
    names = ', '.join(options.robot)
    print(_WARNING.format(names), file=sys.stderr)
    if options.yes:
        return True
    print('Type {!r} to go on: '.format(names), end='', file=sys.stderr, flush=True)
    return sys.stdin.readline().strip() == names


def _watchdogs(options):
    """Return the findings of the trials."""
    # Importing rospy and its messages takes time: only the trial needs them.
    import rospy
    from mhri.doctor.ros.watchdog import measure_watchdog
    from mhri.graph.ros.rospy_inside import name_in
    # A signal must end the trial with its zeros, and rospy's own handlers would end the node.
    name_in()
    rospy.init_node('mhri_doctor', anonymous=True, disable_signals=True)
    for number in (signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, lambda number, _: sys.exit(128 + number))
    try:
        return [measure_watchdog(name) for name in options.robot]
    finally:
        rospy.signal_shutdown('done')


def main():
    """Examine, print, and exit with the status."""
    begun = started_s()
    options = _parse(rosgraph.myargv()[1:])
    if options.watchdog and not _agreed(options):
        print('nothing was moved', file=sys.stderr)
        sys.exit(2)
    if options.watchdog:
        begun = time.monotonic()  # the answer may have taken a long time
    # Imported late, so that wrong usage and --help are answered quickly.
    from mhri.doctor.judgement import as_dict, as_lines, exit_status
    from mhri.doctor.ros.examination import examine, WATCH_S
    findings = examine(options.robot, begun=begun, watch_s=0.0 if options.quick else WATCH_S)
    took_s = time.monotonic() - begun
    if options.watchdog:
        findings = _watchdogs(options) + findings
    if options.json:
        print(json.dumps(as_dict(findings, took_s), indent=1))
    else:
        print('\n'.join(as_lines(findings, took_s)))
    sys.exit(exit_status(findings))
