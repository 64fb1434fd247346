# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The pad's node with virtual pads, as the rostests use it."""
import os
import sys
import time
from collections import namedtuple

import psutil
from rostest_tools import Recorder, wait_until
import rospy
from sensor_msgs.msg import Joy

from mhri.srv import SetSuspended

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..'))

from support.virtual_pad import missing, PadProcess  # noqa: E402

PS3 = 'Sony PLAYSTATION(R)3 Controller'
SERVICE = '/mhri_joy/set_suspended'
NO_PADS = missing()
Said = namedtuple('Said', 'axes buttons frame stamp')


def joy_recorder(topic='/mux_in/ps3joy'):
    """Return a recorder of a Joy topic."""
    return Recorder(topic, Joy, lambda message: Said(
        tuple(message.axes), tuple(message.buttons), message.header.frame_id,
        message.header.stamp.to_sec()))


def spent_cpu(pid, seconds):
    """Return how much of a core a process takes over some seconds, 1.0 for all of it."""
    process, begun = psutil.Process(pid), time.monotonic()
    before = process.cpu_times()
    wait_until(lambda: time.monotonic() - begun >= seconds, 'time stands still', seconds + 10.0)
    after = process.cpu_times()
    return (after.user + after.system - before.user - before.system) / (time.monotonic() - begun)


class JoyNode:
    """``mhri_joy`` in a process, suspended, with no pad."""

    def __init__(self, *arguments):
        self.joys = joy_recorder()
        self._suspended = True
        self._service = rospy.ServiceProxy(SERVICE, SetSuspended)
        self.process = PadProcess(*arguments)
        wait_until(self._answers, 'no service: ' + self.process.said(), 30.0)
        self.joys.wait_publisher(30.0)

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

    @property
    def pid(self):
        """Number of the node's process."""
        return self.process.pid

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

    def do(self, command, **arguments):
        """Carry out a command of :class:`support.virtual_pad.Pads`."""
        return self.process.do(command, **arguments)

    def attach(self, name, axes=None, counts=(6, 17, 0), product=0):
        """Plug a pad in; return its number."""
        number = self.do('attach', name=name, axes=counts[0], buttons=counts[1], hats=counts[2],
                         vendor=0x1209, product=product)
        self.set(number, axes=axes)
        return number

    def set(self, number, **state):
        """Move a pad; return when that was done."""
        self.do('set', number=number, **state)
        return self.process.done_at

    def detach(self, number):
        """Pull a pad out; return when SDL reported it."""
        return self.do('detach', number=number)

    def open_devices(self):
        """Return the device files that the node has open."""
        folder = '/proc/{}/fd'.format(self.pid)
        links = [os.readlink(os.path.join(folder, name)) for name in os.listdir(folder)]
        return [link for link in links if link.startswith(('/dev/input', '/dev/hidraw'))]

    def end(self):
        """Make sure that it is gone."""
        self.process.end()
        self.joys.close()
