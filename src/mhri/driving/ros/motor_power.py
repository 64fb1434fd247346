# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Cuts and restores one robot's motor power, through a topic or a service of the robot."""
import io
import threading
import time

import genpy
import rospy
from std_srvs.srv import SetBool

from mhri.base.names import topic_of
from mhri.driving.motor_power import CANNOT, MotorPowerRule
from mhri.graph.ros.messages import message_class, MessageMissing, with_field
from mhri.graph.ros.non_blocking import NonBlockingPublisher
from mhri.graph.ros.rospy_inside import listeners
from mhri.graph.ros.worker import Worker
from mhri.robots.listeners import first_obeying

# A service without an answer for this long [s] is called again, in parallel to the pending call.
TIMEOUT_S = 3.0
MAX_CALLS = 3
# How often to check for new subscribers while the power is cut [s].
LOOK_S = 0.2
# Parameter in the robot's namespace while its power is cut, for the next drive.
PARAMETER = 'mhri_motor_power_cut'


class NotDelivered(Exception):
    """A request could not be delivered to a robot; the text gives the reason."""


class PowerTopic:
    """Cuts and restores power by a message, without confirmation."""

    confirms = False

    def __init__(self, robot, spec):
        self._robot = robot
        self._links = ()
        kind = message_class(spec.kind)
        self._messages = {}
        for cut, value in ((True, spec.cut), (False, spec.powered)):
            try:
                self._messages[cut] = with_field(kind(), spec.field, value)
                self._messages[cut].serialize(io.BytesIO())
            except AttributeError:
                raise MessageMissing('{} has no field {}'.format(spec.kind, spec.field)) from None
            except genpy.SerializationError as error:
                raise MessageMissing('{}: {}'.format(spec.kind, error)) from None
        self._publisher = NonBlockingPublisher(topic_of(robot, spec.name), kind)

    def send(self, cut):
        """Publish a request.

        :raises NotDelivered: no node of the robot subscribes
        """
        self._links = self._publisher.links()
        if first_obeying(self._robot, [listeners(self._links)]) is None:
            raise NotDelivered('no robot listens to {}'.format(self._publisher.resolved_name))
        self._publisher.publish(self._messages[cut], urgent=True)

    def has_news(self):
        """Return whether the subscribers have changed since the last request."""
        return self._publisher.links() is not self._links

    def close(self):
        """Unregister the topic (blocking: calls the master)."""
        self._publisher.unregister()


class PowerService:
    """Cuts and restores power by a call of ``std_srvs/SetBool``: true for power on."""

    confirms = True

    def __init__(self, service):
        self._name = service

    def send(self, cut):
        """Call the service (blocking, for as long as the network takes).

        :raises NotDelivered: the service does not answer or refuses
        """
        try:
            answer = rospy.ServiceProxy(self._name, SetBool)(not cut)
        except (rospy.ServiceException, rospy.ROSException) as error:
            raise NotDelivered('{} does not answer: {}'.format(self._name, error)) from None
        if not answer.success:
            raise NotDelivered('{} refuses: {}'.format(
                self._name, answer.message or 'no reason given'))

    @staticmethod
    def has_news():
        """Return False: a confirmed request need not be repeated."""
        return False

    def close(self):
        """Do nothing: every call has its own connection."""


