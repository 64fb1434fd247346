# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""CPU of the pedal's node, and how long a release takes from the device to the Joy.

The real node with a stand-in foot switch, then with SDL's virtual joystick as rudder pedals (which
has no file to wait for, so that it is looked at 250 times a second; real pedals cost less). Goal:
suspended as good as nothing (the rest of it is rospy's: master watch and diagnostics); driving
below 5 % of a core.
"""
import argparse
import os
import shutil
import sys
import tempfile
import time

from bench_inputs import Meter

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..'))

from support import evdev_stream  # noqa: E402
from support.ros_system import System, wait_for  # noqa: E402
from support.virtual_pad import missing, PadProcess  # noqa: E402

SERVICE = '/mhri_pedal/set_suspended'
RUDDER = 'Saitek Pro Flight Rudder Pedals'


class Received(list):
    """The messages on ``/mux_in/pedal`` with the times of their arrival."""

    def __init__(self):
        super().__init__()
        import rospy
        from sensor_msgs.msg import Joy
        self._subscriber = rospy.Subscriber(
            '/mux_in/pedal', Joy, lambda message: self.append((time.monotonic(), message)),
            queue_size=1000, tcp_nodelay=True)

    def wait(self, good, begun):
        """Return when the first message after a time came of which ``good(axes)`` is true."""
        return wait_for(lambda: next((at for at, message in self[-100:]
                                      if at >= begun and good(message.axes)), None),
                        20.0, 'the pedal', poll_s=0.0002)


def set_suspended(suspended):
    """Call the service; return its message."""
    import rospy
    from mhri.srv import SetSuspended
    rospy.wait_for_service(SERVICE, 120.0)
    return rospy.ServiceProxy(SERVICE, SetSuspended)(suspended).message


def measure_switch(system, seconds, taps):
    """Return (rows of CPU, times from the device to the Joy in ms)."""
    folder = evdev_stream.make_folders(tempfile.mkdtemp(prefix='mhri_pedal_'))
    received = Received()
    node = system.start(sys.executable, evdev_stream.__file__, folder)
    meter = Meter(node.pid, seconds, received)
    set_suspended(True)
    meter.measure('foot switch: suspended, never resumed')
    set_suspended(False)
    # SDL, which is looked at for rudder pedals, takes a moment to load.
    wait_for(lambda: 'no foot pedal' in set_suspended(False), 30.0, 'the search')
    meter.measure('looking for a pedal')
    switch = evdev_stream.StreamNode(folder, 1, 'PCsensor FootSwitch', '3553:b001', 'usb-1/input0',
                                     ('KEY_A', 'KEY_B', 'KEY_C'))
    wait_for(lambda: received, 20.0, 'the pedal')
    meter.measure('pedal at rest')
    switch.press('KEY_B')
    meter.measure('driving: a pedal held', lambda until: repeat(switch, until))
    switch.release('KEY_B')
    meter.measure('driving: ten changes a second', lambda until: tread(switch, until))
    times = [value for number in range(taps) for value in tap(switch, received, number)]
    set_suspended(True)
    meter.measure('suspended again')
    system.kill(node)
    switch.pull()
    shutil.rmtree(folder, ignore_errors=True)
    return meter.rows, times


def repeat(switch, until):
    """Let the kernel repeat the key of a held pedal 30 times a second."""
    while time.monotonic() < until:
        switch.key('KEY_B', 2)
        time.sleep(1.0 / 30.0)


def tread(switch, until):
    """Press and release."""
    while time.monotonic() < until:
        for value in (1, 0):
            switch.key('KEY_A', value)
            time.sleep(0.1)


def tap(switch, received, number):
    """Press and release, at any time between two repetitions; return both delays [ms]."""
    found = []
    for value in (1, 0):
        time.sleep(0.06 + 0.0017 * (number % 30))
        begun = time.monotonic()
        switch.key('KEY_B', value)
        found.append((received.wait(lambda axes: axes[1] == value, begun) - begun) * 1000.0)
    return found


def measure_rudder(seconds):
    """Return rows of CPU with rudder pedals."""
    received = Received()
    with PadProcess('_device:=' + RUDDER, module='mhri.nodes.mhri_pedal') as node:
        meter = Meter(node.pid, seconds, received)
        set_suspended(True)
        pedals = node.do('attach', name=RUDDER, axes=3, buttons=0, vendor=0x06a3, product=0x0763)
        node.do('set', number=pedals, axes={0: -1.0, 1: -1.0, 2: 0.0})
        set_suspended(False)
        wait_for(lambda: received, 30.0, 'the rudder pedals')
        meter.measure('rudder pedals at rest')

        def drive(until):
            value = 0
            while time.monotonic() < until:
                value += 1
                node.do('set', number=pedals, axes={1: (value % 20) / 20.0})
                time.sleep(0.02)
        meter.measure('rudder pedals: a toe moved 50 times a second', drive)
    return meter.rows


def main():
    """Print two tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--short', action='store_true', help='fewer seconds')
    options = parser.parse_args()
    seconds, taps = (0.5, 5) if options.short else (12.0, 200)
    with System() as system:
        system.start_master()
        import rospy
        rospy.init_node('bench_pedal', disable_signals=True)
        rows, times = measure_switch(system, seconds, taps)
        if not missing():
            rows += measure_rudder(seconds)
        rospy.signal_shutdown('measured')
    print('{:<46} {:>12} {:>12} {:>12}'.format(
        'mhri_pedal', '% of a core', 'messages/s', 'wake-ups/s'))
    for state, cpu, rate_hz, wakes_hz in rows:
        print('{:<46} {:>12.2f} {:>12.1f} {:>12.1f}'.format(state, cpu, rate_hz, wakes_hz))
    times.sort()
    print('{} presses and releases, from the device to the Joy [ms]: p50 {:.2f}, p90 {:.2f}, '
          'p99 {:.2f}, max {:.2f}'.format(len(times), *(
              times[min(len(times) - 1, int(share * len(times)))]
              for share in (0.5, 0.9, 0.99, 1.0))))


if __name__ == '__main__':
    main()
