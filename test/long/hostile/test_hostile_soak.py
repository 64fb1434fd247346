# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""An hour of work in three minutes: stick, selection, stops, odometry and comings at 20 times.

Memory, threads and descriptors of mux, the operator's backend and a second screen that looks
on stay as they were, and what a line through them rises in an hour is printed. The long form
(``MHRI_LONG=1``) is the hour, the short one four minutes of it.
"""
import itertools
import threading
import time

from support import graph
from support.hostile import is_long
from support.under_fire import ROBOTS, table, UnderFire

TIMES = 20
WARM_S, SOAK_S = (30.0, 180.0) if is_long() else (4.0, 12.0)
# Python takes memory in pieces of 256 kB; logs of the robots are read by this process, not those.
GROWTH_MB, MORE_THREADS, MORE_DESCRIPTORS = (5.0 if is_long() else 8.0), 4, 8


SAMPLE_S = SOAK_S / 60
UNITS = ('memory [MB]', 'threads', 'descriptors')


class Sampler:
    """Looks at the sizes of all programs again and again; use it as a context manager."""

    def __init__(self, fire):
        self._fire = fire
        self._done = threading.Event()
        self._thread = threading.Thread(target=self._run)
        self.rows = []

    def __enter__(self):
        self._begun = time.monotonic()
        self._thread.start()
        return self

    def __exit__(self, *_):
        self._done.set()
        self._thread.join()

    def _run(self):
        while not self._done.wait(SAMPLE_S):
            self.rows.append((time.monotonic() - self._begun, self._fire.sizes()))

    def rises(self):
        """Return {program: (MB, threads, descriptors) that its fitted line rises in the hour}."""
        hours = [at * TIMES / 3600.0 for at, _ in self.rows]
        return {name: tuple(slope(hours, [sizes[name][unit] for _, sizes in self.rows])
                            for unit in range(3)) for name in self.rows[0][1]}

    def tell(self):
        """Print how each program went, at six moments of it, and its fitted line."""
        few = self.rows[::max(1, len(self.rows) // 6)]
        for name, rises in self.rises().items():
            for unit, rise in zip(range(3), rises):
                print('MEASURED {:8} {:12} {}  line: {:+.2f} in an hour'.format(
                    name, UNITS[unit], ' '.join('{:.1f}'.format(sizes[name][unit])
                                                for _, sizes in few), rise))


def slope(hours, values):
    """Return the slope of the line of least squares."""
    middle, mean = sum(hours) / len(hours), sum(values) / len(values)
    return sum((x - middle) * (y - mean) for x, y in zip(hours, values)) \
        / sum((x - middle) ** 2 for x in hours)


def work(fire, seconds):
    """Do what an operator does in ``TIMES`` times as long; return how often."""
    import rospy
    from geometry_msgs.msg import Twist
    from sensor_msgs.msg import Joy
    deadline, selected = time.monotonic() + seconds, ROBOTS
    selections = itertools.cycle([ROBOTS[:1], ROBOTS, ROBOTS[1:], (), ROBOTS])
    for number in itertools.count():
        if time.monotonic() > deadline:
            return number
        # Twice a second in life: the lease. Every 20 s another selection and a centred stick.
        if number % 40 == 20:
            selected = next(selections)
        fire.order('select', *selected)
        if number % 40 in (0, 20):
            fire.hold(0.0)
        elif number % 40 in (8, 28):
            fire.hold(0.5)
        if number % 120 == 0:
            fire.call_stop(True)
        elif number % 120 == 4:
            fire.call_stop(False)
        if number % 20 == 10:
            fire.order('mode', 'pedal')
            fire.order('limits', '0.{}'.format(number % 9 + 1), '1.0')
        if number % 40 == 0:
            # Somebody comes, listens, says something, and goes.
            ear = rospy.Subscriber(graph.COMMAND, Twist, lambda message: None)
            mouth = rospy.Publisher(graph.VOICE, Joy, queue_size=1)
            time.sleep(0.05)
            mouth.publish(axes=[0.0, 0.0])
            ear.unregister()
            mouth.unregister()
        time.sleep(0.5 / TIMES)


def test_an_hour_leaves_nothing_behind():
    with UnderFire(stick_hz=20 * TIMES, robot_hz=20 * TIMES) as fire:
        fire.drive()
        fire.wait_loaded()
        fire.start_screen()
        work(fire, WARM_S)
        fire.hold(0.0)
        time.sleep(1.0)
        before = fire.sizes()
        with Sampler(fire) as samples:
            rounds = work(fire, SOAK_S)
        fire.hold(0.0)
        time.sleep(2.0)
        after = fire.sizes()
        told = sum(len(log.rows()) for log in fire.robots.values())
        print('\nMEASURED {} rounds in {:.0f} s, {} words to the robots'.format(
            rounds, SOAK_S, told))
        table(before, after)
        samples.tell()
        fire.check_alive()
        fire.check_straight()
        for name, sizes in after.items():
            more = [new - old for new, old in zip(sizes, before[name])]
            assert more[0] <= GROWTH_MB and more[1] <= MORE_THREADS \
                and more[2] <= MORE_DESCRIPTORS, '{}: {}'.format(name, more)
        # And it still drives.
        fire.drive()
