# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The voice's node with a stand-in microphone, as the rostests use it."""
from collections import namedtuple
import os
import shutil
import sys
import time

import psutil
from rostest_tools import Process, Recorder, wait_until
import rospy
from sensor_msgs.msg import Joy

from mhri.msg import Heard
from mhri.srv import SetSuspended

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..'))

from support.room import tree_cpu_s  # noqa: E402

SERVICE = '/mhri_voice/set_suspended'
START_S = 30.0
TOOLS = ('espeak-ng', 'sox')
Said = namedtuple('Said', 'axes buttons')
HeardItem = namedtuple('HeardItem', 'text command accepted reason')


def require_speech():
    """Fail in plain words where nobody can speak here, or nobody can hear.

    :raises AssertionError: names the packages that are missing
    """
    missing = [tool for tool in TOOLS if not shutil.which(tool)]
    try:
        import pocketsphinx  # noqa: F401
    except ImportError:
        missing.append('python3-pocketsphinx')
    if missing:
        raise AssertionError('install {} (and pocketsphinx-en-us): speech cannot be tested without'
                             .format(', '.join(missing)))


class VoiceNode:
    """``mhri_voice`` in a process, suspended."""

    def __init__(self, *arguments, env=None):
        self._suspended = True
        self.joys = Recorder('/mux_in/voice', Joy, lambda message: Said(
            tuple(message.axes), tuple(message.buttons)))
        self.heard = Recorder('/mhri_voice/heard', Heard, lambda message: HeardItem(
            message.text, message.command, message.accepted, message.reason))
        self._service = rospy.ServiceProxy(SERVICE, SetSuspended)
        self.process = Process([sys.executable, '-c',
                                'from mhri.nodes.mhri_voice import main; main()']
                               + list(arguments), env)
        wait_until(self._answers, 'no service: ' + self.process.said(), START_S)
        self.joys.wait_publisher(START_S)
        self.heard.wait_publisher(START_S)

    @property
    def pid(self):
        """Number of the node's process."""
        return self.process._popen.pid

    def _answers(self):
        """Tell whether it is this node, not one that was killed before, that has the service."""
        try:
            uri = rospy.get_master().lookupService(SERVICE)[2]
            rospy.wait_for_service(SERVICE, 0.05)
        except (OSError, rospy.ROSException):
            return False
        port = int(uri.rsplit(':', 1)[1].strip('/')) if uri else None
        return port in [entry.laddr.port for entry in
                        psutil.Process(self.pid).connections('tcp') if entry.status == 'LISTEN']

    def resume(self):
        """Call the service to resume; return its answer."""
        self._suspended = False
        return self._service(False)

    def suspend(self):
        """Call the service to suspend; return its answer."""
        self._suspended = True
        return self._service(True)

    def words(self):
        """Return the state in words: asked for what it has been told already, it changes nothing.

        Not for a node that the mux has told something else.
        """
        return self._service(self._suspended).message

    def listeners(self):
        """Return the processes it has begun."""
        return psutil.Process(self.pid).children(recursive=True)

    def wait_words(self, *parts):
        """Wait until the state in words has these parts."""
        wait_until(lambda: all(part in self.words() for part in parts),
                   'never said {}: {}'.format(parts, self.process.said()), START_S)

    def spent_cpu(self, seconds):
        """Return how much of a core it takes with all it has begun, 1.0 for all of it."""
        begun, before = time.monotonic(), tree_cpu_s(self.pid)
        wait_until(lambda: time.monotonic() - begun >= seconds, 'time stands still', seconds + 10.0)
        return (tree_cpu_s(self.pid) - before) / (time.monotonic() - begun)

    def end(self):
        """Make sure that everything is gone."""
        self.process.end()
        self.joys.close()
        self.heard.close()
