#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Every drill driven by the scripted operator, with links of 0, 200 and 400 ms each way.

Without ROS, in a virtual clock: the time each takes does not depend on the machine. The long form
adds runs on the graph, where it does: every drill three times with each link (an hour; ``--only``
takes some of them, ``--times`` fewer).
"""
import argparse
import os
from pathlib import Path
import statistics
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.realpath(__file__)), '..'))

from mhri.drill.rehearsal import Rehearsal  # noqa: E402
from support.drills import drill, NAMES  # noqa: E402

DELAYS_S = (0.0, 0.2, 0.4)
AGAIN = 3
TIMEOUT_S = 400.0
# Runs that are the same but for chance differ by less.
REPEATS_WITHIN = 0.05


def rehearsed(names):
    """Print a line for each drill; return whether more delay took longer everywhere."""
    print('{:18}{:>12}{:>12}{:>12}{:>12}'.format(
        'drill', *('{:.0f} ms'.format(1e3 * delay_s) for delay_s in DELAYS_S), 'contacts'))
    good = True
    for name in names:
        results = [Rehearsal(*drill(name), delay_s=delay_s).run() for delay_s in DELAYS_S]
        times = [result['time_s'] for result in results]
        good = good and times == sorted(set(times))
        print('{:18}{}{:>12}'.format(name, ''.join('{:10.1f} s'.format(each) for each in times),
                                     sum(result['contacts'] for result in results)))
    return good


def live(name, delay_s):
    """Return the result of a run on the graph."""
    from mhri.drill.ros.files import result_in
    from support.ros_system import System, wait_for
    scenario = drill(name)[0]
    plan = Path(__file__).resolve().parents[2] / 'resource' / 'drills' / 'plans' / scenario.plan
    with System() as system:
        system.start_master()
        launched = system.launch(
            'mhri.launch', 'gui:=none', 'inputs:=none', 'sim:={}'.format(len(scenario.types)),
            'sim_types:=' + ' '.join(scenario.types), 'sim_plan:={}'.format(plan),
            'drill:=' + name, 'drill_args:=--scripted --delay {}'.format(delay_s))
        wait_for(lambda: launched.poll() is not None, TIMEOUT_S, 'the drill', poll_s=0.5)
        folder, = (Path(system.home) / 'mhri' / 'drills').iterdir()
        return result_in(str(folder))


def on_the_graph(names, again):
    """Print runs of drills on the graph; return whether all are as they should be."""
    print('{:18}{:>24}{:>24}{:>24}'.format(
        'on the graph', *('{:.0f} ms'.format(1e3 * delay_s) for delay_s in DELAYS_S)))
    good = True
    for name in names:
        runs = [[live(name, delay_s) for _ in range(again)] for delay_s in DELAYS_S]
        times = [[result['time_s'] for result in each] for each in runs]
        spread = max(max(each) / min(each) - 1.0 for each in times)
        middles = [statistics.median(each) for each in times]
        found = all(result['found'] == result['targets'] for each in runs for result in each)
        in_order = middles == sorted(set(middles))
        print('{:18}{}  differ by {:.1f} %, {:.0f} contacts{}{}'.format(
            name, ''.join('{:>24}'.format(' '.join('{:.1f}'.format(time) for time in each) + ' s')
                          for each in times), 100.0 * spread,
            sum(result['contacts'] for each in runs for result in each),
            '' if in_order else ', NOT in order', '' if found else ', NOT all found'), flush=True)
        good = good and in_order and found and spread < REPEATS_WITHIN
    return good


def main():
    """Print the tables; exit with 1 if a link with more delay is not slower."""
    parser = argparse.ArgumentParser(description=__doc__.partition('\n')[0])
    parser.add_argument('--short', action='store_true', help='one drill, without ROS')
    parser.add_argument('--only', nargs='+', choices=NAMES, default=NAMES, metavar='DRILL',
                        help='of those on the graph')
    parser.add_argument('--times', type=int, default=AGAIN, help='runs of each (default: 3)')
    options = parser.parse_args()
    good = rehearsed(NAMES[:1] if options.short else NAMES)
    if not options.short:
        good = on_the_graph(options.only, options.times) and good
    sys.exit(0 if good else 1)


if __name__ == '__main__':
    main()
