# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A robot's own emergency stop, as the robot reports it."""
import rospy

from mhri.base.names import topic_of
from mhri.graph.ros.messages import message_class, MessageMissing, read_field


class HardwareStop:
    """Listens to the topic that a robot type names as ``hardware_stop``.

    The last message counts while a publisher is connected: many publish only once, latched.

    :param robot: the robot's name
    :param robot_type: :class:`mhri.base.robot_types.RobotType`
    """

    def __init__(self, robot, robot_type):
        self._spec = robot_type.hardware_stop
        self._stopped = None
        self._subscriber = None
        self.problem = ''
        if self._spec is None:
            return
        try:
            kind = message_class(self._spec.kind)
            read_field(kind(), self._spec.field)
        except MessageMissing as error:
            self.problem = 'cannot read its emergency stop: {}'.format(error)
        except AttributeError:
            self.problem = 'cannot read its emergency stop: {} has no field {}'.format(
                self._spec.kind, self._spec.field)
        else:
            self._subscriber = rospy.Subscriber(topic_of(robot, self._spec.name), kind, self._hear,
                                                queue_size=1, tcp_nodelay=True)
            return
        rospy.logwarn('%s: %s', robot, self.problem)

    def _hear(self, message):
        self._stopped = read_field(message, self._spec.field) in self._spec.stopped

    @property
    def stopped(self):
        """Whether it holds the robot; None if nothing reports it (any more)."""
        subscriber = self._subscriber
        return self._stopped if subscriber and subscriber.get_num_connections() else None

    def close(self):
        """Stop listening (blocking: it asks the master)."""
        subscriber, self._subscriber = self._subscriber, None
        if subscriber is not None:
            subscriber.unregister()
