# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The panel's side of the mux: requests to it, and what it said last.

Publishes ``/mux_in/mode_select`` (``mhri/ControlMode``); while this screen drives also
``/mux_in/joy`` (``sensor_msgs/Joy``) and ``/robot_controller/robot_select`` (``mhri/RobotSelect``,
latched).
Subscribes ``/mux/mode``, ``/mux/speed_limit``, ``/mux/waits_for``, ``/mux/pushed``,
``/mux/advice``, ``/mux/dead_man``, ``/mux/asked`` and ``/robot_controller/stop_all``, and believes
only the mux in force (:mod:`mhri.graph.ros.in_force`). Calls ``/mux/set_stop_all`` on a thread of
its own, over a line that is open before it is needed.
"""
import threading
import time

from geometry_msgs.msg import Twist
import rospy
from sensor_msgs.msg import Joy
from std_msgs.msg import Bool, String

from mhri.base.limits import speed_limit_problem
from mhri.base.text import tidy_text
from mhri.driving.ros.stop_line import LOOK_S, StopLine
from mhri.graph.ros.in_force import InForce, STOP_SERVICE, Strangers
from mhri.graph.ros.prompt import PromptPublisher
from mhri.graph.ros.rospy_inside import publishers
from mhri.graph.ros.worker import Worker
from mhri.msg import ControlMode, DriveSettings, RobotSelect

# The mux tells a command at least ten times a second: an older one is over.
ASKED_S = 0.3


class MuxClient:
    """What the panel tells the mux and knows about it; every method returns at once.

    :param on_answer: called on the worker with a sentence when the mux has answered
    :param on_mode: called on a ROS thread when the mux has published its mode
    :param pressed: whether stop-all was pressed before there was a mux to tell
    :param speaks: False for a screen that looks at what was recorded: it requests nothing, and
        has nothing to do with any topic of velocities
    ``strangers`` are nodes that pose as the mux.
    """

    def __init__(self, on_answer, on_mode, pressed=False, speaks=True):
        self._on_answer = on_answer
        self._on_mode = on_mode
        self._lock = threading.Lock()
        self._mode = None
        self._limits = None
        self._waits_for = None
        self._asked, self._asked_at = (0.0, 0.0), 0.0
        self._speaks = speaks
        #: what keeps the active source from driving, as a sentence; '' for nothing
        self.advice = ''
        #: whether the dead-man buttons of pads must be held
        self.dead_man = True
        #: whether the stick of the active source is held
        self.pushed = False
        self._pressed = pressed
        self._stopped = False
        self._line = StopLine(rospy.get_name())
        self._stopper = Worker('stop_all', self._keep_stopping, LOOK_S)
        self._wheel = None
        # Held while publishing, so that nothing is unregistered while in use.
        self._wheel_lock = threading.Lock()
        self._select_mode = None
        if speaks:
            self._select_mode = rospy.Publisher('/mux_in/mode_select', ControlMode, queue_size=10)
        self.strangers = Strangers()
        # An older mux may keep its end of the line.
        self._force = InForce(STOP_SERVICE, self.strangers.refuse,
                              lambda caller: self._stopper.do(self._line.close))
        self._heard, *heard = [
            self._force.subscribe(name, kind, hear, queue_size=10, tcp_nodelay=True)
            for name, kind, hear in (
                ('/mux/mode', ControlMode, self._hear_mode),
                ('/mux/speed_limit', Twist, self._on_limits),
                ('/mux/waits_for', String, self._on_waits),
                ('/mux/pushed', Bool, self._on_pushed),
                ('/mux/advice', String, self._on_advice),
                ('/mux/dead_man', Bool, self._on_dead_man),
                ('/robot_controller/stop_all', Bool, self._hear_stop),
                ('/mux/asked', Twist, self._on_asked)) if speaks or kind != Twist]
        self._topics = list(filter(None, (self._heard, self._select_mode, *heard)))
        self._force.start()
        self._stopper.start()
        if pressed:
            self._stopper.do(self._engage)

    def _hear_stop(self, message):
        with self._lock:
            self._stopped = message.data
            if message.data:
                # From here on the mux keeps the stop: only its word counts.
                self._pressed = False

    @property
    def stopped(self):
        """Whether stop-all is in force, or was pressed and is not confirmed yet."""
        return self._pressed or self._stopped

    @property
    def stop_taken(self):
        """Whether the mux has stop-all in force."""
        return self._stopped

    def _hear_mode(self, message):
        with self._lock:
            self._mode = tidy_text(message.source)
        self._on_mode()

    def _on_limits(self, message):
        problem = speed_limit_problem(message.linear.x, message.angular.z)
        if problem:
            rospy.logwarn_throttle(1.0, '/mux/speed_limit: refused, {}'.format(problem))
            return
        with self._lock:
            self._limits = (message.linear.x, message.angular.z)

    def _on_waits(self, message):
        with self._lock:
            self._waits_for = tidy_text(message.data)

    def _on_asked(self, message):
        self._asked, self._asked_at = (message.linear.x, message.angular.z), time.monotonic()

    def asked(self):
        """Return what the mux commands now (m/s, rad/s); it repeats whatever is not zero."""
        return self._asked if not self._speaks or time.monotonic() - self._asked_at < ASKED_S \
            else (0.0, 0.0)

    def tell(self, asked, limits):
        """Take in what the mux commanded then, and its limits (None: not known)."""
        self._asked, self._limits = asked, limits

    def _on_advice(self, message):
        self.advice = tidy_text(message.data)

    def _on_dead_man(self, message):
        self.dead_man = message.data

    def _on_pushed(self, message):
        self.pushed = message.data

    def state(self):
        """Return (mode, limits, waits_for) as last published by the mux; None without it."""
        if self._force.caller not in publishers(self._heard):
            return None, None, None
        with self._lock:
            return self._mode, self._limits, self._waits_for

    def send_stick(self, forward, turn):
        """Publish the virtual joystick: fractions in [-1, 1], forward and left positive."""
        with self._wheel_lock:
            if self._wheel is not None:
                self._wheel.send_stick(forward, turn)

    def request_mode(self, name):
        """Ask for another source; :meth:`state` says whether it is in force."""
        if self._select_mode is not None:
            self._select_mode.publish(source=name)

    def select(self, names, settings=None):
        """Publish the operator's wish; repeating this renews the lease.

        :param names: the checked robots
        :param settings: :class:`mhri.driving.settings.Settings`, None: as they are
        """
        with self._wheel_lock:
            if self._wheel is not None:
                self._wheel.select(names, settings)

    @property
    def at_wheel(self):
        """Whether this screen publishes stick and selection."""
        return self._wheel is not None

    def take_wheel(self):
        """Publish stick and selection from now on (blocking); return whether that is a change."""
        if self._wheel is not None:
            return False
        self._wheel = Wheel()
        return True

    def leave_wheel(self):
        """Unregister stick and selection as they are (blocking: it asks the master)."""
        with self._wheel_lock:
            wheel, self._wheel = self._wheel, None
        if wheel is not None:
            wheel.unregister()

    def stop_all(self):
        """Stop every robot through the mux; ask again until it confirms."""
        with self._lock:
            self._pressed = True
        self._stopper.do(self._engage)

    def release(self):
        """Ask the mux to release stop-all; it refuses while the stick is not centred."""
        self._stopper.do(self._release)

    def close(self):
        """Stop the worker; returns at once."""
        self._stopper.do(self._hang_up)
        self._force.stop()

    def _hang_up(self):
        self._line.close()
        self._stopper.stop()

    def unregister(self):
        """Unregister every topic (blocking: it asks the master)."""
        for topic in self._topics:
            topic.unregister()
        self.leave_wheel()

    def _engage(self):
        done, words = self._line.call(True)
        if not done:
            self._on_answer('NOT STOPPED yet: {}; asking again'.format(words))
            return
        with self._lock:
            if self._stopped:
                self._pressed = False
        self._on_answer('')

    def _keep_stopping(self):
        """Ask the mux again until it confirms a press: it may be restarting."""
        if self._pressed:
            self._engage()
        else:
            # A press must not need the master.
            self._line.connect()

    def _release(self):
        done, words = self._line.call(False)
        if done:
            with self._lock:
                self._pressed = False
        self._on_answer('' if done else 'not released: ' + words)


class Wheel:
    """What only one screen at a time may publish: the virtual joystick and the selection.

    A screen that does not drive has no publisher of them: every new node would be told its old
    latched selection, too.
    """

    def __init__(self):
        self._joy = PromptPublisher('/mux_in/joy', Joy)
        self._select = rospy.Publisher('/robot_controller/robot_select', RobotSelect,
                                       queue_size=10, latch=True)

    def send_stick(self, forward, turn):
        """Publish the virtual joystick: fractions in [-1, 1], forward and left positive."""
        message = Joy(axes=[turn, forward], buttons=[])
        message.header.stamp = rospy.Time.now()
        self._joy.publish(message)

    def select(self, names, settings):
        """Publish the operator's wish."""
        self._select.publish(robots=list(names), settings=[DriveSettings(*settings)]
                             if settings else [])

    def unregister(self):
        """Unregister both (blocking: it asks the master)."""
        for topic in (self._select, self._joy):
            topic.unregister()
