# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Three simulated robots stream RGB (640x480, 30 Hz) beside the panel that shows all three.

In turn: the robots alone; the panel with three windows and their graphs; the same with RGB. Of each
the rate of every camera, the CPU of every process [% of a core], and how even the odometry is (50
Hz: the interval at the receiver [ms]). What a picture costs [ms of CPU] is the difference, at the
robot (draw, jpeg, send) and in the panel (receive, decode, draw).
"""
import argparse
import json
import os
import sys
import threading
import time

import psutil

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..'))

from support.ros_system import System, wait_for  # noqa: E402

NAMES = ('bot1', 'bot2', 'bot3')[:1 if '--short' in sys.argv else 3]
START_S = 60.0
RGB = 'camera/rgb/image_raw/compressed'
ODOMETRY_HZ, CAMERA_HZ = 50.0, 30.0


class Ear:
    """The times of receipt [s] of one topic."""

    def __init__(self, topic):
        import rospy
        self._lock = threading.Lock()
        self._times = []
        self._subscriber = rospy.Subscriber(topic, rospy.AnyMsg, self._hear, tcp_nodelay=True)

    def _hear(self, _):
        with self._lock:
            self._times.append(time.monotonic())

    def take(self):
        """Return the times since the last call."""
        with self._lock:
            times, self._times = self._times, []
            return times


def at(values, share):
    """Return the value below which a share of the values lies."""
    return sorted(values)[min(len(values) - 1, int(share * len(values)))]


def robots_of(system):
    """Return {name: process} of the simulated robots."""
    found = {}
    for process in psutil.process_iter(['cmdline']):
        words = process.info['cmdline'] or ()
        if any(word.endswith('/sim_robot') for word in words):
            env = process.environ()
            if env.get('ROS_MASTER_URI') == system.env['ROS_MASTER_URI']:
                found[env['ROS_NAMESPACE'].strip('/')] = process
    return found


def cpu_s(process):
    """Return the CPU that a process has used [s]."""
    times = process.cpu_times()
    return times.user + times.system


def busy_s():
    """Return the CPU that all processes of the machine have used, these or others [s]."""
    times = psutil.cpu_times()
    return sum(times) - times.idle - times.iowait - times.guest - times.guest_nice


def others_of(*started):
    """Return {name: process} of what runs beside the robots: the screen, and what was started."""
    screen = next(process for process in psutil.Process().children() if process.name() == 'Xvfb')
    found = {'screen': screen, 'bench': psutil.Process()}
    for name, popen in started:
        found[name] = psutil.Process(popen.pid)
    return found


class Measurement:
    """What is measured in each case, side by side."""

    def __init__(self, system, seconds):
        self._seconds = seconds
        self._odometry = {name: Ear('/{}/odom'.format(name)) for name in NAMES}
        # One of these comes with every turn of a camera, drawn or not, and costs next to nothing.
        self._camera = {name: Ear('/{}/camera/rgb/camera_info'.format(name)) for name in NAMES}
        ears = [*self._odometry.values(), *self._camera.values()]
        wait_for(lambda: all(ear.take() for ear in ears) or None, START_S, 'the robots', 0.5)
        self.robots = wait_for(lambda: len(robots_of(system)) == len(NAMES) and robots_of(system),
                               START_S, 'the processes of the robots', 0.5)

    def take(self, title, others):
        """Measure for some seconds, print it, and return {process: CPU [% of a core]}.

        :param others: {name: process} besides the robots
        """
        processes = dict(self.robots, **others)
        for ear in (*self._odometry.values(), *self._camera.values()):
            ear.take()
        begun, busy = time.monotonic(), busy_s()
        before = {key: cpu_s(one) for key, one in processes.items()}
        time.sleep(self._seconds)
        took = time.monotonic() - begun
        used = {key: 100.0 * (cpu_s(one) - before[key]) / took for key, one in processes.items()}
        print('\n{}\n{:<9} {:>8} {:>10} {:>8} {:>8} {:>8} {:>8}'.format(
            title, '', 'CPU [%]', 'camera Hz', 'odom Hz', 'p50 ms', 'p99 ms', 'max ms'))
        self.rates = {}
        for name in NAMES:
            times = self._odometry[name].take()
            gaps = [(late - early) * 1e3 for early, late in zip(times, times[1:])]
            self.rates[name] = len(self._camera[name].take()) / took
            print('{:<9} {:>8.1f} {:>10.1f} {:>8.1f} {:>8.2f} {:>8.2f} {:>8.2f}'.format(
                name, used[name], self.rates[name], len(times) / took, at(gaps, 0.5),
                at(gaps, 0.99), max(gaps)))
        for name in others:
            print('{:<9} {:>8.1f}'.format(name, used[name]))
        print('{:<9} {:>8.1f}   of {} %; the whole machine {:.1f}'.format(
            'together', sum(used.values()), 100 * psutil.cpu_count(),
            100.0 * (busy_s() - busy) / took), flush=True)
        return used


def panel_with(system, views):
    """Start the panel with a window for each robot that shows these views; wait until it does."""
    import rosgraph
    path = os.path.join(system.home, 'panel_{}.json'.format('_'.join(views)))
    with open(path, 'w') as stream:
        json.dump({'state': {'looks': {name: {'views': views} for name in NAMES}}}, stream)
    panel = system.node('panel', '--settings', path, '--select', ' '.join(NAMES))
    master = rosgraph.Master('/bench')
    topics = {'/{}/{}'.format(name, RGB) for name in NAMES} if 'rgb' in views else set()
    topics |= {'/{}/odom'.format(name) for name in NAMES}

    def shown():
        heard = dict(master.getSystemState()[1])
        return all('/mhri_panel' in heard.get(topic, ()) for topic in topics)
    wait_for(shown, START_S, 'the windows', 0.2)
    time.sleep(2.0)  # the first drawing of the windows is not what is measured here
    return panel


def per_frame(more, rate_hz):
    """Return CPU in % of a core as ms for each of so many frames a second."""
    return 10.0 * more / rate_hz


def main():
    """Print a table for each case, and the cost of a picture."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--short', action='store_true', help='one robot, fewer seconds')
    seconds = 1.5 if parser.parse_args().short else 30.0
    with System() as system:
        system.screen()
        system.start_master()
        import rospy
        rospy.init_node('bench', disable_signals=True)
        mux, gates = system.node('mux', '__name:=mux'), system.node('gates')
        system.launch('sim.launch', 'n:={}'.format(len(NAMES)))
        measurement = Measurement(system, seconds)
        alone = measurement.take('the robots alone', others_of(('mux', mux), ('gates', gates)))
        panel = panel_with(system, ['imu'])
        graphs = measurement.take('three windows with graphs', others_of(
            ('mux', mux), ('gates', gates), ('panel', panel)))
        panel.terminate()
        panel.wait(20)
        panel = panel_with(system, ['imu', 'rgb'])
        streams = measurement.take('three windows with graphs and RGB', others_of(
            ('mux', mux), ('gates', gates), ('panel', panel)))
        rates = measurement.rates
        robot = [per_frame(streams[name] - alone[name], rates[name]) for name in NAMES]
        shown = per_frame(streams['panel'] - graphs['panel'], sum(rates.values()))
        print('\nCPU of a picture [ms]: at its robot {}; in the panel {:.2f} (goal 2.1)'.format(
            ', '.join('{:.2f}'.format(one) for one in robot), shown))
        print('three cameras at {:g} Hz beside the panel: {} ({})'.format(
            CAMERA_HZ, 'yes' if min(rates.values()) > 0.95 * CAMERA_HZ else 'NO',
            ', '.join('{:.1f}'.format(rates[name]) for name in NAMES)), flush=True)
        rospy.signal_shutdown('measured')


if __name__ == '__main__':
    main()
