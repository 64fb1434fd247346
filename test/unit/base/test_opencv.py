# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""An interrupt that comes while OpenCV is loaded ends the program all the same."""
import os
from pathlib import Path
import re
import signal
import subprocess
import sys

import pytest

SOURCES = Path(__file__).resolve().parents[3] / 'src'
# As OpenCV's own code does where numpy is loaded already.
SWALLOWS = '''import os
import signal
try:
    os.kill(os.getpid(), signal.SIGINT)
    for _ in range(1000):
        pass
except KeyboardInterrupt:
    pass
COLOR = 1
'''


def loading(folder, code):
    """Return (status, output) of a program that loads an OpenCV which swallows an interrupt."""
    (folder / 'cv2.py').write_text(SWALLOWS)
    environment = dict(os.environ, PYTHONPATH=os.pathsep.join((str(folder), str(SOURCES))))
    done = subprocess.run(
        [sys.executable, '-c', code], env=environment, stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT, universal_newlines=True, timeout=60,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler))
    return done.returncode, done.stdout


@pytest.mark.parametrize('code, ends', [
    ('import cv2; print(cv2.COLOR)', False),
    ('from mhri.base.opencv import cv2; print(cv2.COLOR)', True)])
def test_an_interrupt_is_not_lost(tmp_path, code, ends):
    status, output = loading(tmp_path, code)
    assert ('KeyboardInterrupt' in output) == ends, output
    assert (status, output) == (0, '1\n') or ends and status == -signal.SIGINT


def test_another_thread_may_load_it(tmp_path):
    # A handler that raises could do so within join, which Python 3.8 may then wait in for ever
    # (bpo-45274).
    status, output = loading(
        tmp_path, 'import signal, threading, mhri.base\n'
        'signal.signal(signal.SIGINT, lambda *_: print("interrupted"))\n'
        'thread = threading.Thread(target=lambda: print(\n'
        '    __import__("mhri.base.opencv", fromlist=["cv2"]).cv2.COLOR))\n'
        'thread.start()\nthread.join()\n')
    assert status == 0 and '1' in output and 'interrupted' in output, output


def test_nobody_loads_it_otherwise():
    others = [path.name for path in SOURCES.rglob('*.py')
              if re.search(r'^\s*(import|from) cv2\b', path.read_text(), re.M)]
    assert others == ['opencv.py']
