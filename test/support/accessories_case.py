# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A robot with accessories of every kind, at the real drive."""
import threading
import time

import actionlib
from actionlib.msg import TestAction, TestResult
from geometry_msgs.msg import Vector3
import rospy
from std_msgs.msg import Bool, Float64
from std_srvs.srv import SetBool, SetBoolResponse

from mhri.msg import Accessory
from support import graph
from support.drive_case import DriveCase
from support.node_tools import measured
from support.ros_system import wait_for

ROWS = {
    'lamp': {'kind': 'toggle', 'topic': 'lamp', 'state': 'lamp_state', 'on_stop': 'keep'},
    'beacon': {'kind': 'toggle', 'topic': 'beacon', 'state': 'beacon_state', 'on_stop': 'keep'},
    'flipper': {'kind': 'hold', 'topic': 'flipper/velocity', 'type': 'std_msgs/Float64',
                'range': [-2.0, 1.0], 'rate_hz': 20, 'on_stop': 'stop'},
    'fan': {'kind': 'hold', 'topic': 'fan', 'type': 'std_msgs/Float64', 'on_stop': 'keep'},
    'head': {'kind': 'axis2', 'mode': 'position', 'topic': 'head/cmd',
             'type': 'geometry_msgs/Vector3', 'state': 'head_state',
             'range': [[-1.5, 1.5], [-0.5, 0.8]], 'on_stop': 'stop'},
    'arm': {'kind': 'tap', 'action': 'arm', 'type': 'actionlib/Test',
            'choices': {'open': {'goal': 3}, 'close': {'goal': 4}}, 'on_stop': 'cancel'},
    'horn': {'kind': 'toggle', 'service': 'horn', 'type': 'std_srvs/SetBool',
             'choices': {'on': {'data': True}, 'off': {'data': False}}, 'on_stop': 'keep'},
    'claw': {'kind': 'tap', 'topic': 'claw', 'type': 'no_such_msgs/Claw',
             'choices': {'open': {'data': 1}}, 'on_stop': 'stop'},
    'nose': {'kind': 'tap', 'topic': 'nose', 'type': 'std_msgs/Bool',
             'choices': {'sniff': {'air': 1}}, 'on_stop': 'stop'}}


class Tools:
    """The accessories of a robot: what each was sent, as [(time, value)]."""

    def __init__(self, name):
        self.sent = {'flipper': [], 'fan': [], 'lamp': [], 'head': [], 'horn': [], 'arm': []}
        self.goal, self.answers = threading.Event(), True
        place = '/{}/'.format(name)
        self.ears = [
            rospy.Subscriber(place + topic, kind, self._note, (key, read), tcp_nodelay=True)
            for key, topic, kind, read in (
                ('flipper', 'flipper/velocity', Float64, lambda message: message.data),
                ('fan', 'fan', Float64, lambda message: message.data),
                ('lamp', 'lamp', Bool, lambda message: message.data),
                ('head', 'head/cmd', Vector3, lambda message: (message.x, message.y)))]
        self.lamp = rospy.Publisher(place + 'lamp_state', Bool, queue_size=1, latch=True)
        self.beacon = rospy.Publisher(place + 'beacon_state', Bool, queue_size=1, latch=True)
        self.beacon.publish(True)
        self.head = rospy.Publisher(place + 'head_state', Vector3, queue_size=1, latch=True)
        self.horn = rospy.Service(place + 'horn', SetBool, self._hoot)
        self.arm = actionlib.SimpleActionServer(place + 'arm', TestAction, self._grip, False)
        self.arm.start()

    def _note(self, message, told):
        key, read = told
        self.sent[key].append((time.monotonic(), read(message)))

    def _hoot(self, request):
        self.sent['horn'].append((time.monotonic(), request.data))
        return SetBoolResponse(self.answers, 'no air')

    def _grip(self, goal):
        """Move until the goal is cancelled, or allowed to end."""
        self.sent['arm'].append((time.monotonic(), goal.goal))
        while not (self.arm.is_preempt_requested() or self.goal.is_set()):
            time.sleep(0.002)
        if self.arm.is_preempt_requested():
            self.sent['arm'].append((time.monotonic(), 'cancelled'))
            self.arm.set_preempted()
        else:
            self.arm.set_succeeded(TestResult())

    def close(self):
        """Unregister all of it."""
        self.goal.set()
        for end in (*self.ears, self.lamp, self.beacon, self.head):
            end.unregister()
        self.horn.shutdown()

    def last(self, key):
        """Return the last value, None for nothing."""
        return self.sent[key][-1][1] if self.sent[key] else None

    def first_since(self, key, when, good):
        """Return when the first good value came after a time, None if none did."""
        return next((at for at, value in list(self.sent[key]) if at >= when and good(value)), None)


class AccessoriesCase(DriveCase):
    """The drive, and a robot with accessories; what is held is repeated."""

    def setUp(self):
        super().setUp()
        name = self.next_name()
        rospy.set_param('/{}/mhri'.format(name), {'accessories': ROWS})
        self.tools = Tools(name)
        self.addCleanup(self.tools.close)
        (self.name, self.receiver), = self.robots(1)
        self.hand = rospy.Publisher(graph.ACCESSORY, Accessory, queue_size=10, tcp_nodelay=True)
        self.addCleanup(self.hand.unregister)
        self.held, self.stop_holding = {}, threading.Event()
        thread = threading.Thread(target=self.keep_holding, daemon=True)
        thread.start()
        self.addCleanup(thread.join)
        self.addCleanup(self.stop_holding.set)
        wait_for(self.hand.get_num_connections, what='the drive to listen')
        self.wait_for_lines()

    def wait_for_lines(self, held=''):
        """Wait until the drive reaches the accessories.

        :param held: why those stand that are held
        """
        wanted = {'lamp': '', 'arm': '', 'flipper': held, 'head': held}

        def reached():
            found = self.accessories()
            return found and all(found[key].stands == stands for key, stands in wanted.items())
        wait_for(reached, what=lambda: 'the accessories: {}'.format(self.accessories()))

    def accessories(self):
        robot = self.state.robot(self.name)
        return {one.key: one for one in robot.accessories} if robot else {}

    def use(self, key, choice='', *value):
        self.hand.publish(robots=[self.name], key=key, choice=choice, value=value)

    def keep_holding(self):
        """Repeat what is held, as the program of the operator does."""
        while not self.stop_holding.wait(0.05):
            for key, value in list(self.held.items()):
                self.use(key, '', *value)

    def flip(self, share=-1.0, sent=-2.0):
        """Hold the flipper until it moves so."""
        self.held['flipper'] = (share,)
        wait_for(lambda: self.tools.last('flipper') == sent, what='the flipper')

    def ends(self, what, when, within_s, key='flipper', good=lambda value: value == 0.0):
        """Wait for what ends the motion; nothing else comes behind it."""
        at = wait_for(lambda: self.tools.first_since(key, when, good), what=what)
        measured('neutral of an accessory, ' + what, at - when, within_s)
        return at
