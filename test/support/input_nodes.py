# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""An input node in a process, as the tests of pad, pedal and voice use it."""
from collections import namedtuple
import unittest

import psutil
import rospy
from sensor_msgs.msg import Joy

from mhri.msg import ControlMode
from mhri.srv import SetSuspended
from support import graph
from support.node_tools import measured, Recorder, state_recorder, twist_recorder
from support.ros_system import wait_for

START_S = 30.0
Said = namedtuple('Said', 'axes buttons frame stamp')


def joy_recorder(topic):
    """Return a recorder of a Joy topic."""
    return Recorder(topic, Joy, lambda message: Said(
        tuple(message.axes), tuple(message.buttons), message.header.frame_id,
        message.header.stamp.to_sec()))


class InputCase(unittest.TestCase):
    """A mux, and a node of its own for each test, as ``self.node``.

    The mode is at first that of the virtual joystick: the mux suspends the node.
    """

    def setUp(self):
        """Begin in that mode."""
        self.select = rospy.Publisher(graph.MODE_SELECT, ControlMode, queue_size=10)
        self.modes = Recorder(graph.MODE, ControlMode, lambda message: message.source)
        self.twists = twist_recorder()
        self.waits = state_recorder('waits_for')
        wait_for(self.select.get_num_connections, what='the mux does not listen')
        self.modes.wait_publisher()
        self.twists.wait_publisher()
        self._mode('joy')

    def tearDown(self):
        """Leave nothing behind."""
        self._mode('joy')
        self.node.end()
        for recorder in (self.modes, self.twists, self.waits):
            recorder.close()

    def _mode(self, name):
        self.select.publish(source=name)
        self.modes.wait_newest(name)

    def _one_neutral(self, begun, words, promised_s=None):
        """Check that the last message after a time is the one neutral one, and when it came."""
        self.node.joys.wait_silence(0.5)
        said = self.node.joys.since(begun)
        neutral = [item for item in said if is_neutral(item.value)]
        self.assertEqual(neutral, said[-1:], 'not one neutral at the end: {}'.format(said[-4:]))
        measured(words, neutral[0].at - begun, promised_s)


def is_neutral(said):
    """Return whether nothing is pushed or pressed."""
    return not any(said.axes + said.buttons)


class InputNode:
    """An input node, suspended; returns when it answers.

    :param name: e.g. 'mhri_joy'
    :param topic: where it publishes
    :param process: starts it
    """

    def __init__(self, name, topic, process):
        self.joys = joy_recorder(topic)
        self._suspended, self._service_name = True, '/{}/set_suspended'.format(name)
        self._service = rospy.ServiceProxy(self._service_name, SetSuspended)
        self.process = process()
        self.pid = getattr(self.process, 'pid', None) or self.process.number
        wait_for(self._answers, what='no service: ' + self.process.said(), timeout_s=START_S)
        self.joys.wait_publisher(START_S)

    def _answers(self):
        """Return whether it is this node, not one that was killed before, that has the service."""
        try:
            uri = rospy.get_master().lookupService(self._service_name)[2]
            rospy.wait_for_service(self._service_name, 0.05)
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

    def end(self):
        """Make sure that it is gone."""
        self.process.end()
        self.joys.close()
