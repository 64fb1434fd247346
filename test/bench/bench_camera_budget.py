# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The cameras of 12 robots, 640x480 at 30 Hz, with and without a camera budget of 20 Mbit/s.

One robot is driven, one looked at, ten are thumbnails. Side by side: what each class takes of the
network as its feeds count it, what the loopback device carries in all (where this may have one of
its own), pictures decoded a second, and the CPU of this program and of the one that sends. In a
last case only the driven one can be seen.
"""
import argparse
import os
import shutil
import subprocess
import sys
import time

import psutil

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..'))

from support.played_cameras import play_cameras, TOPIC  # noqa: E402
from support.ros_system import System, wait_for  # noqa: E402

NAMES = ['bot{}'.format(number) for number in range(1, 13)]
BUDGET_MBIT_S = 20.0
LARGE, SMALL = (1440, 1080), (320, 240)
DRAW_S = 0.05
NETWORK = 'MHRI_BENCH_OWN_NETWORK'


def in_own_network():
    """Run this again where the loopback device carries nothing else; return where not possible."""
    own = ['unshare', '--map-root-user', '--net', 'sh', '-c', 'ip link set lo up && exec "$@"',
           'sh']
    if NETWORK in os.environ or not shutil.which('unshare') or subprocess.run(
            own + ['true'], stderr=subprocess.DEVNULL).returncode:
        return
    os.environ[NETWORK] = '1'
    os.execvp(own[0], own + [sys.executable] + sys.argv)


def cpu_s(process):
    """Return the CPU that a process has used [s]."""
    times = process.cpu_times()
    return times.user + times.system


def carried():
    """Return the bytes that the loopback device has carried."""
    return psutil.net_io_counters(pernic=True)['lo'].bytes_sent


class Screen:
    """The pictures of all robots, taken as a screen takes them, without the screen.

    :param budget_mbit_s: 0 for none
    :param visible: the robots whose pictures can be seen
    """

    def __init__(self, budget_mbit_s, visible):
        from mhri.camera.budget import DRIVEN, LOOKED_AT, REST
        from mhri.camera.ros.camera_budget import CameraBudget, Wish
        from mhri.camera.ros.camera_feed import CameraFeed
        from mhri.screen.settings import PanelSettings
        settings = PanelSettings(camera_budget_mbit_s=budget_mbit_s)
        self.budget = CameraBudget(lambda: settings)
        self.wishes = [
            Wish(name, importance, CameraFeed(name, [TOPIC], 'rgb'), name in visible)
            for name, importance in zip(NAMES, [DRIVEN, LOOKED_AT] + [REST] * 10)]
        self.budget.settle(self.wishes)
        for wish in self.wishes:
            wish.feed.set_view(*(SMALL if wish.importance == REST else LARGE))
            wish.feed.open()
        self.taken = dict.fromkeys(NAMES, 0)

    def draw(self, seconds):
        """Take pictures for so long."""
        until = time.monotonic() + seconds
        while time.monotonic() < until:
            for wish in self.wishes:
                self.taken[wish.robot] += wish.feed.take() is not None
            self.budget.settle(self.wishes)
            time.sleep(DRAW_S / 3.0)

    def close(self):
        """Give every topic back."""
        for wish in self.wishes:
            wish.feed.close(5.0)


def measure(title, screen, player, settle_s, seconds):
    """Measure for some seconds; return {row: text}."""
    screen.draw(settle_s)
    me = psutil.Process()
    screen.taken = dict.fromkeys(NAMES, 0)
    before = cpu_s(me), cpu_s(player), carried()
    bits, looks, begun = dict.fromkeys(NAMES, 0.0), 0, time.monotonic()
    while time.monotonic() - begun < seconds:
        screen.draw(0.5)
        looks += 1
        for wish in screen.wishes:
            bits[wish.robot] += wish.feed.status().bits_per_s
    took = time.monotonic() - begun
    after = cpu_s(me), cpu_s(player), carried()
    rows = {'': title}
    for kind, names in (('driven', NAMES[:1]), ('looked at', NAMES[1:2]),
                        ('thumbnails', NAMES[2:])):
        rows[kind + ' [Mbit/s]'] = '{:.1f}'.format(sum(bits[name] for name in names) / looks / 1e6)
        rows[kind + ' [pictures/s each]'] = '{:.1f}'.format(
            sum(screen.taken[name] for name in names) / took / len(names))
    rows['pictures together [Mbit/s]'] = '{:.1f}'.format(sum(bits.values()) / looks / 1e6)
    rows['loopback in all [Mbit/s]'] = '{:.1f}'.format(
        8e-6 * (after[2] - before[2]) / took) if NETWORK in os.environ else 'not alone on it'
    rows['decoded [pictures/s]'] = '{:.0f}'.format(sum(screen.taken.values()) / took)
    rows['CPU here [% of a core]'] = '{:.0f}'.format(100.0 * (after[0] - before[0]) / took)
    rows['CPU of the sender'] = '{:.0f}'.format(100.0 * (after[1] - before[1]) / took)
    return rows


def main():
    """Print the cases side by side."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--short', action='store_true', help='fewer seconds')
    short = parser.parse_args().short
    in_own_network()
    seconds, settle_s = (1.5, 1.5) if short else (20.0, 10.0)
    with System() as system:
        system.start_master()
        import rospy
        rospy.init_node('bench', disable_signals=True)
        player = psutil.Process(
            play_cameras(system, NAMES, *((1.0, 30) if short else (4.0, 6))).pid)
        master = rospy.get_master()
        wait_for(lambda: len([topic for topic, _ in master.getPublishedTopics('/')[2]
                              if TOPIC in topic]) == len(NAMES), 60.0, 'the cameras', 0.2)
        player = (player.children(recursive=True) or [player])[-1]
        columns = []
        for title, budget, visible in (('no budget', 0.0, NAMES),
                                       ('{:g} Mbit/s'.format(BUDGET_MBIT_S), BUDGET_MBIT_S, NAMES),
                                       ('one seen', BUDGET_MBIT_S, NAMES[:1])):
            screen = Screen(budget, visible)
            columns.append(measure(title, screen, player, settle_s, seconds))
            print('{}: {}'.format(title, '; '.join(
                '{} {}'.format(name, grant.words) for name, grant in
                screen.budget.settle(screen.wishes).items() if grant.words) or 'all as wished'),
                flush=True)
            screen.close()
        print()
        for row in columns[0]:
            print('{:<30}'.format(row) + ''.join('{:>17}'.format(one[row]) for one in columns))
        rospy.signal_shutdown('measured')


if __name__ == '__main__':
    main()
