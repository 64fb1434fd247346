# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A linked robot in wrong hands: what it says moves no other robot, and fills nothing."""
import time

import pytest

from support.graph import SET_MOTOR_POWER
from support.linked import LONG_S, Operator
from support.ros_system import free_port, System, wait_for

ODOMETRY = 'nav_msgs/Odometry'
# What it says of itself, all of it about others or too fast.
HOSTILE = {'robot_type': 'turtlebot3', 'mhri': {
    'command': ['/bot2/cmd_vel', 'cmd_vel'],
    'limits': {'linear_mps': 20.0, 'angular_rad_s': 20.0},
    'motor_power': {'topic': '/bot2/motor_power', 'type': 'std_msgs/Bool'}}}
# That of a TurtleBot3 of unknown model.
MAX_MPS = 0.22


class Lab:
    """A host with mux and a link to bot1; bot2 is on the host's own master."""

    def __init__(self):
        from support.robot_end import RobotEnd
        self.system = System()
        self.system.start_master()
        endpoint = 'tcp/127.0.0.1:{}'.format(free_port())
        self.robot = RobotEnd('bot1', endpoint)
        self.system.node('mux', '__name:=mux')
        self.link = self.system.node('mhri_link', '--side', 'host', '--name', 'bot1', '--connect',
                                     endpoint, '--keys', 'off', '__ns:=/bot1')

    def listen(self):
        """Begin to hear what the robots receive, and what the host says of them."""
        import rospy
        from geometry_msgs.msg import Twist
        from std_msgs.msg import Bool
        self.twists = {name: [] for name in ('bot1', 'bot2')}
        for name, found in self.twists.items():
            rospy.Subscriber('/{}/cmd_vel'.format(name), Twist, found.append, queue_size=50)
        self.powers = {name: [] for name in ('bot1/bot2', 'bot2')}
        for name, found in self.powers.items():
            rospy.Subscriber('/{}/motor_power'.format(name), Bool, found.append, queue_size=50)

    def become(self, parameters, topics=(('odom', ODOMETRY),)):
        """Let the robot say other things of itself, and wait until the host knows."""
        import rospy
        from mhri.link.frames import About
        mark = 'mark {}'.format(time.monotonic())
        self.robot.about = About(dict(parameters, mhri=dict(
            parameters.get('mhri', {}), label=mark)), tuple(topics))
        wait_for(lambda: rospy.get_param('/bot1/mhri/label', '') == mark, LONG_S,
                 'the host to take in what the robot says')

    def close(self):
        self.robot.close()
        self.system.close()


@pytest.fixture(scope='module')
def lab():
    import rospy
    from mhri.graph.ros.master_watch import MasterWatch
    built = Lab()
    try:
        rospy.init_node('hostile_robot_test', disable_signals=True)
        MasterWatch().start()
        built.listen()
        wait_for(lambda: built.robot.host, LONG_S, 'the host to call')
        built.become(HOSTILE)
        built.robot.said['odom'] = odometry()
        # The mux looks at what it is once it is selected.
        built.operator = Operator()
        yield built
    finally:
        built.close()
        rospy.signal_shutdown('done')


def odometry():
    from nav_msgs.msg import Odometry
    from support.robot_end import bytes_of
    message = Odometry()
    message.header.frame_id, message.child_frame_id = 'bot2/odom', 'bot2/base_footprint'
    return bytes_of(message)


def moving(twists):
    return [twist for twist in twists if twist.linear.x or twist.angular.z]


def test_the_stick_for_it_drives_no_other_robot(lab):
    lab.operator.stick.drive(1.0, 0.4, lambda: any(map(moving, lab.twists.values())), LONG_S,
                             'a robot to be driven')
    time.sleep(0.5)
    lab.operator.stick.hold(0.0, 0.0)
    most = {name: max([abs(twist.linear.x) for twist in found] or [0.0])
            for name, found in lab.twists.items()}
    print('MEASURED was sent [m/s]:', most)
    assert not moving(lab.twists['bot2']) and 0.0 < most['bot1'] <= MAX_MPS + 1e-6


def test_no_power_of_another_robot_is_cut(lab):
    import rospy
    from std_srvs.srv import SetBool
    cut = rospy.ServiceProxy(SET_MOTOR_POWER, SetBool)

    def told():
        cut(False)
        return any(lab.powers.values())
    wait_for(told, LONG_S, 'the power to be cut', 0.2)
    cut(True)
    assert lab.powers['bot1/bot2'] and not lab.powers['bot2']


def test_it_places_no_frames_but_its_own(lab):
    import rospy
    from geometry_msgs.msg import TransformStamped
    from nav_msgs.msg import Odometry
    from support.robot_end import bytes_of
    from tf2_msgs.msg import TFMessage
    heard, poses = [], []
    rospy.Subscriber('/tf', TFMessage, heard.append, queue_size=50)
    rospy.Subscriber('/bot1/odom', Odometry, poses.append, queue_size=50)

    def transform(parent, child):
        row = TransformStamped(child_frame_id=child)
        row.header.frame_id = parent
        row.transform.rotation.w = 1.0
        return row
    pairs = [('bot1/odom', 'bot1/base_footprint'), ('bot2/odom', 'bot2/base_footprint'),
             ('world', 'map'), ('map', 'bot2/odom')]
    lab.robot.said['tf'] = bytes_of(TFMessage([transform(*pair) for pair in pairs]))
    lab.become({'robot_type': 'turtlebot3'}, [('odom', ODOMETRY), ('/tf', 'tf2_msgs/TFMessage')])
    wait_for(lambda: heard and poses, LONG_S, 'tf and odometry on the host')
    children = {row.child_frame_id for message in heard for row in message.transforms}
    assert children and all(child.startswith('bot1/') for child in children), children
    assert poses[-1].header.frame_id.startswith('bot1/')
    assert poses[-1].child_frame_id.startswith('bot1/')


def test_it_fills_no_master(lab):
    """Thousands of topics, a hundred at a time, and types that no robot has."""
    import rospy
    for number in range(6):
        lab.become({'robot_type': 'turtlebot3'}, [
            ('t{}_{}'.format(number, at), ODOMETRY) for at in range(95)] + [
                ('cmd_vel', 'geometry_msgs/Twist'), ('mhri_link/state', 'mhri/LinkControl')])
    own = [topic for topic, _ in rospy.get_published_topics('/bot1')]
    assert len(own) <= 120 and '/bot1/cmd_vel' not in [
        topic for topic, nodes in rospy.get_master().getSystemState()[2][0]
        if '/bot1/mhri_link' in nodes]
    assert lab.link.poll() is None
