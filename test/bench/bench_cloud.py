# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What a point cloud costs: read and drawn at 640 x 480, and a view of it on the screen.

First the CPU of each step for 307,200 points [ms], by layout and colouring, and what five clouds a
second take of a core: goal 0.25. Then how long the GUI thread was away while a view was
given clouds (it only hands them on), and while one was turned by hand as well.
"""
import argparse
import os
import sys
import time

import cv2
import numpy as np

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..'))

from mhri.sensors.cloud_picture import (  # noqa: E402
    CloudArtist, COLOUR, colourings, DISTANCE, HEIGHT, upright_axes)
from mhri.sensors.orbit import fitted  # noqa: E402
from mhri.sensors.point_cloud import from_depth, Lens, parse_cloud, read_cloud  # noqa: E402
from support.clouds import cloud_message, laid_out, room, XYZ  # noqa: E402
from support.xvfb import start_xvfb  # noqa: E402

POINTS, SIZE, RATE_HZ, GOAL_CORES = 307_200, (640, 480), 5.0, 0.25
LAYOUTS = (
    ('xyz', XYZ, {}), ('xyzrgb, as a Kinect', XYZ + (('_', 'f4'), ('rgb', 'u4')), {'gap': 0}),
    ('float64, big endian', (('x', 'f8'), ('y', 'f8'), ('z', 'f8'), ('rgb', 'u4')),
     {'bigendian': True}))


def times(job, count):
    """Return the sorted CPU times of a job [ms]; the first runs, that fill caches, do not count."""
    found = []
    for number in range(count + 2):
        begun = time.process_time()
        job()
        if number >= 2:
            found.append((time.process_time() - begun) * 1e3)
    return sorted(found)


def columns():
    """Return the columns of a room of which a tenth was not measured."""
    found = dict(room(POINTS), _=np.zeros(POINTS))
    found['x'] = np.where(np.random.default_rng(5).random(POINTS) < 0.1, np.nan, found['x'])
    return found


def row(name, read, orbit_of, colouring, count):
    """Print one line of the table; return the cores that it takes."""
    cloud = read()
    artist, orbit = CloudArtist(), orbit_of(cloud)
    reading = times(read, count)
    drawing = times(lambda: artist.draw(cloud, orbit, SIZE, colouring), count)
    middle = count // 2
    cores = (reading[middle] + drawing[middle]) * 1e-3 * RATE_HZ
    print('{:<22} {:<9} {:>8,} {:>6.1f} {:>6.1f} {:>7.1f} {:>6.3f}  {}'.format(
        name, colouring, len(cloud.points), reading[middle], drawing[middle],
        reading[-1] + drawing[-1], cores, 'met' if cores <= GOAL_CORES else 'NOT met'))
    return cores


def steps(count):
    """Print what reading and drawing cost."""
    print('CPU per cloud [ms], {:,} points, drawn at {}x{}; goal: at {:g} Hz <= {:g} cores'.format(
        POINTS, *SIZE, RATE_HZ, GOAL_CORES))
    print('{:<22} {:<9} {:>8} {:>6} {:>6} {:>7} {:>6}'.format(
        'layout', 'colours', 'measured', 'read', 'draw', 'worst', 'cores'))

    def orbit_of(cloud):
        return fitted(cloud.points @ upright_axes(cloud).T)
    for name, kinds, more in LAYOUTS:
        data = cloud_message(*laid_out(columns(), kinds, width=640, **more),
                             more.get('bigendian', False))

        def read(data=data):
            return parse_cloud(read_cloud(data))
        for colouring in (HEIGHT, DISTANCE, COLOUR):
            if colouring in colourings(read()):
                row(name, read, orbit_of, colouring, count)
    depth = np.linspace(1.0, 5.0, POINTS).reshape(480, 640).astype('f4')
    lens = Lens(525.0, 525.0, 319.5, 239.5, 640, 480)
    row('depth picture', lambda: from_depth(depth, lens), orbit_of, HEIGHT, count)


def on_screen(application, seconds, turned):
    """Print how long the GUI thread was away while clouds came, and perhaps were turned."""
    from python_qt_binding.QtCore import Qt, QTimer
    from python_qt_binding.QtTest import QTest
    from mhri.sensors.gui.cloud_view import CloudView
    data = cloud_message(*laid_out(columns(), LAYOUTS[1][1], width=640))
    cloud = parse_cloud(read_cloud(data))
    view, late, drawn = CloudView(), [], []
    view.resize(1280, 960)
    view.drawn.connect(lambda: drawn.append(True))
    view.show()
    clouds, tick, hand = QTimer(), QTimer(), QTimer()
    clouds.timeout.connect(lambda: view.show_value(cloud))
    clouds.start(int(1000 / RATE_HZ))
    if turned:
        hand.timeout.connect(lambda: QTest.keyClick(view.canvas, Qt.Key_Left))
        hand.start(33)
    last = [time.monotonic()]

    def on_tick():
        now = time.monotonic()
        late.append((now - last[0]) * 1e3 - 10.0)
        last[0] = now
    tick.timeout.connect(on_tick)
    tick.start(10)
    begun, used = time.monotonic(), time.process_time()
    QTimer.singleShot(int(1000 * seconds), application.quit)
    application.exec_()
    took = time.monotonic() - begun
    late.sort()
    print('{} at 1280x960: {:.1f} pictures/s, {:.2f} cores in all; GUI thread late p50 {:.1f}, '
          'p99 {:.1f}, worst {:.1f} ms'.format(
              'turned' if turned else 'shown', len(drawn) / took,
              (time.process_time() - used) / took, late[len(late) // 2],
              late[int(0.99 * len(late))], late[-1]))
    for timer in (clouds, tick, hand):
        timer.stop()
    view.close()


def main():
    """Run the benchmark."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--short', action='store_true', help='fewer clouds')
    options = parser.parse_args()
    cv2.setNumThreads(1)
    steps(8 if options.short else 60)
    server = None
    if not os.environ.get('DISPLAY'):
        server, os.environ['DISPLAY'] = start_xvfb('1600x1200x24')
    try:
        from python_qt_binding.QtWidgets import QApplication
        # One for both: a screen that its last client leaves may end.
        application = QApplication(['bench', '-style', 'Fusion'])
        for turned in (False, True):
            on_screen(application, 3.0 if options.short else 15.0, turned)
    finally:
        if server is not None:
            server.terminate()


if __name__ == '__main__':
    main()
