# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A robot's navigation, a rospy node, whose first connections broke during their handshakes."""
import sys
import time

import rospy

from support.paths import MESSAGES
from support.ros_system import System, wait_for

sys.path.insert(0, MESSAGES)

# Does by itself what happens to a node that connects twice at once, and each end drops another one.
LISTENER = '''
import sys
import rospy
from rospy.impl import tcpros_pubsub
from actionlib_msgs.msg import GoalID, GoalStatusArray

name, cut = sys.argv[1:]
connect, connected = tcpros_pubsub.robust_connect_subscriber, set()

def breaks_at_first(connection, address, port, uri, receive, topic):
    if topic in connected or not cut:
        connect(connection, address, port, uri, receive, topic)
    else:
        connected.add(topic)
        connection.close()

tcpros_pubsub.robust_connect_subscriber = breaks_at_first
rospy.init_node(name)
for topic in ('goal', 'cancel')[:2 if cut else 1]:
    rospy.Subscriber('/bot1/move_base/' + topic, rospy.AnyMsg, lambda message: None)
status = rospy.Publisher('/bot1/move_base/status', GoalStatusArray, queue_size=1)
while not rospy.is_shutdown():
    if cut:
        status.publish(GoalStatusArray())
    rospy.sleep(0.1)
'''


def test_it_comes_to_be_ready():
    from mhri.tasks.ros.move_base import MoveBases
    with System() as system:
        system.start_master()
        rospy.init_node('tasks', disable_signals=True)
        robots = MoveBases(lambda name: 'odom', lambda: '/mux', time.monotonic)
        system.start(sys.executable, '-c', LISTENER, 'mux', '')
        system.start(sys.executable, '-c', LISTENER, 'navigation', 'cut')

        def ready():
            robots.update(['bot1'])
            return robots.get('bot1') and robots.get('bot1').is_ready()
        wait_for(ready, what=lambda: 'it to listen, also to {}'.format(
            robots.get('bot1') and robots.get('bot1').unheard()), poll_s=0.1)
        rospy.signal_shutdown('done')
