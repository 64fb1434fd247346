# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A screen without widgets in a process of its own: it does a line of words, and shows its view.

Words: ``add NAME``, ``select NAME...``, ``take``, ``stop``, ``stick FORWARD TURN``, ``hang S`` (the
thread of the operator's hands stands still for so long), ``end``.
"""
import json
import queue
import sys
import threading
import time

from mhri.screen.ros.backend import ScreenBackend

LEASE_S = 0.5


def shown(operator):
    """Return the view as plain values."""
    view = operator.view()
    return json.dumps({
        'ros': view.ros, 'stop_all': view.stop_all, 'stop_taken': view.stop_taken,
        'answers': view.answers, 'ours': view.control.ours, 'who': view.control.words,
        'selected': list(operator.selection.selected), 'status': view.status,
        'robots': {robot.name: [robot.driven, robot.stands, robot.note] for robot in view.robots}})


def carry_out(operator, word, *words):
    """Do one line."""
    {'add': lambda: operator.add(*words), 'select': lambda: operator.select(words),
     'take': operator.take_control, 'stop': operator.stop_all,
     'limits': lambda: operator.request_limits(*map(float, words)),
     'brake': lambda: operator.brake(words[0] == 'on'),
     'stick': lambda: operator.send_stick(*map(float, words)),
     'hang': lambda: time.sleep(float(words[0]))}[word]()


def main():
    """Run until ``end``."""
    operator = ScreenBackend(sys.argv)
    operator.start()
    due, told, lines = 0.0, None, queue.Queue()
    threading.Thread(target=lambda: [lines.put(line.split()) for line in sys.stdin],
                     daemon=True).start()
    while True:
        try:
            words = lines.get(timeout=0.02)
        except queue.Empty:
            words = ()
        if words == ['end']:
            break
        if words:
            carry_out(operator, *words)
        if time.monotonic() >= due:
            due = time.monotonic() + LEASE_S
            operator.repeat_selection()
        now = shown(operator)
        if now != told:
            told = now
            print(now, flush=True)
    operator.close()


if __name__ == '__main__':
    main()
