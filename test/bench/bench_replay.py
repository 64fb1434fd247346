# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""How long a jump in a recorded session takes: one hour, four robots with all their sensors.

The session is made: a bag a minute, as a recording has them. Measured is the time from a request to
the player's word that it is there, for jumps to random moments, the first of them into bags that
nobody has opened. Goal: 1 s at most. It writes about 1 GB, at the rates of real robots; with
``--short`` far less. ``--fastest`` is every sensor at its full rate, pictures of 10 kB at 30 Hz
(6 GB).
"""
import argparse
import os
import random
import statistics
import sys
import tempfile
import threading
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..'))

from support.ros_system import System, wait_for  # noqa: E402

ROBOTS = tuple('bot{}'.format(number + 1) for number in range(4))
SHORT = {'odom': 1.0, 'scan': 0.2}
FULL = {'odom': 20.0, 'imu': 50.0, 'scan': 5.0, 'camera/rgb/image_raw/compressed': 5.0}
FASTEST = {'odom': 50.0, 'imu': 100.0, 'scan': 10.0, 'camera/rgb/image_raw/compressed': 30.0}
JUMPS = 20


def write(folder, minutes, rates_hz):
    """Write the session, without a line of events; return its messages."""
    from support import made_session as made
    count = 0
    for number in range(minutes):
        rows = made.hour_rows(60.0 * number, 60.0 * (number + 1), ROBOTS, rates_hz, bytes(10000))
        made.write_bag(os.path.join(folder, '{:04d}.bag'.format(number)), rows)
        count += len(rows)
    return count


def jumps_s(length_s):
    """Return how long each of some jumps took [s]."""
    import rospy
    from mhri.msg import ReplayState
    from mhri.srv import ControlReplay
    rospy.init_node('bench_replay', disable_signals=True)
    newest, arrived = [None], threading.Event()

    def hear(state):
        newest[0] = state
        arrived.set()
    subscriber = rospy.Subscriber('/mhri_replay/state', ReplayState, hear, queue_size=10,
                                  tcp_nodelay=True)
    rospy.wait_for_service('/mhri_replay/control', timeout=120.0)
    control = rospy.ServiceProxy('/mhri_replay/control', ControlReplay)
    wait_for(lambda: newest[0] is not None and newest[0].settled, 120.0, 'the player')
    control('pause', 0.0)
    chance, found = random.Random(14), []
    for _ in range(JUMPS):
        jumps, begun = newest[0].jumps, time.monotonic()
        control('seek', chance.uniform(2.0, length_s - 2.0))
        while not (newest[0].jumps > jumps and newest[0].settled):
            arrived.wait(5.0)
            arrived.clear()
        found.append(time.monotonic() - begun)
    subscriber.unregister()
    return found


def main():
    """Write a session, replay it, and print how long jumps took."""
    parser = argparse.ArgumentParser(description=__doc__.split('\n')[0])
    parser.add_argument('--minutes', type=int, help='how long it is [min]: 60, or short 5')
    parser.add_argument('--short', action='store_true', help='fewer minutes and messages')
    parser.add_argument('--fastest', action='store_true', help='every sensor at its full rate')
    options = parser.parse_args()
    options.minutes = options.minutes or (5 if options.short else 60)
    with System() as system, tempfile.TemporaryDirectory(prefix='mhri_bench_') as folder:
        begun = time.monotonic()
        count = write(folder, options.minutes, SHORT if options.short else
                      FASTEST if options.fastest else FULL)
        print('{} messages of {} min written in {:.1f} s'.format(
            count, options.minutes, time.monotonic() - begun))
        system.start_master()
        system.node('mhri_replay', folder)
        took = jumps_s(60.0 * options.minutes)
    print('MEASURED jump in a session of {} min with {} robots: first {:.0f} ms, p50 {:.0f} ms, '
          'p95 {:.0f} ms, most {:.0f} ms'.format(
              options.minutes, len(ROBOTS), 1000 * took[0], 1000 * statistics.median(took),
              1000 * sorted(took)[int(0.95 * len(took))], 1000 * max(took)))


if __name__ == '__main__':
    main()
