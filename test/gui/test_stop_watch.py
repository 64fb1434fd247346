# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The watch of STOP as the screen sees it: started, started again, ended, or said to be missing."""
import errno
import os
import subprocess
import sys
import time

import psutil
import pytest

from mhri.driving.gui.stop_button import stop_places, StopButton
from mhri.screen.presenters import stop_watch
from mhri.screen.presenters.stop_watch import StopWatch

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
print(watch._process)
'''


@pytest.fixture(name='watch')
def _watch(application):
    watch = StopWatch(NOBODY)
    watch.start()
    yield watch
    watch.close()


def watching():
    """Return the processes that watch."""
    return [process for process in psutil.Process().children()
            if process.status() != psutil.STATUS_ZOMBIE
            and any('stop_watch' in word for word in process.cmdline())]


def test_it_is_started_again_and_ends_with_the_screen(operator, watch, monkeypatch):
    monkeypatch.setattr(stop_watch, '_AGAIN_AFTER', 5)
    operator.wait_until(watching, 30.0)
    first, = watching()
    first.kill()
    operator.wait_until(lambda: watching() and watching() != [first], 30.0)
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
    operator.wait_until(watching, 30.0)
    watch.close()
    assert len(said) == 1 and 'its watch cannot be started' in said[0]
    assert len(tries) == 3 and psutil.Process().num_fds() == held


def test_where_the_x_server_cannot_tell(operator, monkeypatch):
    """Said once, and left at that."""
    monkeypatch.setenv('DISPLAY', ':99999')
    said = []
    monkeypatch.setattr('rospy.logwarn', lambda *words: said.append(words[0] % words[1:]))
    watch = StopWatch(NOBODY)
    watch.start()
    operator.wait_until(lambda: said, 30.0)
    operator.wait_until(lambda: not watching(), 30.0)
    assert said == ['STOP ALL of this screen does not work while it hangs: no X server answers']
    watch.close()


def test_without_x():
    done = subprocess.run([sys.executable, '-c', WITHOUT_X], stdout=subprocess.PIPE, timeout=60,
                          env=dict(os.environ, QT_QPA_PLATFORM='offscreen'), check=True,
                          universal_newlines=True)
    assert done.stdout.splitlines() == [
        'STOP ALL of this screen does not work while it hangs: it needs an X server', 'None']


def test_what_a_beat_costs(operator):
    """All that the GUI thread does for it, ten times a second."""
    buttons = [operator.show(StopButton()) for _ in range(5)]
    begun = time.process_time()
    for _ in range(200):
        stop_places()
    took_s = (time.process_time() - begun) / 200
    print('\nMEASURED places of {} stop buttons in windows of their own: {:.0f} us'.format(
        len(buttons), 1e6 * took_s))
    assert took_s < 0.01
