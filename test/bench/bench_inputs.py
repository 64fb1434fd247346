# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""CPU of the pad's node: suspended, looking for a pad, with a pad at rest, driving, and in a storm.

The real node, with SDL's virtual joysticks as its hardware. These have no file to wait for, so the
node looks at them 250 times a second; a real pad costs less. Goal: suspended as good as nothing
(the rest of it is rospy's: master watch and diagnostics); driving below 5 % of a core.
"""
import argparse
import os
import sys
import time

import psutil

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..'))

from support.ros_system import System, wait_for  # noqa: E402
from support.virtual_pad import missing, PadProcess  # noqa: E402

SERVICE = '/mhri_joy/set_suspended'


def switches(pid):
    """Return how often all threads of a process have gone to sleep by themselves."""
    total = 0
    for thread in os.listdir('/proc/{}/task'.format(pid)):
        try:
            with open('/proc/{}/task/{}/status'.format(pid, thread), encoding='utf-8') as status:
                text = status.read()
        except (FileNotFoundError, ProcessLookupError):
            continue  # it has ended since it was listed
        total += int(text.split('\nvoluntary_ctxt_switches:')[1].split()[0])
    return total


class Meter:
    """Measures a process over some seconds."""

    def __init__(self, pid, seconds, received):
        self._process = psutil.Process(pid)
        self._seconds = seconds
        self._received = received
        self.rows = []

    def measure(self, state, busy=lambda until: None):
        """Add a row; ``busy`` moves the pad until a time, here, while it is measured."""
        begun, times, count = time.monotonic(), self._process.cpu_times(), len(self._received)
        slept = switches(self._process.pid)
        busy(begun + self._seconds)
        time.sleep(max(0.0, begun + self._seconds - time.monotonic()))
        took, after = time.monotonic() - begun, self._process.cpu_times()
        spent = after.user + after.system - times.user - times.system
        self.rows.append((state, 100.0 * spent / took, (len(self._received) - count) / took,
                          (switches(self._process.pid) - slept) / took))


def measure(seconds):
    """Return the rows of the table."""
    import rospy
    from sensor_msgs.msg import Joy
    from mhri.srv import SetSuspended
    rospy.init_node('bench_inputs', disable_signals=True)
    received = []
    rospy.Subscriber('/mux_in/ps3joy', Joy, received.append, queue_size=1000, tcp_nodelay=True)
    with PadProcess() as node:
        rospy.wait_for_service(SERVICE, 120.0)
        set_suspended = rospy.ServiceProxy(SERVICE, SetSuspended)
        meter = Meter(node.pid, seconds, received)
        meter.measure('suspended, never resumed')
        set_suspended(False)
        wait_for(lambda: 'none is connected' in set_suspended(False).message, 30.0, 'the search')
        meter.measure('looking for a pad')
        pad = node.do('attach', name='Sony PLAYSTATION(R)3 Controller')
        wait_for(lambda: received, 10.0, 'the pad')
        meter.measure('pad at rest')

        def drive(until, period_s=0.02):
            value = 0
            while time.monotonic() < until:
                value += 1
                node.do('set', number=pad, axes={0: (value % 40 - 20) / 20.0, 1: -0.5})
                time.sleep(period_s)
        meter.measure('driving: a stick moved 50 times a second', drive)
        meter.measure('storm: 1000 changes a second', lambda until: node.do(
            'storm', number=pad, axis=0, seconds=until - time.monotonic()))
        set_suspended(True)
        meter.measure('suspended again')
    return meter.rows


def main():
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--short', action='store_true', help='fewer seconds')
    options = parser.parse_args()
    if missing():
        print('no figures: {}'.format(missing()))
        return
    with System() as system:
        system.start_master()
        rows = measure(0.5 if options.short else 15.0)
    print('{:<44} {:>13} {:>13} {:>14}'.format(
        'mhri_joy', '% of a core', 'messages/s', 'wake-ups/s'))
    for state, cpu, rate_hz, wakes_hz in rows:
        print('{:<44} {:>13.2f} {:>13.1f} {:>14.1f}'.format(state, cpu, rate_hz, wakes_hz))
    print('driving and storm include the stand-in, which moves the pad inside the node\'s process')


if __name__ == '__main__':
    main()
