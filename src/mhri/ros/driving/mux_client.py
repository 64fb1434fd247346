# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The panel's side of the mux: requests to it, and its last word on everything.

Publishes ``/mux_in/joy`` (``sensor_msgs/Joy``), ``/mux_in/mode_select`` (``mhri/ControlMode``),
``/mux_in/speed_limit`` (``geometry_msgs/Twist``, latched) and ``/robot_controller/robot_select``
(``mhri/RobotSelect``, latched). Subscribes ``/mux/mode``, ``/mux/speed_limit``, ``/mux/waits_for``.
Calls ``/mux/set_stop_all`` on a thread of its own.
"""
import threading

from geometry_msgs.msg import Twist
import rospy
from sensor_msgs.msg import Joy
from std_msgs.msg import String
from std_srvs.srv import SetBool

from mhri.core.screen.text import tidy_text
from mhri.msg import ControlMode, RobotSelect
from mhri.ros.convert import to_twist
from mhri.ros.graph.rospy_inside import PromptPublisher
from mhri.ros.worker import Worker

STOP_SERVICE = '/mux/set_stop_all'
RETRY_S = 0.5


class MuxClient:
    """What the panel says to the mux and knows of it; every method returns at once.

    :param bank: :class:`mhri.ros.driving.gates.GateBank`, which holds the robots until the mux does
    :param on_answer: called with a sentence when a stop or release was answered, on the worker
    :param on_mode: called when the mux has said its mode, on a ROS thread
    """

    def __init__(self, bank, on_answer, on_mode):
        self._bank = bank
        self._on_answer = on_answer
        self._on_mode = on_mode
        self._lock = threading.Lock()
        self._mode = None
        self._limits = None
        self._waits_for = None
        self._proxy = None
        self._joy = PromptPublisher('/mux_in/joy', Joy)
        self._select_mode = rospy.Publisher('/mux_in/mode_select', ControlMode, queue_size=10)
        self._speed = rospy.Publisher('/mux_in/speed_limit', Twist, queue_size=1, latch=True)
        self._select = rospy.Publisher('/robot_controller/robot_select', RobotSelect,
                                       queue_size=10, latch=True)
        self._heard = rospy.Subscriber('/mux/mode', ControlMode, self._hear_mode, queue_size=10)
        self._topics = [
            self._heard, self._joy, self._select_mode, self._speed, self._select,
            rospy.Subscriber('/mux/speed_limit', Twist, self._on_limits, queue_size=10),
            rospy.Subscriber('/mux/waits_for', String, self._on_waits, queue_size=10)]
        self._stopper = Worker('stop_all', self._keep_stopping, RETRY_S).start()

    def _hear_mode(self, message):
        with self._lock:
            self._mode = tidy_text(message.source)
        self._on_mode()

    def _on_limits(self, message):
        with self._lock:
            self._limits = (message.linear.x, message.angular.z)

    def _on_waits(self, message):
        with self._lock:
            self._waits_for = tidy_text(message.data)

    def state(self):
        """Return (mode, limits, waits_for) as the mux last said; all None while it is not there."""
        if not self._heard.get_num_connections():
            return None, None, None
        with self._lock:
            return self._mode, self._limits, self._waits_for

    def send_stick(self, forward, turn):
        """Publish the virtual joystick: fractions in [-1, 1], forward and left positive."""
        message = Joy(axes=[turn, forward], buttons=[])
        message.header.stamp = rospy.Time.now()
        self._joy.publish(message)

    def request_mode(self, name):
        """Ask for another source; whether it is in force says :meth:`state`."""
        self._select_mode.publish(source=name)

    def request_limits(self, linear_mps, angular_rad_s):
        """Ask for another speed limit."""
        self._speed.publish(to_twist(linear_mps, angular_rad_s))

    def select(self, names):
        """Publish the robots that are checked."""
        self._select.publish(robots=list(names))

    def stop_all(self):
        """Stop every robot: from here at once, and through the mux until it is released."""
        self._bank.press_stop()
        self._stopper.do(self._engage)

    def release(self):
        """Ask the mux to give up stop-all; it refuses while the stick is not centred."""
        self._stopper.do(self._release)

    def close(self):
        """Stop the worker; returns at once."""
        self._stopper.stop()

    def unregister(self):
        """Give every topic back (blocking: it asks the master)."""
        for topic in self._topics:
            topic.unregister()

    def _call(self, value):
        """Call the mux over a connection that is kept open, so that it works without a master."""
        if self._proxy is None:
            self._proxy = rospy.ServiceProxy(STOP_SERVICE, SetBool, persistent=True)
        try:
            return self._proxy(value)
        except (rospy.ServiceException, rospy.ROSException, OSError):
            self._proxy.close()
            self._proxy = None
            raise

    def _try(self, value):
        """Call, and once more over a new connection where the old one was dead."""
        try:
            return self._call(value)
        except (rospy.ServiceException, rospy.ROSException, OSError):
            return self._call(value)

    def _engage(self):
        try:
            self._try(True)
        except (rospy.ServiceException, rospy.ROSException, OSError):
            self._on_answer('the mux does not answer; the robots are held stopped from here')
            return
        self._on_answer('')

    def _keep_stopping(self):
        """While a press is not confirmed by the mux, ask it again: it may just be restarting."""
        if self._bank.stopped and not self._bank.stop_confirmed:
            self._engage()

    def _release(self):
        try:
            answer = self._try(False)
        except (rospy.ServiceException, rospy.ROSException, OSError):
            self._on_answer('not released: the mux does not answer')
            return
        if answer.success:
            self._bank.withdraw_press()
        self._on_answer('' if answer.success else 'not released: ' + answer.message)
