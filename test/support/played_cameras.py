# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Cameras of robots that draw their pictures on computers of their own: played from a bag.

Four simulated cameras take most of a core, which no real robot takes from the operator's computer.
Here what they would see on a drive is drawn beforehand and ``rosbag play`` (C++) sends it.
"""
import math
import os

import numpy as np

TOPIC = 'played/image_raw'
RATE_HZ = 30.0


def _place(share):
    """Return the pose at some share of a drive around the hall."""
    angle = 2.0 * math.pi * share
    return 6.0 + 4.0 * math.cos(angle), 2.1 + 1.5 * math.sin(angle), 3.0 * angle


def write_bag(path, names, seconds, every=1, odometry=False):
    """Write the compressed pictures, 640 x 480, of some robots' cameras.

    :param every: each picture is drawn once and sent so many times, which is sooner done
    :param odometry: write that, too, with each picture
    """
    import rosbag
    import rospy
    from nav_msgs.msg import Odometry
    from sensor_msgs.msg import CompressedImage
    from mhri.graph.ros.resources import read_text, resource_path
    from mhri.sim.camera import Camera
    from mhri.sim.plan import parse_plan
    from mhri.sim.ros.camera_node import compress
    plan_path = resource_path('sim', 'plan.yaml')
    camera = Camera(parse_plan(read_text(plan_path), plan_path))
    nobody = np.zeros(0, [('x', '<f8'), ('y', '<f8'), ('radius', '<f8'), ('height', '<f8'),
                          ('colour', 'u1', 3)])
    count, drawn = round(seconds * RATE_HZ), {}
    with rosbag.Bag(path, 'w') as bag:
        for number in range(count):
            for index, name in enumerate(names):
                pose = _place((number / count + index / len(names)) % 1.0)
                if number % every == 0:
                    drawn[name] = compress(camera.rgb(camera.look(*pose, nobody)))
                fmt, data = drawn[name]
                # Cameras are not in step with each other.
                stamp = rospy.Time.from_sec(1.0 + (number + index / len(names)) / RATE_HZ)
                message = CompressedImage(format=fmt, data=data)
                message.header.stamp = stamp
                bag.write('/{}/{}/compressed'.format(name, TOPIC), message, stamp)
                if odometry:
                    bag.write('/{}/odom'.format(name), _odometry(Odometry(), stamp, pose), stamp)


def _odometry(message, stamp, pose):
    """Fill a message in."""
    message.header.stamp = stamp
    message.pose.pose.position.x, message.pose.pose.position.y = pose[:2]
    message.pose.pose.orientation.z = math.sin(pose[2] / 2.0)
    message.pose.pose.orientation.w = math.cos(pose[2] / 2.0)
    message.twist.twist.linear.x, message.twist.twist.angular.z = 0.3, 0.2
    return message


def play_cameras(system, names, seconds=5.0, every=1, odometry=False):
    """Play cameras over and over; the robots' templates name the played ones from now on.

    Call it before the panel reads what the robots are, and with robots that have started: a
    simulated one would take the topic for its own.

    :param system: :class:`support.ros_system.System`
    :param every, odometry: as for :func:`write_bag`
    """
    import rospy
    path = os.path.join(system.home, 'cameras.bag')
    write_bag(path, names, seconds, every, odometry)
    for name in names:
        rospy.set_param('/{}/mhri/rgb'.format(name), [TOPIC])
    return system.start('rosbag', 'play', '--quiet', '--loop', path)
