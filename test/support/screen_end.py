# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The end of a test at a screen in a process of its own (screen_process.py)."""
import json
import os
import subprocess
import sys
import threading

from support.ros_system import wait_for

START_S = 60.0
_PROCESS = os.path.join(os.path.dirname(os.path.realpath(__file__)), 'screen_process.py')


class Screen:
    """A screen in a process of its own, and what it shows."""

    def __init__(self, name):
        self.name = '/' + name
        self.shown = {}
        self._process = subprocess.Popen(
            [sys.executable, _PROCESS, '__name:=' + name], stdin=subprocess.PIPE,
            stdout=subprocess.PIPE, universal_newlines=True, bufsize=1)
        threading.Thread(target=self._read, daemon=True).start()

    def _read(self):
        for line in self._process.stdout:
            if line.startswith('{'):
                self.shown = json.loads(line)

    def do(self, *words):
        self._process.stdin.write(' '.join(words) + '\n')
        self._process.stdin.flush()

    def wait(self, what, condition):
        wait_for(lambda: self.shown and condition(self.shown), START_S,
                 lambda: '{} to show {}, not {}'.format(self.name, what, self.shown))

    def kill(self):
        self._process.kill()
        self._process.wait()

    def end(self):
        if self._process.poll() is None:
            self.do('end')
            self._process.wait(START_S)
