# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""CPU time per picture: the codecs alone, and a whole camera feed off the network.

Beside each codec, in the same run: ``cv2.imdecode`` of the same picture at full size (for raw,
cv2's conversion alone). Beside the feed: the shortest Python subscriber there can be (rospy and
cv2.imdecode), and for raw pictures the C++ ``image_view``, where it is installed (Debian:
ros-image-view; it has no package for the compressed transports).
"""
import argparse
import os
import sys
import threading
import time

import cv2
import numpy as np
import psutil

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..'))

from mhri.camera.depth_codec import encode_depth  # noqa: E402
from mhri.camera.depth_colour import DepthColour  # noqa: E402
from mhri.camera.image_message import COMPRESSED_TYPE, RAW_TYPE  # noqa: E402
from mhri.camera.ros.pictures import read_picture  # noqa: E402
from mhri.camera.shades import Shades  # noqa: E402
from support.pictures import colour_picture, compressed_message  # noqa: E402
from support.pictures import depth_picture, raw_message  # noqa: E402
from support.ros_system import System, wait_for  # noqa: E402

THUMBNAIL = (160, 120)
RATE_HZ = 30.0
TOPIC = '/bench/camera/rgb/image_raw'
GOALS_MS = {'jpeg': 2.1, 'depth png': 7.0, 'depth rvl': 10.0}

RGB = colour_picture()
MM = depth_picture()
JPEG = cv2.imencode('.jpg', RGB[..., ::-1], [cv2.IMWRITE_JPEG_QUALITY, 80])[1].tobytes()


def times(job, count):
    """Return the sorted CPU times of a job [ms]; the first runs, that fill caches, do not count."""
    found = []
    for number in range(count + 5):
        begun = time.process_time()
        job()
        if number >= 5:
            found.append((time.process_time() - begun) * 1e3)
    return sorted(found)


def codecs():
    """Return rows of (name, what arrives: kind, type, bytes; beside it: name, job)."""
    png = encode_depth(MM, 'png')
    rvl = encode_depth(MM, 'rvl')
    coded = {'jpeg': np.frombuffer(JPEG, np.uint8), 'png': np.frombuffer(png[1][12:], np.uint8)}

    def of_png():
        return cv2.imdecode(coded['png'], cv2.IMREAD_UNCHANGED)

    return (
        ('jpeg', 'rgb', COMPRESSED_TYPE,
         compressed_message('rgb8; jpeg compressed bgr8', JPEG),
         'imdecode', lambda: cv2.imdecode(coded['jpeg'], cv2.IMREAD_COLOR)),
        ('depth png', 'depth', COMPRESSED_TYPE, compressed_message(*png), 'imdecode', of_png),
        ('depth rvl', 'depth', COMPRESSED_TYPE, compressed_message(*rvl), 'imdecode png', of_png),
        ('raw bgr8', 'rgb', RAW_TYPE, raw_message('bgr8', 480, 640, RGB.tobytes(), 1920),
         'cvtColor', lambda: cv2.cvtColor(RGB, cv2.COLOR_BGR2RGB)),
        ('raw 16UC1', 'depth', RAW_TYPE, raw_message('16UC1', 480, 640, MM.tobytes(), 1280),
         'applyColorMap', lambda: cv2.applyColorMap(cv2.convertScaleAbs(MM, alpha=0.04), 4)))


def bench_codecs(count):
    """Print the table of the codecs."""
    print('CPU time per 640 x 480 picture [ms]: decoded, coloured where it is depth, ready to show')
    print('{:<10} {:<9} {:>6} {:>7} {:>7} {:>7}   {:<13} {:>6} {:>6}  {}'.format(
        'picture', 'shown at', 'kB', 'p50', 'p90', 'p99', 'beside', 'p50', 'ratio', 'goal'))
    for name, kind, message_type, data, other_name, other in codecs():
        for view in (None, THUMBNAIL):
            colour = DepthColour() if kind == 'depth' else Shades()
            found = times(lambda: read_picture(kind, message_type, data, view, colour, 0.0), count)
            beside = times(other, count)[count // 2]
            goal = '' if view or name not in GOALS_MS else '<= {} {}'.format(
                GOALS_MS[name], 'met' if found[count // 2] <= GOALS_MS[name] else 'MISSED')
            print('{:<10} {:<9} {:>6.0f} {:>7.2f} {:>7.2f} {:>7.2f}   {:<13} {:>6.2f} {:>6.2f}  {}'
                  .format(name, '{}x{}'.format(*view) if view else 'full', len(data) / 1e3,
                          found[count // 2], found[int(0.9 * count)], found[int(0.99 * count)],
                          other_name, beside, found[count // 2] / beside, goal))


def publish(transport):
    """Be the camera: 640 x 480 at 30 Hz."""
    import rospy
    from sensor_msgs.msg import CompressedImage, Image
    rospy.init_node('bench_camera_' + transport)
    if transport == 'compressed':
        message = CompressedImage(format='rgb8; jpeg compressed bgr8', data=JPEG)
        publisher = rospy.Publisher(TOPIC + '/compressed', CompressedImage, queue_size=1)
    else:
        message = Image(height=480, width=640, encoding='bgr8', step=1920, data=RGB.tobytes())
        publisher = rospy.Publisher(TOPIC, Image, queue_size=1)
    rate = rospy.Rate(RATE_HZ)
    while not rospy.is_shutdown():
        publisher.publish(message)
        rate.sleep()


class Taker:
    """Takes frames at 30 Hz, as a window's timer does, and counts them."""

    def __init__(self, take):
        self.count = 0
        self._take = take
        self._done = threading.Event()
        self._thread = threading.Thread(target=self._run)
        self._thread.start()

    def _run(self):
        while not self._done.wait(1.0 / RATE_HZ):
            self.count += self._take() is not None

    def stop(self):
        self._done.set()
        self._thread.join()


