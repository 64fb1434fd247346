# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The pedal's node with stand-in foot switches, as the rostests use it."""
from collections import namedtuple
import os
import shutil
import sys
import tempfile

import psutil
from rostest_tools import Process, Recorder, wait_until
import rospy
from sensor_msgs.msg import Joy

from mhri.srv import SetSuspended

SUPPORT = os.path.join(os.path.dirname(os.path.abspath(__file__)), '..')
sys.path.insert(0, SUPPORT)

from support import evdev_stream  # noqa: E402

SERVICE = '/mhri_pedal/set_suspended'
SWITCH = ('PCsensor FootSwitch Keyboard', '3553:b001')
START_S = 30.0
Said = namedtuple('Said', 'axes buttons frame')


def joy_recorder():
    """Return a recorder of ``/mux_in/pedal``."""
    return Recorder('/mux_in/pedal', Joy, lambda message: Said(
        tuple(message.axes), tuple(message.buttons), message.header.frame_id))


def is_neutral(said):
    """Tell whether nothing is pressed."""
    return not any(said.axes + said.buttons)


class PedalNode:
    """``mhri_pedal`` in a process, suspended, on a system without any input device.

    :param arguments: for the node, e.g. '_role:=enable'
    :param process: the process of the node, where it is another than that with foot switches
    """

    def __init__(self, *arguments, process=None):
        self._folder = evdev_stream.make_folders(tempfile.mkdtemp(prefix='mhri_pedal_'))
        # An administrator who is turned away for a test has to get that far.
        os.chmod(self._folder, 0o755)
        self.nodes = []
        self._suspended = True
        self.joys = joy_recorder()
        self._service = rospy.ServiceProxy(SERVICE, SetSuspended)
        self.process = process or Process(
            [sys.executable, evdev_stream.__file__, self._folder] + list(arguments))
        wait_until(self._answers, 'no service: ' + self.process.said(), START_S)
        self.joys.wait_publisher(START_S)

    @property
    def pid(self):
        """Number of the node's process."""
        return getattr(self.process, 'pid', None) or self.process._popen.pid

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

    def plug(self, name=SWITCH[0], usb=SWITCH[1], keys=('KEY_A', 'KEY_B', 'KEY_C'), down=()):
        """Plug a foot switch in, with some of its keys held down."""
        number = len(self.nodes)
        self.nodes.append(evdev_stream.StreamNode(
            self._folder, number, name, usb, 'usb-0000:00:14.0-{}/input0'.format(number), keys,
            down))
        return self.nodes[-1]

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

    def wait_grabbed(self, node):
        """Wait until the node has a foot switch for itself."""
        wait_until(node.grabbed, 'not grabbed: ' + self.process.said(), START_S)

    def end(self):
        """Make sure that everything is gone."""
        self.process.end()
        for node in self.nodes:
            node.pull()
        self.joys.close()
        shutil.rmtree(self._folder, ignore_errors=True)
