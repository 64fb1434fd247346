# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Ctrl-C, or an end by roslaunch, while a program is still being loaded: no traceback."""
import os
from pathlib import Path
import signal
import subprocess
import sys

import pytest

TOP = Path(__file__).resolve().parents[3]
PROGRAMS = sorted((TOP / 'scripts').iterdir()) + [TOP / 'utils' / 'remote' / 'mhri_guard']
# What is loaded early sends the signal, in the middle of the imports.
TRAP = 'import os, time\nos.kill(os.getpid(), {})\ntime.sleep(30.0)\n'


@pytest.mark.parametrize('program', PROGRAMS, ids=lambda path: path.name)
def test_it_ends_without_a_traceback(tmp_path, program):
    # Every program imports the same that handles them.
    number = (signal.SIGINT, signal.SIGTERM)[PROGRAMS.index(program) % 2]
    for name in ('rospy', 'rospkg', 'rosgraph'):
        (tmp_path / (name + '.py')).write_text(TRAP.format(int(number)))
    done = subprocess.run([sys.executable, str(program)], timeout=60.0,
                          env=dict(os.environ, PYTHONPATH=os.pathsep.join(
                              [str(tmp_path), os.environ.get('PYTHONPATH', '')])),
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    assert done.stdout.decode() == ''
    assert done.returncode in (128 + number, -number)
