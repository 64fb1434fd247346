# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The guard on the robot and the drive on the host: the real nodes, and a network in between."""
import signal
import sys
import time

from geometry_msgs.msg import TwistStamped
import rosgraph
import rospy

from mhri.srv import StopRobots
from support.drive_case import DriveCase
from support.own_node import own_node
from support.paths import GUARD, SUPPORT
from support.ros_system import freeze, thaw, wait_for
from support.node_tools import Process
from support.velocity import VelocityEnd

system = own_node('guarded')

# Of the guard, to its next look [s]. A stall is longer than it obeys what was said: a second.
LEASE_S, STALL_S = 0.3 + 0.05, 1.5


class GuardedTest(DriveCase):
    """What the robot does by itself."""

    def guard(self, name, namespace=None):
        """Start the guard of a robot, in its namespace or another; return it once it is used."""
        guard = Process([sys.executable, GUARD, '_command:=cmd_vel'],
                        env={'ROS_NAMESPACE': namespace or name})
        self.addCleanup(guard.end)
        self.wait_robot(name, lambda robot: robot.guarded, 'the guard')
        return guard

    def guarded(self):
        """Return (name, receiving end, process of the guard) of a robot that is ready to drive."""
        (name, receiver), = self.robots(1)
        guard = self.guard(name)
        self.ready(name)
        return name, receiver, guard

    def test_commands_go_through_the_guard_and_one_that_is_killed_leaves_a_robot_that_waits(self):
        name, receiver, guard = self.guarded()
        self.assertEqual(self.drive(receiver, 0.25, 0.1875), (0.25, 0.1875))
        self.assertEqual(self.state.robot(name).topic, '/{}/mhri_guard/command'.format(name))
        when = guard.send(signal.SIGKILL)
        self.wait_robot(name, lambda robot: not robot.guarded, 'no guard')
        first = self.first_zero('guard killed, by the plain topic', receiver, when, 2.0)
        self.waits(name)
        self.stays_at_rest(receiver, first)
        self.ready(name)
        self.assertEqual(self.drive(receiver, 0.125), (0.125, 0.0), 'by the plain topic')

    def test_a_stop_that_somebody_else_sends_to_the_guard_stops_all_until_it_is_released(self):
        name, receiver, _ = self.guarded()
        script = rospy.Publisher('/{}/mhri_guard/command'.format(name), TwistStamped, queue_size=1)
        self.addCleanup(script.unregister)
        wait_for(script.get_num_connections, what='the guard to listen')
        self.drive(receiver, 0.25)
        stop = TwistStamped()
        stop.header.frame_id = 'script!:1:'
        when = time.monotonic()
        script.publish(stop)
        first = self.first_zero("a script's stop", receiver, when, 0.1)
        self.state.wait(lambda state: state.stop_all, 'the stop that the robot tells of')
        self.stays_at_rest(receiver, first)
        self.operator.release()
        self.ready(name)
        self.assertEqual(self.drive(receiver, 0.125), (0.125, 0.0))

    def test_one_robot_that_is_stopped_is_latched_on_its_guard_alone(self):
        name, receiver, _ = self.guarded()
        (other, other_end), = self.robots(1)
        self.guard(other)
        self.operator.check(name, other)
        self.ready(name, other)
        self.drive(receiver, 0.25)
        when = time.monotonic()
        rospy.ServiceProxy('/mux/stop_robots', StopRobots)([name])
        first = self.first_zero('stopped alone through the guard', receiver, when, 0.05)
        self.wait_robot(name, lambda robot: robot.stop_confirmed, 'the word of the robot')
        self.assertFalse(self.state.robot(other).stop_confirmed or self.state.message.stop_all)
        when, run = self.kill_drive()
        self.wait_for_drive(run)
        self.wait_robot(name, lambda robot: robot.stands == 'stopped_alone'
                        and robot.stop_confirmed, 'the stop')
        self.assertFalse(self.state.message.stop_all)
        self.ready(other)
        self.drive(other_end, 0.25)
        self.stays_at_rest(receiver, first)
        self.select_anew(name, besides=[other])
        self.ready(name, other)
        self.assertEqual(self.drive(receiver, 0.125), (0.125, 0.0))

    def behind_a_network(self):
        """Return (name, receiving end, what its guard has dropped, network) of a robot to drive."""
        (name, _), = self.robots(1)
        far, dropped = '/behind/' + name, []
        receiver = VelocityEnd(far + '/cmd_vel')
        ear = rospy.Subscriber(far + '/mhri_guard/dropped', TwistStamped, lambda message: dropped.
                               append((time.monotonic(), message.twist.linear.x)))
        self.addCleanup(ear.unregister)
        network = Process([sys.executable, str(SUPPORT / 'topic_relay.py'), far],
                          env={'ROS_NAMESPACE': name})
        self.addCleanup(network.end)
        self.guard(name, namespace=far)
        wait_for(ear.get_num_connections, what='its guard')
        self.ready(name)
        return name, receiver, dropped, network.number

    def is_the_only_way(self, name):
        """See that nobody but the network speaks to the guard, nor hears what is meant for it."""
        published, subscribed, _ = map(dict, rosgraph.Master(rospy.get_name()).getSystemState())
        node = '/{}/mhri_guard'.format(name)
        self.assertEqual(published['/behind{}/command'.format(node)], [node])
        self.assertEqual(subscribed[node + '/command'], [node])

    def test_no_backlog_moves_a_guarded_robot(self):
        """The link stalls with the stick held; what it has held back comes all at once."""
        name, receiver, dropped, network = self.behind_a_network()
        self.is_the_only_way(name)
        self.drive(receiver, 0.25)
        stalled = freeze(network)
        first = self.first_zero('link stalled: by the guard', receiver, stalled, LEASE_S)
        wait_for(lambda: time.monotonic() > stalled + STALL_S, what='a while')
        back = thaw(network)
        wait_for(lambda: [at for at, mps in list(dropped) if at > back and mps],
                 what='what was held back')
        self.waits(name)
        self.stays_at_rest(receiver, first, seconds=1.0)
        self.is_the_only_way(name)
        print('MEASURED link stalled for {} s: {} commands came late, none was obeyed'.format(
            STALL_S, len([at for at, mps in dropped if at > back and mps])))
        self.ready(name)
        self.assertEqual(self.drive(receiver, 0.25), (0.25, 0.0))

    def test_a_stranger_at_the_guard_is_said_and_shut_out_again(self):
        name, receiver, _ = self.guarded()
        heard = []
        ear = rospy.Subscriber('/{}/mhri_guard/echo'.format(name), TwistStamped, heard.append,
                               queue_size=1)
        self.addCleanup(ear.unregister)
        mouth = rospy.Publisher('/{}/mhri_guard/command'.format(name), TwistStamped, queue_size=1)
        self.addCleanup(mouth.unregister)
        self.drive(receiver, 0.25)
        wait_for(lambda: heard and mouth.get_num_connections(), what='the guard')
        message = TwistStamped()

        def named():
            """Speak with the newest token: it does not count for long."""
            message.header.frame_id = 'stranger:1:' + heard[-1].header.frame_id.split(':')[2]
            mouth.publish(message)
            return any(name in line for line in self.state.message.refused)
        wait_for(named, what='the word of somebody else', poll_s=0.05)
        self.ready(name)
        self.assertEqual(self.drive(receiver, 0.125), (0.125, 0.0))
