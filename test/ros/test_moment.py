# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What is noted of a moment of a session: where robots are, by what can be."""
import io
from types import SimpleNamespace

from nav_msgs.msg import Odometry

from mhri.ros.resources import robot_types
from mhri.ros.session.moment import Moment


def moment(x_m, speed_mps):
    """Return the moment of one robot that says so."""
    message, buffer = Odometry(), io.BytesIO()
    message.pose.pose.position.x, message.pose.pose.orientation.w = x_m, 1.0
    message.twist.twist.linear.x = speed_mps
    message.serialize(buffer)

    def newest(topic):
        return SimpleNamespace(fields={'type': 'nav_msgs/Odometry', 'topic': topic},
                               frame=4 * b' ' + buffer.getvalue()) if 'odom' in topic else None
    return Moment(SimpleNamespace(newest=newest),
                  SimpleNamespace(kinds={'bot1': robot_types()[0]['generic']}))


def test_a_robot_is_nowhere_by_odometry_that_cannot_be():
    assert moment(1.5, 0.3).poses() == {'bot1': [1.5, 0.0, 0.0, 'bot1/odom']}
    assert moment(1e30, 0.3).poses() == moment(1.5, 1e30).poses() == {}
