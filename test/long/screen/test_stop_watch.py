# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The watch of STOP as the screen sees it: started, started again, ended, or said to be missing."""
import errno
import os
import subprocess
import sys

import psutil
import pytest

from mhri.screen.presenters import stop_watch
from mhri.screen.presenters.stop_watch import StopWatch
from support.ros_system import child_processes

NOBODY = 'http://127.0.0.1:9'
WITHOUT_X = '''
from python_qt_binding.QtCore import QTimer
from python_qt_binding.QtWidgets import QApplication
import rospy
from mhri.screen.presenters.stop_watch import StopWatch
app = QApplication(['offscreen'])
rospy.logwarn = lambda *words: print(words[0] % words[1:])
watch = StopWatch('http://127.0.0.1:9')
watch.start()
QTimer.singleShot(1000, app.quit)
app.exec_()
'''


@pytest.fixture(name='watch')
def _watch(application):
    watch = StopWatch(NOBODY)
    watch.start()
    yield watch
    watch.close()


def watching():
    """Return the processes that watch."""
    return child_processes('stop_watch')


def test_it_is_started_again_and_ends_with_the_screen(operator, watch, monkeypatch):
    monkeypatch.setattr(stop_watch, '_AGAIN_AFTER', 5)
    operator.wait_until(watching)
    first, = watching()
    first.kill()
    operator.wait_until(lambda: watching() and watching() != [first])
    watch.close()
    assert watching() == []


def test_one_that_cannot_be_started_is_tried_again(operator, monkeypatch):
    """Said once; a computer that had no room for a process has some a little later."""
    said, tries, popen = [], [], subprocess.Popen

    def start(*words, **options):
        tries.append(words)
        if len(tries) < 3:
            raise BlockingIOError(errno.EAGAIN, os.strerror(errno.EAGAIN))
        return popen(*words, **options)
    monkeypatch.setattr(subprocess, 'Popen', start)
    monkeypatch.setattr(stop_watch, '_AGAIN_AFTER', 2)
    monkeypatch.setattr('rospy.logwarn', lambda *words: said.append(words[0] % words[1:]))
    held = psutil.Process().num_fds()
    watch = StopWatch(NOBODY)
    watch.start()
    operator.wait_until(watching)
    watch.close()
    assert len(said) == 1
    assert len(tries) == 3 and psutil.Process().num_fds() == held


def test_without_x():
    done = subprocess.run([sys.executable, '-c', WITHOUT_X], stdout=subprocess.PIPE, timeout=60,
                          env=dict(os.environ, QT_QPA_PLATFORM='offscreen'), check=True,
                          universal_newlines=True)
    assert len(done.stdout.splitlines()) == 1
