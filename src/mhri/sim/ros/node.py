# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The simulated robot on ROS: exactly the topics of its template, at the rates of the real one.

Publishes odometry at 50 Hz, IMU at 100 Hz, laser scan at 10 Hz, ``/tf`` at 50 Hz, the poses of its
sensors on ``/tf_static`` (that of a camera on a head on ``/tf``) and, if the template has one, the
battery at 1 Hz; optionally the true pose at 50 Hz like a motion capture system
(``/vrpn_client_node/<robot>/pose``, frame ``world``), and the origin of its odometry like a perfect
localisation (``/tf``, ``map`` to ``<robot>/odom``).
Subscribes to every velocity topic of the template, and offers its switch of the motor power. Frames
are ``<robot>/odom``, ``<robot>/base_link``, ``<robot>/imu_link``, ``<robot>/laser`` (REP-105) and
that of the camera.
"""
import math
import threading

from geometry_msgs.msg import PoseStamped, TransformStamped, Twist
from nav_msgs.msg import Odometry
import numpy as np
import rospy
from sensor_msgs.msg import BatteryState, Imu, LaserScan
from std_srvs.srv import SetBool, SetBoolResponse
from tf2_msgs.msg import TFMessage

from mhri.base.geometry import composed, inverse, Pose
from mhri.base.names import topic_of
from mhri.graph.ros.messages import message_class, MessageMissing, read_field
from mhri.robots.ros.convert import from_twist, turn_of
from mhri.sim.lens import CAMERA_HEIGHT_M
from mhri.sim.sensors import ImuSensor
from mhri.sim.ticks import Due, Ticks

RATE_HZ = 100
ODOMETRY_EVERY = 2
SCAN_EVERY = 10
BATTERY_EVERY = 100
MAX_STEP_S = 0.1
BATTERY_LIFE_S = 2.5 * 3600.0


class PowerSwitch:
    """The switch of the motor power: the topic or service in the template.

    :param robot: its name
    :param spec: :class:`mhri.base.robot_hardware.MotorPowerSpec`, None without a switch
    :param set_power: called with True for on, False for off
    """

    def __init__(self, robot, spec, set_power):
        self._spec = spec
        self._set_power = set_power
        if spec is None:
            return
        name = topic_of(robot, spec.name)
        if spec.service:
            rospy.Service(name, SetBool, self._on_call)
            return
        try:
            rospy.Subscriber(name, message_class(spec.kind), self._on_message, queue_size=1)
        except MessageMissing as error:
            rospy.loginfo('%s: no switch for its motor power: %s', robot, error)

    def _on_call(self, request):
        self._set_power(request.data)
        return SetBoolResponse(True, 'power is {}'.format('on' if request.data else 'cut'))

    def _on_message(self, message):
        value = read_field(message, self._spec.field)
        if value in (self._spec.powered, self._spec.cut):
            self._set_power(value == self._spec.powered)


def _transform(name, parent, child):
    """Return the identity transform between two frames of a robot."""
    transform = TransformStamped(child_frame_id='{}/{}'.format(name, child))
    transform.header.frame_id = '{}/{}'.format(name, parent)
    transform.transform.rotation.w = 1.0
    return transform


class SimRobot:
    """Publishes the data of a body and its sensors, and passes commands to it.

    :param name: the robot; also the prefix of its frames
    :param template: :class:`mhri.base.robot_types.RobotType`
    :param body: :class:`mhri.sim.body.Body`
    :param laser: :class:`mhri.sim.sensors.Laser`
    :param world: :class:`mhri.sim.world.World`
    :param landmarks: array (n, 3) of x, y, radius [m]
    :param tracked: whether motion capture tracks the robot
    :param failing: :class:`mhri.sim.ros.fault_node.Failing`
    :param tools: :class:`mhri.sim.ros.tools_node.SimTools`
    :param placed: whether to publish the origin of its odometry in the frame map on tf
    """

    def __init__(self, name, template, body, imu, laser, world, landmarks, failing, tools,
                 tracked=False, placed=False):
        self._name, self._tools = name, tools
        self._body = body
        self._failing = failing
        self._charge = 1.0
        self._imu = imu
        self._laser = laser
        self._world = world
        self._landmarks = landmarks
        self._odometry_due, self._scan_due, self._battery_due = (
            Due(every) for every in (ODOMETRY_EVERY, SCAN_EVERY, BATTERY_EVERY))
        self._make_messages(placed)
        prefix = '/' + name + '/'
        self._odom_pub = rospy.Publisher(prefix + template.odometry[0], Odometry, queue_size=10)
        self._imu_pub = rospy.Publisher(prefix + template.imu[0], Imu, queue_size=100)
        self._scan_pub = rospy.Publisher(prefix + template.scan[0], LaserScan,
                                         queue_size=2) if template.scan else None
        self._tf_pub = rospy.Publisher('/tf', TFMessage, queue_size=10)
        self._fixed_pub = rospy.Publisher('/tf_static', TFMessage, queue_size=10, latch=True)
        for transform in self._fixed.transforms:
            transform.header.stamp = rospy.Time.now()
        self._fixed_pub.publish(self._fixed)
        self._battery_pub = rospy.Publisher(prefix + template.battery[0], BatteryState,
                                            queue_size=1) if template.battery else None
        self._mocap_pub = rospy.Publisher('/vrpn_client_node/{}/pose'.format(name), PoseStamped,
                                          queue_size=1) if tracked else None
        PowerSwitch(name, template.motor_power, body.set_power)
        for topic in template.command:
            rospy.Subscriber(prefix + topic, Twist, self._on_twist, queue_size=1, tcp_nodelay=True)

    def _make_messages(self, placed):
        """Create the messages, with their constant fields."""
        name = self._name
        self._odom = Odometry(child_frame_id=name + '/base_link')
        self._odom.header.frame_id = name + '/odom'
        for matrix, values in ((self._odom.pose.covariance, (0.01, 0.01, 1e6, 1e6, 1e6, 0.03)),
                               (self._odom.twist.covariance, (0.0004, 1e-6, 1e6, 1e6, 1e6, 0.001))):
            for index, value in enumerate(values):
                matrix[index * 7] = value
        self._imu_msg = Imu()
        self._imu_msg.header.frame_id = name + '/imu_link'
        for matrix, value in ((self._imu_msg.orientation_covariance, 0.01),
                              (self._imu_msg.angular_velocity_covariance,
                               ImuSensor.GYRO_NOISE_RAD_S ** 2),
                              (self._imu_msg.linear_acceleration_covariance,
                               ImuSensor.ACCEL_NOISE_MPS2 ** 2)):
            matrix[0] = matrix[4] = matrix[8] = value
        laser = self._laser
        self._scan = LaserScan(
            angle_min=0.0, angle_max=2.0 * math.pi - laser.increment_rad,
            angle_increment=laser.increment_rad, scan_time=SCAN_EVERY / RATE_HZ,
            range_min=laser.range_min_m, range_max=laser.range_max_m)
        self._scan.header.frame_id = name + '/laser'
        self._tf = TFMessage([_transform(name, *frames) for frames in (
            ('odom', 'base_link'), ('base_link', 'imu_link'), ('base_link', 'laser'))])
        # Static transforms, for nodes that only read those.
        self._camera = camera = _transform(name, 'base_link', 'camera_rgb_optical_frame')
        camera.transform.translation.z = CAMERA_HEIGHT_M
        self._turn_camera()
        self._fixed = TFMessage([_transform(name, 'base_link', 'laser')])
        (self._tf if self._tools.turns else self._fixed).transforms.append(camera)
        self._origin = TransformStamped(child_frame_id=name + '/odom') if placed else None
        if placed:
            self._origin.header.frame_id = 'map'
            self._tf.transforms.append(self._origin)

    def _turn_camera(self):
        """Turn the camera as its head: level, looking ahead at 0."""
        turn, half = self._camera.transform.rotation, 0.5 * self._tools.pan_rad
        cos, sin = 0.5 * math.cos(half), 0.5 * math.sin(half)
        turn.x, turn.y, turn.z, turn.w = -cos - sin, cos - sin, sin - cos, cos + sin

    def _on_twist(self, message):
        if not self._failing.command(from_twist(message)):
            rospy.logwarn_throttle(1.0, 'refused a velocity that is not finite')

    def run(self):
        """Run until shutdown, in steps of 10 ms; skip missed steps."""
        ticks, ending = Ticks(1.0 / RATE_HZ), threading.Event()
        rospy.on_shutdown(ending.set)
        try:
            while not (ending.is_set() or rospy.is_shutdown()):
                self._step(*ticks.wait())
        except rospy.ROSException:
            # The topics may close during a step, a little before rospy reports its shutdown.
            if not (ending.is_set() or rospy.is_shutdown()):
                raise
        finally:
            self._failing.close()
            self._world.leave()

    def _step(self, tick, now, took):
        """Move, and publish the due messages, without a jump after a long pause of the process."""
        body, dt = self._body, min(took, MAX_STEP_S)
        self._failing.step()
        body.step(dt, now)
        self._world.publish(body.x, body.y, body.yaw)
        self._tools.step(tick, dt, body)
        self._charge = max(0.0, self._charge - dt * (
            1.0 / BATTERY_LIFE_S + self._failing.battery_per_s()))
        stamp = self._failing.stamp()
        self._publish_imu(dt, stamp)
        if self._odometry_due.at(tick):
            self._publish_odometry(stamp)
            if self._mocap_pub is not None and self._mocap_pub.get_num_connections():
                self._publish_true_pose(stamp)
        if self._scan_pub is not None and self._scan_due.at(tick) \
                and self._scan_pub.get_num_connections():
            self._publish_scan(stamp)
        if self._battery_pub is not None and self._battery_due.at(tick):
            self._publish_battery(stamp)

    def _publish_imu(self, dt, stamp):
        gyro, accel = self._imu.measure(self._body, dt)
        if not self._imu_pub.get_num_connections():
            return
        message = self._imu_msg
        message.header.stamp = stamp
        turn = message.orientation
        turn.z, turn.w = turn_of(self._imu.yaw)
        rate, force = message.angular_velocity, message.linear_acceleration
        rate.x, rate.y, rate.z = gyro
        force.x, force.y, force.z = accel
        self._failing.send(self._imu_pub, message)

    def _publish_odometry(self, stamp):
        body = self._body
        z, w = turn_of(body.odom_yaw)
        if self._odom_pub.get_num_connections():
            message = self._odom
            message.header.stamp = stamp
            place, turn = message.pose.pose.position, message.pose.pose.orientation
            place.x, place.y, turn.z, turn.w = body.odom_x, body.odom_y, z, w
            message.twist.twist.linear.x, message.twist.twist.linear.y = body.odom_v, body.odom_u
            message.twist.twist.angular.z = body.odom_w
            self._failing.send(self._odom_pub, message, 'odometry')
        if self._tf_pub.get_num_connections():
            for transform in self._tf.transforms:
                transform.header.stamp = stamp
            move = self._tf.transforms[0].transform.translation
            turn = self._tf.transforms[0].transform.rotation
            move.x, move.y, turn.z, turn.w = body.odom_x, body.odom_y, z, w
            if self._origin is not None:
                self._place_odometry()
            if self._tools.turns:
                self._turn_camera()
            self._failing.send(self._tf_pub, self._tf, 'odometry')

    def _place_odometry(self):
        """Publish the origin of its odometry, including drift."""
        body, transform = self._body, self._origin.transform
        origin = composed(Pose(body.x, body.y, body.yaw),
                          inverse(Pose(body.odom_x, body.odom_y, body.odom_yaw)))
        transform.translation.x, transform.translation.y = origin.x_m, origin.y_m
        transform.rotation.z, transform.rotation.w = turn_of(origin.heading_rad)

    def _publish_scan(self, stamp):
        body = self._body
        discs = np.vstack((self._landmarks, self._world.discs()))
        self._scan.header.stamp = stamp
        self._scan.ranges = self._laser.scan(body.x, body.y, body.yaw, discs).tolist()
        self._failing.send(self._scan_pub, self._scan, 'scan')

    def _publish_true_pose(self, stamp):
        body, message = self._body, PoseStamped()
        message.header.stamp, message.header.frame_id = stamp, 'world'
        message.pose.position.x, message.pose.position.y = body.x, body.y
        turn = message.pose.orientation
        turn.z, turn.w = turn_of(body.yaw)
        self._mocap_pub.publish(message)

    def _publish_battery(self, stamp):
        left = self._charge
        message = BatteryState(
            voltage=11.0 + 1.6 * left, percentage=left, capacity=1.8, design_capacity=1.8,
            charge=1.8 * left, current=float('nan'), present=True,
            power_supply_status=BatteryState.POWER_SUPPLY_STATUS_DISCHARGING,
            power_supply_technology=BatteryState.POWER_SUPPLY_TECHNOLOGY_LIPO)
        message.header.stamp = stamp
        self._failing.send(self._battery_pub, message)
