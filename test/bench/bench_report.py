# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""How long the report of a session takes, without the film: one hour, four robots.

The session is made: a bag a minute, as a recording has them. Goal: 60 s at most. It writes about
1 GB, at the rates of real robots; with ``--short`` far less. ``--fastest`` is every sensor at its
full rate, pictures of 10 kB at 30 Hz (6 GB); ``--film`` five minutes of that, with pictures of
640x480 (2 GB), and a film of them.
"""
import argparse
import os
import sys
import tempfile
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..'))

import cv2  # noqa: E402
import numpy as np  # noqa: E402

from mhri.nodes import mhri_report  # noqa: E402
from mhri.recording.folder import (  # noqa: E402
    bag_name, event_line, EVENTS_JSONL, info_text, SESSION_YAML, SessionEvent, SessionInfo)
from support import made_session as made  # noqa: E402

ROBOTS = tuple('bot{}'.format(number + 1) for number in range(4))
SHORT = {'odom': 1.0}
FULL = {'odom': 20.0, 'imu': 50.0, 'scan': 5.0, 'camera/rgb/image_raw/compressed': 5.0}
FASTEST = {'odom': 50.0, 'imu': 100.0, 'scan': 10.0, 'camera/rgb/image_raw/compressed': 30.0}
FILM_MIN = 5


def picture():
    """Return a jpeg of 640x480 that is about as large as those of a camera."""
    noise = np.random.default_rng(1).normal(0.0, 6.0, (480, 640, 3))
    slope = np.linspace(30.0, 220.0, 640)[None, :, None]
    return cv2.imencode('.jpg', np.clip(slope + noise, 0, 255).astype(np.uint8),
                        [cv2.IMWRITE_JPEG_QUALITY, 80])[1].tobytes()


def write(folder, minutes, rates_hz, jpeg=bytes(10000)):
    """Write the session, with a mark and a stop each minute; return its messages."""
    count, events = 0, []
    for number in range(minutes):
        rows = made.hour_rows(60.0 * number, 60.0 * (number + 1), ROBOTS, rates_hz, jpeg)
        made.write_bag(os.path.join(folder, bag_name(number)), rows)
        count += len(rows)
        for after_s, kind, text in ((10.0, 'mark', 'mark'), (20.0, 'stop', 'STOP ALL'),
                                    (25.0, 'stop', 'STOP ALL released')):
            at = made.STARTED + 60.0 * number + after_s
            data = {'id': 'm{}'.format(number + 1)} if kind == 'mark' else {}
            events.append(SessionEvent(at, at, kind, text, data=data))
    robots = {robot: {'number': number, 'type': 'turtlebot3', 'topics': {}}
              for number, robot in enumerate(ROBOTS, 1)}
    for name, text in ((EVENTS_JSONL, ''.join(map(event_line, events))),
                       (SESSION_YAML, info_text(SessionInfo(made.STARTED, robots=robots)))):
        with open(os.path.join(folder, name), 'w', encoding='utf-8') as stream:
            stream.write(text)
    return count


def main():
    """Measure, and print it."""
    parser = argparse.ArgumentParser(description=__doc__.split('\n')[0])
    parser.add_argument('--short', action='store_true', help='few minutes and messages')
    parser.add_argument('--fastest', action='store_true', help='every sensor at its full rate')
    parser.add_argument('--minutes', type=int,
                        help='how long it is [min]: 60; with its film or short 5')
    parser.add_argument('--film', action='store_true', help='at full rates, with a film')
    options = parser.parse_args()
    minutes = options.minutes or (FILM_MIN if options.film or options.short else 60)
    rates_hz = FASTEST if options.film or options.fastest else SHORT if options.short else FULL
    pictures = [picture()] if options.film else []
    with tempfile.TemporaryDirectory(prefix='mhri_bench_') as folder:
        session = os.path.join(folder, 'session')
        os.mkdir(session)
        begun = time.monotonic()
        count = write(session, minutes, rates_hz, *pictures)
        print('{} messages of {} min written in {:.1f} s'.format(
            count, minutes, time.monotonic() - begun), flush=True)
        begun = time.monotonic()
        mhri_report.make(mhri_report.parse([
            session, '--output', os.path.join(folder, 'report'),
            *(['--film'] if options.film else [])]))
        print('MEASURED report of a session of {} min with {} robots, {} the film: {:.1f} s'
              .format(minutes, len(ROBOTS), 'with' if options.film else 'without',
                      time.monotonic() - begun))


if __name__ == '__main__':
    main()
