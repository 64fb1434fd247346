# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Cuts and restores one robot's motor power, by a topic or a service of the robot."""
import io
import threading
import time

import genpy
import rospy
from std_srvs.srv import SetBool

from mhri.base.names import topic_of
from mhri.driving.motor_power import MotorPowerRule
from mhri.graph.ros.messages import message_class, MessageMissing, with_field
from mhri.graph.ros.prompt import PromptPublisher
from mhri.graph.ros.rospy_inside import listeners
from mhri.graph.ros.worker import Worker
from mhri.robots.listeners import first_obeying

# A service that has not answered for this long [s] is called again, beside the pending call.
PATIENCE_S = 3.0
MOST_CALLS = 3
# How often to look for new listeners while the power is cut [s].
LOOK_S = 0.2
# Parameter below the robot's name while its power is cut, so that whoever takes over knows.
PARAMETER = 'mhri_motor_power_cut'


class NotTold(Exception):
    """A robot could not be told; the text says why."""


class PowerTopic:
    """Tells a robot by a message, which nothing confirms."""

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
        self._publisher = PromptPublisher(topic_of(robot, spec.name), kind)

    def tell(self, cut):
        """Send it.

        :raises NotTold: no node of the robot listens
        """
        self._links = self._publisher.links()
        if first_obeying(self._robot, [listeners(self._links)]) is None:
            raise NotTold('no robot listens to {}'.format(self._publisher.resolved_name))
        self._publisher.publish(self._messages[cut], urgent=True)

    def has_news(self):
        """Tell whether there are listeners that have not been told."""
        return self._publisher.links() is not self._links

    def close(self):
        """Unregister the topic (blocking: it asks the master)."""
        self._publisher.unregister()


class PowerService:
    """Tells a robot by a call of ``std_srvs/SetBool``: true for power."""

    confirms = True

    def __init__(self, service):
        self._name = service

    def tell(self, cut):
        """Call it (blocking, for as long as the network takes).

        :raises NotTold: there is no such service, or it refuses
        """
        try:
            answer = rospy.ServiceProxy(self._name, SetBool)(not cut)
        except (rospy.ServiceException, rospy.ROSException) as error:
            raise NotTold('{} does not answer: {}'.format(self._name, error)) from None
        if not answer.success:
            raise NotTold('{} refuses: {}'.format(self._name, answer.message or 'no reason given'))

    @staticmethod
    def has_news():
        """Return False: a service that has confirmed still knows."""
        return False

    def close(self):
        """Do nothing: every call has a connection of its own."""


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
        #: Why the power cannot be cut, as a sentence; '' if it can.
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
        """Return the topic or service of a spec; None if the type names none."""
        if spec is None:
            self.problem = 'its type names no way to cut the power of its motors'
            return None
        return PowerService(topic_of(self._robot, spec.name)) if spec.service else PowerTopic(
            self._robot, spec)

    @property
    def available(self):
        """Whether the power can be cut at all; if not, ``problem`` says why."""
        return self._way is not None

    @property
    def is_cut(self):
        """Whether the power should stay cut, as far as the robot could be told."""
        return self._rule.is_cut

    @property
    def state(self):
        """The words of :mod:`mhri.driving.motor_power`; '' if nobody has asked."""
        with self._changed:
            return self._rule.state

    def cut(self):
        """Cut the motor power; keep trying until it succeeds, or until :meth:`restore`."""
        self._ask(True)

    def restore(self):
        """Restore the power. This moves nothing: the base has no command left to obey."""
        self._ask(False)

    def _ask(self, cut):
        if self._way is None:
            return
        with self._changed:
            self._rule.ask(cut, time.monotonic())
            self._changed.notify()
        self._notes.do(self._note)

    def _run(self):
        """Do what is due until closed."""
        while True:
            with self._changed:
                if self._closed:
                    return
                now = time.monotonic()
                if self._rule.is_cut and self._way.has_news():
                    # A base that has just started does not know.
                    self._rule.tell_again(now)
                cut = self._rule.due(now)
                if cut is None or self._calls >= MOST_CALLS:
                    looks = cut is not None or self._rule.is_cut
                    self._changed.wait(LOOK_S if looks else self._rule.wait_s(now))
                    continue
            self._tell(cut)

    def _tell(self, cut):
        """Tell the robot once; a call without answer is left behind on its own thread."""
        done = threading.Event()
        with self._changed:
            self._calls += 1
        threading.Thread(target=self._call, args=(cut, done), daemon=True,
                         name='motor power call ' + self._robot).start()
        if not done.wait(PATIENCE_S):
            with self._changed:
                self._rule.on_failed(cut, 'no answer for {:g} s'.format(PATIENCE_S),
                                     time.monotonic())

    def _call(self, cut, done):
        """Tell the robot, then the rule, even if the answer comes too late."""
        problem = None
        try:
            self._way.tell(cut)
        except NotTold as error:
            problem = str(error)
        except Exception as error:  # the guard of this thread: the robot is not told
            problem = repr(error)
        with self._changed:
            self._calls -= 1
            if problem is None:
                self._rule.on_told(cut, self._way.confirms, time.monotonic())
            else:
                self._rule.on_failed(cut, problem, time.monotonic())
            self._changed.notify()
        done.set()

    def _parameter(self):
        return '/{}/{}'.format(self._robot, PARAMETER)

    def _take_over(self):
        """Learn from the master whether an earlier process cut the power."""
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
        """Note it at the master for whoever takes over (blocking)."""
        try:
            if self.is_cut:
                rospy.set_param(self._parameter(), True)
            elif rospy.has_param(self._parameter()):
                rospy.delete_param(self._parameter())
        except (OSError, KeyError, rospy.ROSException) as error:
            rospy.logdebug('%s: cannot tell the master: %s', self._robot, error)

    def close(self):
        """Leave the power as it is, and unregister the topic (blocking: it asks the master)."""
        with self._changed:
            self._closed = True
            self._changed.notify()
        self._notes.stop()
        if self._way is not None:
            self._way.close()