def cpu_per_picture(count, cpu, seconds):
    """Return (pictures per second, CPU time of each [ms]) over some time."""
    first, begun, started = count(), cpu(), time.monotonic()
    threading.Event().wait(seconds)
    pictures = count() - first
    return pictures / (time.monotonic() - started), (cpu() - begun) * 1e3 / max(1, pictures)


def feed(transport, view, seconds):
    """Return the figures of a feed of ours."""
    from mhri.camera.ros.camera_feed import CameraFeed
    camera = CameraFeed('bench', ['camera/rgb/image_raw'], 'rgb', transport)
    camera.set_view(*(view or (None, None)), None if view is None else RATE_HZ)
    camera.open()
    wait_for(camera.take, 20.0, 'a picture')
    taker = Taker(camera.take)
    try:
        return cpu_per_picture(lambda: taker.count, time.process_time, seconds)
    finally:
        taker.stop()
        camera.close(5.0)


def plain_subscriber(transport, seconds):
    """Return the figures of the shortest subscriber in Python."""
    import rospy
    from sensor_msgs.msg import CompressedImage, Image
    shown = []

    def on_compressed(message):
        shown.append(cv2.imdecode(np.frombuffer(message.data, np.uint8), cv2.IMREAD_COLOR).shape)

    def on_raw(message):
        shown.append(np.frombuffer(message.data, np.uint8).reshape(480, 640, 3).copy().shape)

    if transport == 'compressed':
        subscriber = rospy.Subscriber(TOPIC + '/compressed', CompressedImage, on_compressed,
                                      queue_size=1, buff_size=1 << 24)
    else:
        subscriber = rospy.Subscriber(TOPIC, Image, on_raw, queue_size=1, buff_size=1 << 24)
    try:
        wait_for(lambda: shown, 20.0, 'a picture')
        return cpu_per_picture(lambda: len(shown), time.process_time, seconds)
    finally:
        subscriber.unregister()


def image_view(system, seconds):
    """Return the figures of image_view on raw pictures; None where it is not installed."""
    import roslib.packages
    import rospkg
    if 'image_view' not in rospkg.RosPack().list():
        return None
    found = roslib.packages.find_node('image_view', 'image_view')
    system.screen()
    process = system.start(found[0], 'image:=' + TOPIC, '_autosize:=true')
    viewer = psutil.Process(process.pid)

    def used():
        return sum(viewer.cpu_times()[:2])

    try:
        wait_for(lambda: viewer.num_threads() > 4 and used() > 0.2, 20.0, 'image_view to show')
        # It does not tell what it has shown: all that was sent, at the camera's rate.
        begun, started = used(), time.monotonic()
        threading.Event().wait(seconds)
        return RATE_HZ, (used() - begun) * 1e3 / (RATE_HZ * (time.monotonic() - started))
    except (AssertionError, psutil.NoSuchProcess):
        with open(process.log, encoding='utf-8', errors='replace') as log:
            print('image_view did not start: ' + log.read()[-300:])
        return None
    finally:
        system.kill(process)


def bench_feeds(transports, seconds):
    """Print the table of whole feeds."""
    print('\nCPU time per 640 x 480 picture at 30 Hz [ms]: received, decoded, handed to the window')
    print('{:<11} {:<34} {:>6} {:>8} {:>6}'.format('transport', 'by', 'Hz', 'CPU', 'ratio'))
    with System() as system:
        system.start_master()
        import rospy
        rospy.init_node('bench_codecs', disable_signals=True)
        for transport in transports:
            camera = system.start(sys.executable, os.path.abspath(__file__), '--publish', transport)
            ours = feed(transport, None, seconds)
            rows = [('mhri, full size', ours),
                    ('mhri, ' + '{}x{}'.format(*THUMBNAIL), feed(transport, THUMBNAIL, seconds)),
                    ('rospy and cv2 alone, full size', plain_subscriber(transport, seconds))]
            if transport == 'raw':
                rows.append(('image_view (C++), shown', image_view(system, seconds)))
            for name, figures in rows:
                if figures is None:
                    print('{:<11} {:<34} not there'.format(transport, name))
                    continue
                print('{:<11} {:<34} {:>6.1f} {:>8.2f} {:>6.2f}'.format(
                    transport, name, figures[0], figures[1], ours[1] / figures[1]))
            if transport == 'compressed':
                print('goal: full size <= {} ms, {}'.format(
                    GOALS_MS['jpeg'], 'met' if ours[1] <= GOALS_MS['jpeg'] else 'MISSED'))
            system.kill(camera)
        rospy.signal_shutdown('done')


def main():
    """Run what the command line asks for."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--short', action='store_true', help='a few seconds, for the test run')
    parser.add_argument('--publish', metavar='TRANSPORT', help=argparse.SUPPRESS)
    args = parser.parse_args()
    if args.publish:
        publish(args.publish)
        return
    bench_codecs(10 if args.short else 300)
    bench_feeds(*((('compressed',), 0.5) if args.short else (('compressed', 'raw'), 15.0)))


if __name__ == '__main__':
    main()
