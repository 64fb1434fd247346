# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Plain robots behind a bad radio: the mux and its operator here, the robots in another network."""
import os
import subprocess
import sys
import threading
import time

import rospy

from mhri.msg import Accessory
from support import graph
from support.bad_radio import BadRadio, FAR_IP, NEAR_IP, Place
from support.plain_world import World
from support.robots import RobotLog
from support.ros_system import System, wait_for

HERE = os.path.dirname(os.path.abspath(__file__))
# What does not reach the robots: nothing passes, or only what they say.
BOTH_WAYS, ONE_WAY = 'both ways', 'one way'
FLIPPER = {'flipper': {'kind': 'hold', 'topic': 'flipper', 'type': 'std_msgs/Float64',
                       'on_stop': 'stop'}}


class FarWorld(World):
    """The whole of it; use it as a context manager, in a network of its own.

    :param robots: their names
    """

    def __init__(self, *robots):
        self.far = Place()
        self.radio = BadRadio(self.far)
        self.system = System(ip=NEAR_IP)
        self._robots = robots
        #: what the flippers of the robots are held at, from -1 to 1
        self.flip = 0.0
        self._said = None

    def __enter__(self):
        self.system.start_master()
        rospy.init_node('far_test', disable_signals=True)
        for name in self._robots:
            rospy.set_param('/{}/mhri/accessories'.format(name), FLIPPER)
        self._hand = rospy.Publisher(graph.ACCESSORY, Accessory, queue_size=1, tcp_nodelay=True)
        super().__init__(self.system, self._robots, self._start)
        threading.Thread(target=self._hold, daemon=True).start()
        return self

    def __exit__(self, failure, *_):
        self.end()
        rospy.signal_shutdown('done')
        self.system.__exit__(failure)
        self.radio.close()
        self.far.close()

    def _hold(self):
        """Repeat what is held, as the program of the operator does."""
        while not self._ends.wait(0.05):
            flip = self.flip
            for name in self._robots:
                self._hand.publish(robots=[name], key='flipper', value=[flip])
            self._said = flip

    def let_go(self):
        """Release the flippers; return once that has been said."""
        self.flip, self._said = 0.0, None
        wait_for(lambda: self._said == 0.0, what='the release')

    def _start(self, name):
        """Start a robot, and return what it is told."""
        log = RobotLog(os.path.join(self.system.home, name))
        self.system.start(*self.far.command(
            'env', 'ROS_IP=' + FAR_IP, sys.executable, os.path.join(HERE, 'logged_robot.py'), name,
            log.path + '.told', '20', 'flipper', '__ns:=/' + name))
        return log

    def cut(self, how):
        """Cut the radio, both ways or only towards the robots; return when."""
        if how == ONE_WAY:
            # Where they arrive: the sender's kernel would notice that one does not leave.
            self._filter('add table ip cut; add chain ip cut in '
                         '{ type filter hook prerouting priority -300; policy drop; }')
        else:
            self.radio.follow([{'at_s': 0, 'down': True}])
        return time.monotonic()

    def mend(self, how):
        """Let everything pass again; return when."""
        if how == ONE_WAY:
            self._filter('delete table ip cut')
        else:
            self.radio.follow([{'at_s': 0}])
        return time.monotonic()

    def _filter(self, rules):
        subprocess.run(self.far.command('nft', rules), check=True)
