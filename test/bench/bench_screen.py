# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The screen with 12 robots on show: the Qt event loop, the CPU, and how long it takes to come up.

The robots are played from a bag, cameras (640x480, 30 Hz) and odometry (30 Hz), as they come from
computers of their own. One is looked at on 1920x1080, eleven are thumbnails. What a timer of 2 ms
is late is the time a click would have waited. Wanted: the loop's p99 <= 20 ms; <= 0.6 of a core;
from a warm start to a screen that can be used <= 2 s, beside a bare window of PyQt; from
Shift+Space to STOPPING drawn <= 60 ms, from an arrow key to the stick drawn <= 30 ms (p95).
"""
import argparse
import os
import resource
import statistics
import subprocess
import sys
import threading
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..'))

from bench_gui_stall import HEAD, LoopWatch, row  # noqa: E402
from support.live_screen import LiveScreen  # noqa: E402
from support.played_cameras import play_cameras  # noqa: E402
from support.ros_system import System  # noqa: E402

NAMES = ['bot{}'.format(number + 1) for number in range(1 if '--short' in sys.argv else 12)]
START_UP = os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', 'support', 'start_up.py')


def start_up(system, *words):
    """Return the time from the start of a process until it can be used, and its CPU [s]."""
    begun, before = time.monotonic(), resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run([sys.executable, START_UP, *words], env=system.env, timeout=120,
                          check=True, stdout=subprocess.PIPE, universal_newlines=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return (float(done.stdout.split()[-1]) - begun,
            after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)


def print_start_up(system, times):
    """Print how long a bare window and the screen take in turn."""
    took = {'bare': [], 'screen': []}
    for _ in range(times):
        for name, words in (('bare', ()), ('screen', NAMES)):
            took[name].append(start_up(system, name, *words))
    for name, measured in took.items():
        print('start until it can be used, {:<6} [s]: {:.2f}, CPU of it all {:.2f} (medians of {})'
              .format(name, *map(statistics.median, zip(*measured)), times), flush=True)


class Screen(LiveScreen):
    """The screen in this process with twelve robots."""

    def __init__(self):
        import psutil
        super().__init__((1920, 1080), NAMES)
        self._process = psutil.Process()
        self.presenter.screen.stage.set_style('one')
        self.presenter.screen.look_at(NAMES[0])
        self.until(lambda: all(self._has_picture(name) for name in NAMES), 'their pictures')

    def _has_picture(self, name):
        return self.presenter.windows[name].view('rgb').picture.frame is not None

    def gaps(self, seconds):
        """Return how long the event loop was blocked [ms], sorted."""
        watch = LoopWatch()
        self.run(seconds)
        self.until(lambda: watch.gaps, 'two turns of the loop')
        return watch.take()

    def cores(self, seconds):
        """Return how much of a core it takes, in all and by the thread that draws."""
        def used():
            here = threading.get_native_id()
            times = self._process.cpu_times()
            own = [thread for thread in self._process.threads() if thread.id == here][0]
            return times.user + times.system, own.user_time + own.system_time, time.monotonic()
        before = used()
        self.run(seconds)
        whole, own, took = (now - then for now, then in zip(used(), before))
        return whole / took, own / took

    def measure(self, title, seconds):
        """Print a line of each."""
        self.run(min(1.0, seconds))
        whole, own = self.cores(seconds)
        print(row(title, self.gaps(seconds)))
        feed = self.operator.feeds(NAMES[0]).get('rgb')
        print('{:<44} {:.2f} of a core, drawing {:.2f}; pictures come at {:.0f} Hz'.format(
            '', whole, own, (feed and feed.status().rate_hz) or 0.0), flush=True)

    def measure_keys(self, count):
        """Print how long keys take until what they do is drawn."""
        from support.key_to_paint import KeyToPaint, SHIFT, SPACE, UP
        screen, keys = self.presenter.screen, KeyToPaint(self.until)
        screen.activateWindow()
        screen.stage.setFocus()
        self.until(screen.isActiveWindow, 'the keyboard')
        self.until(lambda: not self.operator.view().waits_for, 'the mux to be ready')

        button, pushed = screen.stop_bar.stop_button, []
        idle = button.text()
        screen.stick_moved.connect(lambda *axes: pushed.__setitem__(slice(None), axes))

        def release():
            self.until(lambda: self.operator.view().stop_all, 'the stop')
            self.operator.release()
            self.until(lambda: not self.operator.view().stop_all and button.isVisible(),
                       'the release')
        for title, pressed, widgets, is_drawn, restore in (
                ('an arrow key to the stick drawn', (UP,), (screen.joystick,),
                 lambda: any(pushed), lambda: self.until(lambda: not any(pushed), 'the stick')),
                ('Shift+Space to STOPPING drawn', (SHIFT, SPACE), (button, screen.stop_bar),
                 lambda: button.text() != idle or self.operator.view().stop_all, release)):
            took = keys.times(count, pressed, widgets, is_drawn, restore)
            print('{:<44} p50 {:.1f}, p95 {:.1f}, max {:.1f} ms of {}'.format(
                title, took[len(took) // 2], took[int(0.95 * len(took))], took[-1], len(took)),
                flush=True)


def main():
    """Print the figures."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--short', action='store_true', help='one robot, fewer seconds')
    short = parser.parse_args().short
    seconds = 0.5 if short else 15.0
    with System() as system:
        system.screen()
        system.start_master()
        system.node('mux', '__name:=mux')
        import rospy
        for name in NAMES:
            rospy.set_param('/{}/robot_type'.format(name), 'turtlebot2')
        player = play_cameras(system, NAMES, *((1.0, 15) if short else (4.0, 2)), odometry=True)
        if not short:
            start_up(system, 'screen', *NAMES)  # Warms the disk.
        print_start_up(system, 1 if short else 5)
        screen = Screen()
        print(HEAD)
        screen.measure('{} robots, one large, the others thumbnails'.format(len(NAMES)), seconds)
        screen.operator.select(NAMES[:1])
        screen.measure('the same, one of them checked', seconds)
        screen.measure_keys(1 if short else 60)
        screen.presenter.screen.hide()
        screen.measure('nobody can see it', seconds)
        screen.close()
        rospy.signal_shutdown('measured')
        system.kill(player)


if __name__ == '__main__':
    main()
