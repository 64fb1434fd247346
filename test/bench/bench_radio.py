# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Robots behind a bad radio: how old is what they obey, and what the operator is shown of them.

Side by side: by one ROS master for all (TCPROS), and by the link (``mhri_link``; ``tcp`` without
keys, and with them ``tls``, with its sealed datagrams, and by a router on either side of the
radio, ``router_near`` and ``router_far``, where TLS carries all). What goes over the radio: the
commands (20 Hz) and what guard and mux tell each other, and of each robot odometry (50 Hz), IMU
(100 Hz), laser (10 Hz), and the pictures of a camera (jpeg, 30 Hz). Delays are those of one way.
See ``support/behind_radio.py``.

- command: age of a command when the robot first obeyed it, from the stick on; and in what share of
  the time in which the stick was held the robot drove
- pose: age of the newest pose, as often as a screen is drawn (30 Hz)
- pictures: how many came a second of each robot, their age, the longest time without one, the
  median size
- motion: how far a robot went after the operator had let go, and after an outage was over; in the
  rows with an outage the operator lets go within it

A radio that becomes bad is measured at once, and then as it stays. Below each row is what the radio
says that it did. Needs root and /dev/net/tun.
"""
import argparse
import os
import subprocess
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..'))

from support.bad_radio import why_not  # noqa: E402
from support.behind_radio import WAYS, World  # noqa: E402

HERE = os.path.abspath(__file__)
# (title, radio, length of the outage [s], for how long it is measured [s]; '': as it has become)
GOOD = {'delay_ms': 20, 'jitter_ms': 5, 'rate_mbit': 20}
FAIR = {'delay_ms': 50, 'loss_percent': 1, 'rate_mbit': 10}
POOR = {'delay_ms': 200, 'loss_percent': 5, 'rate_mbit': 2}
BAD = {'delay_ms': 200, 'loss_percent': 20, 'rate_mbit': 1}
SHORT_CASES = (('20 ms, outage 0.5 s', GOOD, 0.5, 1.0),)
CASES = (('clean', {}, 0.0, 20.0),
         ('50 ms, 1 %, 10 Mbit/s', FAIR, 0.0, 10.0), ('', FAIR, 0.0, 20.0),
         ('200 ms, 5 %, 2 Mbit/s', POOR, 0.0, 10.0), ('', POOR, 0.0, 20.0),
         ('200 ms, 20 %, 1 Mbit/s', BAD, 0.0, 10.0), ('', BAD, 0.0, 30.0)) + tuple(
             ('20 ms, outage {:g} s'.format(outage_s), GOOD, outage_s, 5.0)
             for outage_s in (0.2, 0.5, 2.0, 30.0))


def triple(values):
    """Return median, p95 and worst of times [s] as they are printed [ms]."""
    if not values:
        return '{:>6} {:>6} {:>6}'.format('-', '-', '-')
    values = sorted(values)
    return '{:>6.0f} {:>6.0f} {:>6.0f}'.format(*(1000.0 * value for value in (
        values[len(values) // 2], values[min(len(values) - 1, int(0.95 * len(values)))],
        values[-1])))


def lines(title, way, figures, report):
    """Return the lines of one case."""
    back = '-' if figures['back_m'] is None else '{:.3f}'.format(figures['back_m'])
    sizes = figures['picture_bytes'] or [0]
    found = ['{:<24}{:<7} {:>4.0f}%{} |{} |{:>5.1f}{}{:>6.1f}{:>5.1f} | {:>6.3f} {:>6}'.format(
        title, way, figures['drove_percent'], triple(figures['ages']),
        triple(figures['poses']), figures['rate_hz'], triple(figures['pictures']),
        figures['gap_s'], sizes[len(sizes) // 2] * 1e-3, figures['motion_m'], back)]
    for row in report['rows']:
        for name, did in row['did'].items():
            if not row['told']['down'] and did['passed']:
                found.append(
                    '    {}: {packets} packets, lost {lost_percent:.1f} %, queue full {queue_full},'
                    ' down {down}, delay {delay_p50_ms:.1f}, {delay_p95_ms:.1f} ms (p50, p95), '
                    '{bytes_per_s:.0f} bytes/s'.format(name, **did))
    return found


HEAD = ('{:<31} {:^25} |{:^21} |{:^36} | {}'.format(
    '', 'command obeyed [ms]', 'pose shown [ms]', 'pictures [1/s, ms, gap s, kB]', 'motion [m]'),
    '{:<31} drove{:>6} {:>6} {:>6} |{:>6} {:>6} {:>6} |{:>5}{:>6} {:>6} {:>6}{:>6}{:>5} | {:>6} '
    '{:>6}'.format('', *('p50', 'p95', 'max') * 2, '', 'p50', 'p95', 'max', 'gap', 'size',
                   'let go', 'back'))


def run(options):
    """Measure and print."""
    cases = SHORT_CASES if options.short else CASES
    if options.cases:
        cases = [cases[number] for number in options.cases]
    with World(options.ways, options.robots) as world:
        world.start()
        print('\n'.join(HEAD))
        for way in options.ways:
            world.look(way)
            for title, row, outage_s, drive_s in cases:
                if title:
                    world.settle(way)
                print('\n'.join(lines(title or '  from then on', way, *world.measure(
                    way, row, outage_s, drive_s))), flush=True)
            world.look_away(way)


def main():
    """Run the benchmark."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--short', action='store_true', help='fewer cases, less time for each')
    parser.add_argument('--ways', nargs='+', choices=list(WAYS),
                        help='default: TCPROS and tls; in the short form tls')
    parser.add_argument('--robots', type=int, default=1, help='so many of each way (1 to 4)')
    parser.add_argument('--cases', type=int, nargs='+', help='only these, from 0')
    parser.add_argument('--inside', action='store_true', help=argparse.SUPPRESS)
    options = parser.parse_args()
    options.ways = options.ways or (['tls'] if options.short else ['TCPROS', 'tls'])
    if not options.inside:
        reason = why_not()
        if reason:
            print('not measured: ' + reason)
            return
        # A network of our own, so that the radio's addresses meet nobody else's.
        os.execvp('unshare', ['unshare', '--net', sys.executable, HERE, '--inside'] + sys.argv[1:])
    subprocess.run(['ip', 'link', 'set', 'lo', 'up'], check=True)
    run(options)


if __name__ == '__main__':
    main()
