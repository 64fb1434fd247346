# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The panel without a screen: its backend, asked for its view 20 times a second, to be attacked.

``backend_process.py LOG``; a line of the standard input is ``select NAME...``,
``take``, ``mode SOURCE``, ``stick FORWARD TURN``, ``view ROBOT KEY...`` or
``limits LINEAR ANGULAR``. A line of the log is: when [s, CLOCK_MONOTONIC], how long one round took
[s], events, (status, mode, stop_all). "loaded" is said once a robot has its feeds.
"""
import sys
import threading
import time

from mhri.screen.ros.backend import ScreenBackend


def main():
    """Run until the standard input is closed."""
    backend = ScreenBackend()
    backend.start()
    orders, done = [], threading.Event()

    def read():
        for line in sys.stdin:
            orders.append(line.split())
        done.set()

    threading.Thread(target=read, daemon=True).start()
    repeat_at, loaded = 0.0, False
    with open(sys.argv[1], 'a', buffering=1) as log:
        while not done.wait(0.05):
            begun = time.monotonic()
            while orders:
                obey(backend, *orders.pop(0))
            if begun >= repeat_at:
                backend.repeat_selection()
                repeat_at = begun + 0.5
            events, view = backend.take_events(), backend.view()
            if not loaded and any(backend.feeds(robot.name) for robot in view.robots):
                loaded = True
                print('loaded', flush=True)
            log.write('{!r} {:.4f} {} {!r}\n'.format(
                begun, time.monotonic() - begun, len(events),
                (view.status, view.mode, view.stop_all)))
    backend.close()


def obey(backend, word, *names):
    """Do what one line says."""
    if word == 'take':
        backend.take_control()
    elif word == 'mode':
        backend.request_mode(*names)
    elif word == 'stick':
        backend.send_stick(*map(float, names))
    elif word == 'view':
        backend.feeds(names[0]).request(names[1:])
    elif word == 'limits':
        backend.request_limits(*map(float, names))
    else:
        for name in names:
            backend.add(name)
        backend.select(names)


if __name__ == '__main__':
    main()
