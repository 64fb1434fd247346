# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The screen's client of the drive: its last state, and requests to it.

Publishes ``/mux_in/mode_select`` (``mhri/ControlMode``); while this screen drives also
``/mux_in/joy`` (``sensor_msgs/Joy``), ``/mux_in/accessory`` (``mhri/Accessory``) and
``/robot_controller/robot_select`` (``mhri/RobotSelect``, latched).
Subscribes ``/mux/state`` (``mhri/DriveState``, at 2 Hz at least), and accepts only the active mux
(:mod:`mhri.graph.ros.service_owner`). Calls ``/mux/set_stop_all`` (``std_srvs/SetBool``) and
``/mux/stop_robots`` (``mhri/StopRobots``) on a thread each, over connections opened in advance, so
that neither waits for the master or for the other; ``/mux/take_control`` (``std_srvs/Trigger``) and
``/mux/set_motor_power`` (``std_srvs/SetBool``) on another thread.
"""
import math
import threading
import time

import rospy
from sensor_msgs.msg import Joy
from std_srvs.srv import SetBool, Trigger

from mhri.base.reasons import DRIVE_SILENT, Reason
from mhri.base.text import tidy_text
from mhri.base.views import ControlView
from mhri.driving.control import who_drives
from mhri.driving.robot_stops import RobotStops
from mhri.driving.ros.stop_line import LOOK_S, ROBOTS_SERVICE, StopLine
from mhri.driving.settings import Settings
from mhri.graph.ros.node_client import NodeClient
from mhri.graph.ros.non_blocking import NonBlockingPublisher
from mhri.graph.ros.service_owner import RejectedSenders, STOP_SERVICE, TAKE_SERVICE
from mhri.graph.ros.worker import Worker
from mhri.msg import Accessory, ControlMode, DriveSettings, DriveState, RobotSelect

# The drive publishes at 2 Hz: after this long it counts as silent [s].
SILENT_S = 0.9
POWER_SERVICE = '/mux/set_motor_power'


class DriveClient:
    """A screen's state of the drive and its requests; methods return at once unless noted.

    ``strangers`` are nodes that pose as the mux.

    :param on_state: called with (``mhri/DriveState``, received at [s]) on a ROS thread, in order
    :param on_answer: called on a worker with a sentence when the drive has answered a stop or a
        release; '' on success
    :param on_single: called on a worker after a call for a stop of single robots with the problem,
        '' for none
    :param clock: function that returns monotonic seconds
    :param speaks: False for a screen that replays a recording: it sends no requests
    """

    def __init__(self, on_state, on_answer=lambda text: None, clock=time.monotonic, speaks=True,
                 on_single=lambda text: None):
        self._on_state = on_state
        self._on_answer = on_answer
        self._on_single = on_single
        self._clock = clock
        self._speaks = speaks
        #: whether a drive is expected: not in a recording by another program
        self.expected = True
        self._lock = threading.Lock()
        self._state = None
        self._robots = {}
        self._heard_at = -math.inf
        self._first = threading.Event()
        self._pressed = False
        self._single = RobotStops()
        self._line = self._robots_line = self._client = self._select_mode = self._wish = None
        # Held while publishing, so that no topic is unregistered while in use.
        self._wish_lock = threading.Lock()
        self._stopper = Worker('stop_all', self._keep_stopping, LOOK_S)
        self._single_stopper = Worker('stop_robots', self._stop_single, LOOK_S)
        self.strangers = RejectedSenders()

    def start(self):
        """Start subscribing (blocking: calls the master); call it after ``rospy.init_node``."""
        self._line = StopLine(rospy.get_name())
        self._robots_line = StopLine(rospy.get_name(), service=ROBOTS_SERVICE)
        # An older mux may keep its end of the line.
        self._client = NodeClient('drive_calls', STOP_SERVICE, SILENT_S, self.strangers.refuse,
                                  self._on_new_mux)
        if self._speaks:
            self._select_mode = self._client.advertise('/mux_in/mode_select', ControlMode, 10)
            self._stopper.start().do(self._keep_stopping)
            self._single_stopper.start().do(self._stop_single)
        self._client.subscribe('/mux/state', DriveState, self._receive, queue_size=10)
        self._client.start()
        return self

    def _on_new_mux(self, caller):
        """Close the lines: they may be connected to an older mux."""
        self._stopper.do(self._line.close)
        self._single_stopper.do(self._robots_line.close)

    def _receive(self, message):
        now = self._clock()
        with self._lock:
            self._state, self._heard_at = message, now
            self._robots = {robot.name: robot for robot in message.robots}
            self._single.on_state()
            if message.stop_all:
                # From now on the drive keeps the stop, so only its state counts.
                self._pressed = False
        self._on_state(message, now)
        self._first.set()

    def wait_first(self):
        """Wait for the first message, if the drive is running; not on the GUI thread."""
        self._first.wait(SILENT_S)

    def answers(self):
        """Return whether the drive has published recently, or is not expected to."""
        return not self.expected or self._clock() - self._heard_at <= SILENT_S

    def state(self):
        """Return the newest ``mhri/DriveState``, however old; None before the first."""
        return self._state

    def robot(self, name):
        """Return the newest ``mhri/RobotDrive`` of a robot; None if the drive does not know it."""
        with self._lock:
            return self._robots.get(name)

    @property
    def stopped(self):
        """Whether stop-all is in force by the last state, or was requested but not confirmed."""
        return self._pressed or bool(self._state and self._state.stop_all)

    def stops(self, name):
        """Return whether the stop of this single robot was requested but is not confirmed."""
        with self._lock:
            return name in self._single

    def advice(self):
        """Return the :class:`Reason` why the active source cannot drive, None if it can."""
        state = self._state
        return Reason(state.advice, (tidy_text(state.advice_about),)) \
            if state and state.advice else None

    def who(self):
        """Return the :class:`ControlView` of the operator in the last state, if any."""
        state = self._state
        if state is None or not state.operator:
            return ControlView(False)
        since = state.since.to_sec()
        return ControlView(False, who_drives(state.operator, state.computer),
                           time.strftime('%H:%M', time.localtime(since)) if since else '')

    def settings(self):
        """Return the :class:`Settings` in force by the last state; None before the first."""
        said = self._state and self._state.settings
        return Settings(said.linear_mps, said.angular_rad_s, said.together, said.slow_with_link,
                        said.brake) if said and said.linear_mps > 0.0 else None

    def refuses(self, name):
        """Return whether the drive has recently refused the selection of a node."""
        return self._state is not None and any(
            line.startswith(name + ': robot_select') for line in self._state.refused)

    def request_mode(self, name):
        """Request another source; the state reports whether it is active."""
        if self._select_mode is not None:
            self._select_mode.publish(source=name)

    @property
    def driving(self):
        """Whether this screen publishes stick and selection."""
        return self._wish is not None

    def start_driving(self):
        """Start publishing stick and selection (blocking); return False if already started."""
        if self._wish is not None:
            return False
        self._wish = OperatorPublishers()
        return True

    def stop_driving(self):
        """Unregister stick and selection without a last message (blocking: calls the master)."""
        with self._wish_lock:
            wish, self._wish = self._wish, None
        if wish is not None:
            wish.unregister()

    def send_stick(self, forward, turn, sideways=0.0):
        """Publish the virtual joystick: fractions in [-1, 1], forward and left positive."""
        with self._wish_lock:
            if self._wish is not None:
                self._wish.send_stick(forward, turn, sideways)

    def select(self, names, settings=None):
        """Publish the operator's wish; repeating this renews the lease.

        :param names: the selected robots
        :param settings: :class:`mhri.driving.settings.Settings`, None to keep those in force
        """
        with self._wish_lock:
            if self._wish is not None:
                self._wish.select(names, settings)

    def use_accessory(self, robots, key, choice='', value=()):
        """Publish an action of an accessory; what is held is repeated by the caller at 10 Hz.

        :param robots: names; () for all that are selected, where the type's row says ``team``
        :param choice: of a tap, a toggle or a choice
        :param value: of one that is held, from -1 to 1
        """
        with self._wish_lock:
            if self._wish is not None:
                self._wish.use_accessory(robots, key, choice, value)

    def take_control(self, on_answer):
        """Request control for this node.

        :param on_answer: called with (success, a sentence), on the worker
        """
        self._request(on_answer, 'not taken over', TAKE_SERVICE, Trigger)

    def set_motor_power(self, on, on_answer):
        """Cut the motor power of every robot that supports it (False), or restore it (True).

        :param on_answer: as for :meth:`take_control`
        """
        self._request(on_answer, 'motor power unchanged', POWER_SERVICE, SetBool, on)

    def _request(self, on_answer, failure, service, kind, *words):
        def pass_on(answer):
            done = answer is not None and answer.success
            text = answer.message if answer is not None else Reason(DRIVE_SILENT).what
            on_answer(done, text if done else '{}: {}'.format(failure, text))
        if self._client is None:
            pass_on(None)
        else:
            self._client.request(pass_on, service, kind, *words)

    def stop_all(self):
        """Stop every robot; repeat the request until a drive, even one not yet up, confirms."""
        with self._lock:
            self._pressed = True
        if self._client is not None:
            self._stopper.do(self._engage)

    def stop_robots(self, names):
        """Stop these robots alone; repeat the request until a drive answers."""
        with self._lock:
            self._single.ask(names)
        if self._client is not None:
            self._single_stopper.do(self._stop_single)

    def release(self):
        """Request the release of stop-all; it is refused while the stick is not centred."""
        if self._client is None:
            self._pressed = False
        else:
            self._stopper.do(self._release)

    def _engage(self):
        done, words = self._line.call(True)
        if not done:
            self._on_answer('NOT STOPPED yet: {}; asking again'.format(words))
            return
        with self._lock:
            if self._state and self._state.stop_all:
                self._pressed = False
        self._on_answer('')

    def _keep_stopping(self):
        """Repeat an unconfirmed stop request: the drive may be restarting."""
        if self._pressed:
            self._engage()
        else:
            # Connect in advance, so that a stop needs no master.
            self._line.connect()

    def _stop_single(self):
        """Send the requested stops of single robots, if any; else connect in advance."""
        with self._lock:
            names = self._single.take()
        if not names:
            self._robots_line.connect()
            return
        done, words = self._robots_line.call(names)
        with self._lock:
            (self._single.failed if done is None else self._single.answered)(names)
        if done is None:
            words = '{} NOT STOPPED yet: {}; asking again'.format(', '.join(names), words)
        self._on_single('' if done else words)

    def _release(self):
        done, words = self._line.call(False)
        if done:
            with self._lock:
                self._pressed = False
        self._on_answer('' if done else 'not released: ' + words)

    def close(self):
        """Stop the workers; returns at once."""
        for worker, line in ((self._stopper, self._line),
                             (self._single_stopper, self._robots_line)):
            worker.do(self._hang_up, worker, line)
        if self._client is not None:
            self._client.close()

    @staticmethod
    def _hang_up(worker, line):
        line.close()
        worker.stop()

    def unregister(self):
        """Unregister every topic (blocking: calls the master)."""
        self._client.unregister()
        self.stop_driving()


class OperatorPublishers:
    """Publishers of the one screen that drives: virtual joystick, accessories and selection.

    A screen that does not drive has none of them: every new subscriber would also receive its old
    latched selection.
    """

    def __init__(self):
        self._joy = NonBlockingPublisher('/mux_in/joy', Joy)
        # The actions of several accessories may follow each other at once.
        self._accessory = NonBlockingPublisher('/mux_in/accessory', Accessory, queue_size=20)
        self._select = rospy.Publisher('/robot_controller/robot_select', RobotSelect,
                                       queue_size=10, latch=True)

    def send_stick(self, forward, turn, sideways=0.0):
        """Publish the virtual joystick: fractions in [-1, 1], forward and left positive."""
        message = Joy(axes=[turn, forward, sideways], buttons=[])
        message.header.stamp = rospy.Time.now()
        self._joy.publish(message)

    def select(self, names, settings):
        """Publish the operator's wish."""
        self._select.publish(robots=list(names), settings=[DriveSettings(*settings)]
                             if settings else [])

    def use_accessory(self, robots, key, choice, value):
        """Publish an action of an accessory."""
        self._accessory.publish(Accessory(list(robots), key, choice, list(value)))

    def unregister(self):
        """Unregister all (blocking: calls the master)."""
        for topic in (self._select, self._joy, self._accessory):
            topic.unregister()