class MotorPower:
    """Cuts and restores a robot's motor power; only :meth:`close` blocks.

    :param robot: the robot's name
    :param robot_type: :class:`mhri.base.robot_types.RobotType`
    """

    def __init__(self, robot, robot_type):
        self._robot = robot
        self._way = None
        self._changed = threading.Condition()
        self._calls = 0
        self._closed = False
        self._rule = MotorPowerRule()
        #: Why the power cannot be cut, or could not be changed, as a sentence; '' if it can.
        self.problem = ''
        try:
            self._way = self._make_way(robot_type.motor_power)
        except MessageMissing as error:
            self.problem = 'cannot cut its motor power: {}'.format(error)
        # The master may hang, and must not delay a cut.
        self._notes = Worker('motor power notes ' + robot, idle_s=3600.0)
        if self._way is not None:
            self._notes.start().do(self._take_over)
            threading.Thread(target=self._run, name='motor power ' + robot, daemon=True).start()

    def _make_way(self, spec):
        """Return the topic or service of a spec, None if the robot type has no spec."""
        if spec is None:
            self.problem = 'its type names no way to cut the power of its motors'
            return None
        return PowerService(topic_of(self._robot, spec.name)) if spec.service else PowerTopic(
            self._robot, spec)

    @property
    def available(self):
        """Whether the power can be cut at all; if not, ``problem`` has the reason."""
        return self._way is not None

    @property
    def is_cut(self):
        """Whether the power should stay cut, even if the request was not delivered yet."""
        return self._rule.is_cut

    @property
    def state(self):
        """A code of :mod:`mhri.driving.motor_power`; '' before the first request."""
        with self._changed:
            return self._rule.state if self._way is not None else CANNOT

    def cut(self):
        """Cut the motor power; keep trying until it succeeds, or until :meth:`restore`."""
        self._ask(True)

    def restore(self):
        """Restore the power. Nothing moves: the base has no command left."""
        self._ask(False)

    def _ask(self, cut):
        if self._way is None:
            return
        with self._changed:
            self._rule.ask(cut, time.monotonic())
            self._changed.notify()
        self._notes.do(self._note)

    def _run(self):
        """Send due requests until closed."""
        while True:
            with self._changed:
                if self._closed:
                    return
                now = time.monotonic()
                if self._rule.is_cut and self._way.has_news():
                    # A base that has just started has not received the request.
                    self._rule.resend(now)
                cut = self._rule.due(now)
                if cut is None or self._calls >= MAX_CALLS:
                    looks = cut is not None or self._rule.is_cut
                    self._changed.wait(LOOK_S if looks else self._rule.wait_s(now))
                    continue
            self._send(cut)

    def _send(self, cut):
        """Send one request; a call without an answer is abandoned on its own thread."""
        done = threading.Event()
        with self._changed:
            self._calls += 1
        threading.Thread(target=self._call, args=(cut, done), daemon=True,
                         name='motor power call ' + self._robot).start()
        if not done.wait(TIMEOUT_S):
            with self._changed:
                self._fail(cut, 'no answer for {:g} s'.format(TIMEOUT_S))

    def _fail(self, cut, problem):
        """Handle a failed request, and log the reason; call it with the lock held."""
        self._rule.on_failed(cut, time.monotonic())
        if problem != self.problem:
            self.problem = problem
            rospy.logwarn('%s: motor power not changed: %s', self._robot, problem)

    def _call(self, cut, done):
        """Send a request, then update the rule, even if the answer comes too late."""
        problem = None
        try:
            self._way.send(cut)
        except NotDelivered as error:
            problem = str(error)
        except Exception as error:  # keep this thread alive: the request counts as failed
            problem = repr(error)
        with self._changed:
            self._calls -= 1
            if problem is None:
                self.problem = ''
                self._rule.on_delivered(cut, self._way.confirms, time.monotonic())
            else:
                self._fail(cut, problem)
            self._changed.notify()
        done.set()

    def _parameter(self):
        return '/{}/{}'.format(self._robot, PARAMETER)

    def _take_over(self):
        """Read from the master whether an earlier process cut the power."""
        try:
            was_cut = rospy.get_param(self._parameter(), False) is True
        except (OSError, rospy.ROSException) as error:
            rospy.logdebug('%s: cannot ask the master: %s', self._robot, error)
            return
        with self._changed:
            if was_cut and not self._rule.state:
                self._rule.ask(True, time.monotonic())
                self._changed.notify()

    def _note(self):
        """Store a cut on the master for the next drive (blocking)."""
        try:
            if self.is_cut:
                rospy.set_param(self._parameter(), True)
            elif rospy.has_param(self._parameter()):
                rospy.delete_param(self._parameter())
        except (OSError, KeyError, rospy.ROSException) as error:
            rospy.logdebug('%s: cannot note it at the master: %s', self._robot, error)

    def close(self):
        """Leave the power as it is, and unregister the topic (blocking: calls the master)."""
        with self._changed:
            self._closed = True
            self._changed.notify()
        self._notes.stop()
        if self._way is not None:
            self._way.close()
