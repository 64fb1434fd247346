# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What a frame of the simulated camera costs, and what streaming does to the robot beside it.

First the CPU of each step [ms] on one core, along a drive through the building past two robots.
Then a robot's 100 Hz loop and its camera share a process, as in ``sim_robot``: how late its steps
are [ms] while nobody looks, and while another process receives pictures. Goal: at most 5 ms of CPU
for an RGB frame with its jpeg.
"""
import argparse
import json
import math
import os
import subprocess
import sys
import threading
import time

import cv2
import numpy as np
import psutil

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..'))

from mhri.base.robot_types import Limits, RobotType  # noqa: E402
from mhri.camera.depth_codec import encode_depth  # noqa: E402
from mhri.graph.ros.resources import read_text, resource_path  # noqa: E402
from mhri.sim.camera import Camera  # noqa: E402
from support.ros_system import System, wait_for  # noqa: E402

GOAL_MS = 5.0
STEP_S = 0.01
RGB, DEPTH = 'camera/rgb/image_raw', 'camera/depth_registered/image_raw'
STREAMS = (('nobody looks', ()), ('jpeg', (RGB + '/compressed',)),
           ('jpeg and depth', (RGB + '/compressed', DEPTH + '/compressedDepth')),
           ('raw RGB', (RGB,)))
TEMPLATE = RobotType('bench', 'bench', 'turtlebot', Limits(1.0, 1.0), rgb=(RGB,), depth=(DEPTH,))


def lab():
    """Return the plan that is shipped."""
    from mhri.sim.plan import parse_plan
    path = resource_path('sim', 'plan.yaml')
    return parse_plan(read_text(path), path)


def others():
    """Return two robots that stand in the hall."""
    rows = np.zeros(2, [('x', '<f8'), ('y', '<f8'), ('radius', '<f8'), ('height', '<f8'),
                        ('colour', 'u1', 3)])
    rows[0] = (7.3, 1.9, 0.177, 0.42, (60, 60, 64))
    rows[1] = (7.6, 2.6, 0.105, 0.192, (40, 40, 44))
    return rows


def place(share):
    """Return the pose at some share of a drive around the hall."""
    angle = 2.0 * math.pi * share
    return 6.0 + 4.0 * math.cos(angle), 2.1 + 1.5 * math.sin(angle), 3.0 * angle


def steps(frames):
    """Return {step: CPU of each frame [ms]}."""
    from mhri.sim.ros.camera_node import compress
    camera, bodies = Camera(lab()), others()
    camera.rgb(camera.look(*place(0.0), bodies))
    spent = {}

    def timed(name, function, *arguments):
        begun = time.process_time()
        value = function(*arguments)
        spent.setdefault(name, []).append((time.process_time() - begun) * 1e3)
        return value
    for frame in range(frames):
        view = timed('rays', camera.look, *place(frame / frames), bodies)
        rgb = timed('draw RGB', camera.rgb, view)
        timed('jpeg', compress, rgb)
        depth = timed('draw depth', camera.depth, view)
        timed('depth png', encode_depth, depth, 'png')
        timed('depth rvl', encode_depth, depth, 'rvl')
    for name, parts in (('RGB frame with jpeg', ('rays', 'draw RGB', 'jpeg')),
                        ('depth frame with png', ('rays', 'draw depth', 'depth png')),
                        ('depth frame with rvl', ('rays', 'draw depth', 'depth rvl'))):
        spent[name] = [sum(values) for values in zip(*(spent[part] for part in parts))]
    return spent


def at(values, share):
    """Return the value below which a share of the values lies."""
    return sorted(values)[min(len(values) - 1, int(share * len(values)))]


def be_robot():
    """Step at 100 Hz beside a camera; for each line read, print the lateness of the steps since."""
    import rospy
    from mhri.sim.ros.camera_node import SimCamera
    rospy.init_node('bench_robot', disable_signals=True)
    begun = time.monotonic()
    bodies = others()
    SimCamera('bench', TEMPLATE, lab(), lambda: place((time.monotonic() - begun) / 30.0),
              lambda: bodies).start()
    late = []

    def answer():
        for _ in sys.stdin:
            found = late[:]
            late.clear()
            print(json.dumps(found), flush=True)
        os._exit(0)
    threading.Thread(target=answer, daemon=True).start()
    due = time.monotonic()
    while True:
        # About the work of a step of the simulated robot without its messages.
        sum(math.sin(number) for number in range(2000))
        due += STEP_S
        time.sleep(max(0.0, due - time.monotonic()))
        late.append((time.monotonic() - due) * 1e3)
        due = max(due, time.monotonic() - 0.1)


class Robot:
    """The process of :func:`be_robot`."""

    def __init__(self, env):
        self._process = subprocess.Popen(
            [sys.executable, os.path.abspath(__file__), '--robot'], env=env, text=True,
            stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        self.usage = psutil.Process(self._process.pid)

    def late(self):
        """Return how late the steps since the last call were [ms]."""
        self._process.stdin.write('\n')
        self._process.stdin.flush()
        return json.loads(self._process.stdout.readline())

    def close(self):
        self._process.stdin.close()
        self._process.wait(10)


def streaming(seconds):
    """Print the lateness of the loop for each set of streams."""
    print('{:<22} {:>7} {:>8} {:>8} {:>8} {:>8}'.format(
        '100 Hz loop late [ms]', 'median', 'p99', 'worst', 'CPU [%]', 'Hz'))
    with System() as system:
        system.start_master()
        import rospy
        rospy.init_node('bench_sim_camera', disable_signals=True)
        robot = Robot(system.env)
        counts = []
        for title, topics in STREAMS:
            counts = [0] * len(topics)

            def count(_, index, counts=counts):
                counts[index] += 1
            heard = [rospy.Subscriber('/bench/' + topic, rospy.AnyMsg, count, callback_args=index,
                                      queue_size=2, buff_size=2 ** 24, tcp_nodelay=True)
                     for index, topic in enumerate(topics)]
            wait_for(lambda counts=counts: all(counts), 30.0, 'the pictures')
            robot.late()
            begun, used, before = time.monotonic(), robot.usage.cpu_times(), list(counts)
            time.sleep(seconds)
            late, after = robot.late(), robot.usage.cpu_times()
            took = time.monotonic() - begun
            cpu = 100.0 * (after.user + after.system - used.user - used.system) / took
            print('{:<22} {:>7.2f} {:>8.2f} {:>8.2f} {:>8.1f} {:>8}'.format(
                title, at(late, 0.5), at(late, 0.99), max(late), cpu, ', '.join(
                    '{:.1f}'.format((new - old) / took) for new, old in zip(counts, before))))
            for subscriber in heard:
                subscriber.unregister()
        robot.close()
        rospy.signal_shutdown('measured')


def main():
    """Run the benchmark, or be its robot."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--short', action='store_true', help='fewer frames and seconds')
    parser.add_argument('--robot', action='store_true', help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.robot:
        be_robot()
        return
    cv2.setNumThreads(1)
    spent = steps(50 if options.short else 600)
    print('{:<22} {:>7} {:>8}'.format('CPU per frame [ms]', 'median', 'p99'))
    for name, values in spent.items():
        print('{:<22} {:>7.2f} {:>8.2f}'.format(name, at(values, 0.5), at(values, 0.99)))
    median = at(spent['RGB frame with jpeg'], 0.5)
    print('goal: RGB frame with jpeg <= {:g} ms: {}'.format(
        GOAL_MS, 'met' if median <= GOAL_MS else 'NOT met'))
    streaming(2.0 if options.short else 15.0)
    sys.stdout.flush()


if __name__ == '__main__':
    main()
