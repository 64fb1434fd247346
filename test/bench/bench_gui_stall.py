# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""How long the Qt event loop of the panel is blocked: driving four robots, and finding a hundred.

A timer asks to be called every 2 ms; what it is late is the time a click would have waited.
Figures in milliseconds. Promised: never more than 50 ms. "own" is the most that any of them took of
this thread's CPU: the rest was spent waiting for one, where others work on this computer.

The robots' cameras are played from a bag, as they come from robots with computers of their own;
with ``--simulated`` they are drawn on this computer as well, where four of them take most of a
core. "machine" is the CPU of all processes.
"""
import argparse
import os
import sys
import time
import xmlrpc.client

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..'))

from support.live_screen import LiveScreen  # noqa: E402
from support.played_cameras import play_cameras  # noqa: E402
from support.ros_system import System, wait_for  # noqa: E402


NAMES = ['bot{}'.format(number + 1) for number in range(1 if '--short' in sys.argv else 4)]
HEAD = '{:<44} {:>7} {:>7} {:>7} {:>7} {:>7}'.format(
    'Qt event loop blocked [ms]', 'turns', 'p50', 'p99', 'max', 'own')


class LoopWatch:
    """Measures the gaps between the turns of the event loop."""

    def __init__(self):
        from python_qt_binding.QtCore import Qt, QTimer
        self.gaps = []
        self._last = None
        self._timer = QTimer()
        self._timer.setTimerType(Qt.PreciseTimer)
        self._timer.timeout.connect(self._tick)
        self._timer.start(2)

    def _tick(self):
        now, own = time.monotonic(), time.thread_time()
        if self._last is not None:
            self.gaps.append(((now - self._last[0]) * 1e3 - 2.0, (own - self._last[1]) * 1e3))
        self._last = now, own

    def take(self):
        gaps, self.gaps = sorted(self.gaps), []
        return gaps


def row(name, gaps):
    return '{:<44} {:>7} {:>7.2f} {:>7.2f} {:>7.2f} {:>7.2f}'.format(
        name, len(gaps), gaps[len(gaps) // 2][0], gaps[int(0.99 * len(gaps))][0], gaps[-1][0],
        max(own for _, own in gaps))


def register(system, robots, topics, uri):
    """Register robots by hand, all at one address that answers."""
    batch = xmlrpc.client.MultiCall(xmlrpc.client.ServerProxy(system.env['ROS_MASTER_URI']))
    for robot in range(robots):
        for topic in range(topics):
            batch.registerPublisher('/r{:03}/base'.format(robot),
                                    '/r{:03}/topic{}'.format(robot, topic), 'std_msgs/Bool', uri)
    batch()


class Measurement(LiveScreen):
    """A screen in this process with the tiles of four robots, alike."""

    def __init__(self, system, seconds):
        import psutil
        from mhri.screen.presenters.demo import Hands
        super().__init__((1000, 600), selected=NAMES)
        self.system = system
        self._seconds = seconds
        self._used = (psutil.Process().cpu_times, psutil.cpu_times)
        self.until(self._is_ready, 'the mux')
        self._hands = Hands(self.presenter.screen)
        self._watch = LoopWatch()

    def _is_ready(self):
        view = self.operator.view()
        return view.mode is not None and not view.waits_for

    def watch_for(self, seconds):
        """Return the gaps of some seconds, sorted."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            self._app.processEvents()
            time.sleep(0.0002)
        self.until(lambda: self._watch.gaps, 'two turns of the loop')
        return self._watch.take()

    def picture_hz(self, name):
        """Return the rate at which a robot's pictures come."""
        feed = self.operator.feeds(name).get('rgb')
        return feed.status().rate_hz or 0.0 if feed else 0.0

    def used(self):
        """Return by now: the time, the CPU of this process, that of all processes [s]."""
        own, machine = (read() for read in self._used)
        return (time.monotonic(), own.user + own.system,
                sum(machine) - machine.idle - machine.iowait - machine.guest - machine.guest_nice)

    def choose(self, *views):
        """Have just these views in every tile."""
        for tile in self.presenter.windows.values():
            tile.switches.choose(views)

    def drive(self):
        """Print the gaps at rest and while driving."""
        self.presenter.screen.stage.set_style('alike')
        self.choose('imu')
        self.watch_for(0.5)
        print(row('tiles with graphs, at rest', self.watch_for(self._seconds)), flush=True)
        self._hands.hold_stick(0.2, 0.6)
        print(row('tiles with graphs, driving all', self.watch_for(self._seconds)), flush=True)
        self.choose('imu', 'rgb')
        enough_hz = 0.0 if '--short' in sys.argv else 20.0
        self.until(lambda: all(self.picture_hz(name) > enough_hz for name in NAMES), 'pictures')
        self.watch_for(min(2.0, self._seconds))
        begun = self.used()
        gaps = self.watch_for(self._seconds)
        took_s, panel_s, machine_s = (now - then for now, then in zip(self.used(), begun))
        print(row('tiles with graphs and RGB, driving all', gaps))
        print('pictures: {} Hz; CPU: panel {:.0f}, machine {:.0f} of {} %'.format(
            ', '.join('{:.1f}'.format(self.picture_hz(name)) for name in NAMES),
            100.0 * panel_s / took_s, 100.0 * machine_s / took_s, 100 * os.cpu_count()), flush=True)
        self.choose()
        self._hands.let_go()

    def find(self, uri, count):
        """Print the gaps while robots are found and listed."""
        register(self.system, count, 20, uri)
        self.watch_for(0.5)
        begun = time.monotonic()
        self._hands.click('look_button')
        self.until(lambda: self.presenter.screen.look_label.text().startswith('found'),
                   'the answer')
        answered = time.monotonic() - begun
        self.until(lambda: len(self.operator.selection.robots) >= count + len(NAMES),
                   'the robots in the list')
        listed = time.monotonic() - begun
        gaps = self._watch.take() + self.watch_for(min(2.0, self._seconds))
        print(row('finding {} robots with 20 topics each'.format(count), sorted(gaps)))
        print('from the click: answer shown after {:.0f} ms, new rows after {:.0f} ms'.format(
            answered * 1e3, listed * 1e3), flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--short', action='store_true', help='fewer robots and seconds')
    parser.add_argument('--simulated', action='store_true', help='cameras drawn here')
    options = parser.parse_args()
    seconds = 0.5 if options.short else 16.0
    with System() as system:
        system.screen()
        system.start_master()
        system.node('mux', '__name:=mux')
        system.launch('sim.launch', 'n:={}'.format(len(NAMES)))
        import rospy
        import rosgraph
        if not options.simulated:
            master = rosgraph.Master('/bench')
            wait_for(lambda: all(master.getPublishedTopics('/{}/camera'.format(name))
                                 for name in NAMES), 40, 'robots')
            play_cameras(system, NAMES, *((1.0, 15) if options.short else ()))
        measurement = Measurement(system, seconds)
        print(HEAD)
        measurement.drive()
        measurement.find(rospy.get_node_uri(), 10 if options.short else 100)
        measurement.close()
        rospy.signal_shutdown('measured')


if __name__ == '__main__':
    main()
