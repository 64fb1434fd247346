# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The ROS side of the panel: starts when there is a master, and never blocks the GUI thread.

Its methods are called on the GUI thread and return at once; slow work runs on
other threads, and its results wait in :meth:`ScreenBackend.take_events`.
"""
import math
import queue
import threading
import time
from dataclasses import replace

import rosgraph
import rospy

from mhri.base.names import name_problem
from mhri.base.views import (
    ControlView, PanelView, RobotView, ROS_CONNECTED, ROS_CUT_OFF, ROS_NO_MASTER, ROS_STARTING)
from mhri.devices.ros.device_client import DeviceClient
from mhri.driving.control import Claim
from mhri.driving.group_speed import pace_words
from mhri.driving.ros.gates_client import GatesClient
from mhri.driving.ros.mux_client import MuxClient
from mhri.driving.selection import Selection
from mhri.graph.ros.log import start_screen_node
from mhri.graph.ros.master_api import MasterApi, MasterError
from mhri.graph.ros.master_watch import MasterWatch
from mhri.graph.ros.peers import limit_peers
from mhri.graph.ros.resources import robot_types
from mhri.graph.ros.rospy_inside import is_initialised
from mhri.graph.ros.worker import Worker
from mhri.recording.recording import CHOICES, RECORDING
from mhri.recording.ros.recordings import Recordings
from mhri.robots.ros.fleet import Fleet
from mhri.screen.asked import AskedAndDone
from mhri.screen.ros.panel_diagnostics import PanelDiagnostics
from mhri.screen.ros.panel_jobs import PanelJobs
from mhri.screen.ros.panel_requests import PanelRequests
from mhri.screen.ros.seat import SEAT
from mhri.screen.status import status_line

NODE_NAME = 'mhri_panel'
FLUSH_S = 0.1
# So long this screen publishes a selection to take control, if it is not given it [s].
TAKING_S = 3.0
OTHER_SCREEN = 'another screen of this program'


class ScreenBackend:
    """Everything one operator can do and see.

    :param argv: the node's command line (remappings)
    :param seat: :class:`mhri.screen.ros.seat.Seat` shared by the screens of this process
    :param clocks: functions that return seconds that never go back, and the time of day [s]
    """

    #: whether it may ask anybody for anything; a screen of a recording may not
    speaks = True

    def __init__(self, argv=(), seat=SEAT, clocks=(time.monotonic, time.time)):
        self._seat, (self.clock, self.wall) = seat, clocks
        self._argv = list(argv)
        self._types, self._type_errors = robot_types()
        self.selection = Selection()
        self.recordings = Recordings()
        self._events = queue.Queue()
        self._gates = GatesClient(self._on_gates, clocks[0])
        self._feeder = Worker('feeds')
        self._fleet = Fleet(self._types, self._gates, self._feeder, *clocks,
                            told=lambda text: self._events.put(('told', text)))
        self.controls = self._fleet.controls
        self._jobs = PanelJobs(self._types, self._events)
        self._pressed = self._stopped_by_gates = False
        # What the operator has set on this screen, None before; what is still to be added.
        self._wish, self._changes, self._slow = None, {}, False
        self._taking_until = -math.inf
        self._asked = AskedAndDone()
        self._mux = self._watch = self._requests = self._diagnostics = self._devices = None
        self._claim = self._first_mode = None
        self._stop_note, self._ros = '', ROS_STARTING
        self._closing = threading.Event()
        self._worker = Worker('panel_jobs', self._supervise)
        self.master_uri = rosgraph.get_master_uri()

    @property
    def settings(self):
        """The :class:`mhri.screen.settings.PanelSettings` in force."""
        return self._jobs.settings

    def start(self):
        """Start looking for a master; returns at once."""
        threading.Thread(target=self._connect, name='ros_start', daemon=True).start()

    def _connect(self):
        """Wait for a master, then open everything (on a thread of its own)."""
        api = MasterApi('/' + NODE_NAME, timeout_s=1.0)
        while not self._closing.is_set() and not is_initialised():
            try:
                api.call('getPid')
                break
            except MasterError:
                self._ros = ROS_NO_MASTER
                self._closing.wait(1.0)
        if self._closing.is_set():
            return
        limit_peers()
        start_screen_node(NODE_NAME, self._argv)
        for error in self._type_errors:
            rospy.logwarn('robot type left out: %s', error)
        self._watch = MasterWatch().start()
        self._claim = Claim(rospy.get_name())
        self._gates.start()
        mux = MuxClient(self._on_answer, lambda: self._worker.do(self._meet_mux), self._pressed,
                        self.speaks)
        # Unregistering a topic at once leaves its subscribers knocking for a while.
        self._gates.wait_first()
        if self.drives():
            mux.take_wheel()
        self._mux = mux
        self.repeat_selection()
        self._requests = PanelRequests(self._events)
        self._devices = DeviceClient()
        self._diagnostics = PanelDiagnostics(self, self._gates, mux).start()
        self._feeder.start()
        self._worker.start()
        self._worker.do(self._supervise)
        self._ros = ROS_CONNECTED
        if self._closing.is_set():
            # Closed before there was all that is to be closed.
            self._closing.clear()
            self.close(forget=True)

    def _supervise(self):
        """Fill in what is missing: the sources of the mux, the links and types of robots."""
        if not self._watch.lost:
            self._meet_mux()
            self._jobs.settle_parameters(self.selection.numbered() if self.drives() else None)
            self.recordings.limits = self.settings.recording_limits()
            self._fleet.supervise()

    def _meet_mux(self):
        """Read the names of the mux's sources, and ask for the mode of the last run."""
        if self._mux is None:
            return
        try:
            rows = MasterApi(rospy.get_name()).call_many([('getParam', '/mux/sources')])[0]
        except MasterError as error:
            rospy.logdebug('the sources cannot be read now: %s', error)
            return
        self._devices.follow(rows)
        mode = self._mux.state()[0]
        if self._first_mode and mode:
            if self._first_mode != mode:
                self._mux.request_mode(self._first_mode)
            self._first_mode = None

    def _on_gates(self, state, now):
        """Take in the state of the gates (on a ROS thread)."""
        self._claim.hear(state.operator, now, self._gates.refuses(rospy.get_name()))
        self._fleet.on_gates(state.robots)
        if state.stop_all != self._stopped_by_gates:
            self._stopped_by_gates = state.stop_all
            self._fleet.on_stop(state.stop_all, now)

    def _on_answer(self, text):
        self._stop_note = text

    def send_stick(self, forward, turn):
        """Send the virtual joystick; does nothing before ROS is there or while others drive."""
        if self._mux and self.drives():
            self._mux.send_stick(forward, turn)

    def request_mode(self, name):
        """Ask the mux to drive from another source."""
        if self._mux:
            self._mux.request_mode(name)

    def restore_mode(self, name):
        """Ask for a source as soon as the mux is running."""
        self._first_mode = name

    def request_limits(self, linear_mps, angular_rad_s):
        """Wish another speed limit [m/s, rad/s]."""
        self._change(linear_mps=linear_mps, angular_rad_s=angular_rad_s)

    def keep_together(self, together):
        """Keep all selected robots to the pace of the slowest, or let each do its best."""
        self._change(together=together)

    def brake(self, on):
        """Let what is driven by hand slow down for obstacles, or not."""
        self._change(brake=on)

    def _change(self, **settings):
        """Wish these settings; does nothing while somebody else is in control."""
        if self.drives():
            self._changes.update(settings)
            self.repeat_selection()

    def _wished(self):
        """Return the :class:`Settings` that this screen wishes, None while its operator set none.

        What was not set here stays as it is in force, which has to be known first.
        """
        if self.settings.slow_with_link != self._slow:
            self._slow = self.settings.slow_with_link
            self._changes['slow_with_link'] = self._slow
        known = self._wish or self._gates.settings()
        if self._changes and known:
            self._wish, self._changes = known._replace(**self._changes), {}
        return self._wish

    def select(self, names):
        """Drive exactly these robots; does nothing while somebody else is in control."""
        if self.drives():
            self.selection.check(names)
            if self._mux:
                self._mux.select(self.selection.selected, self._wished())

    def drives(self):
        """Tell whether this screen may speak for the operator, as far as it knows."""
        return self._seat.holds(self) and (self._claim is None or self._claim.drives)

    def repeat_selection(self):
        """Repeat the operator's wish, at 2 Hz: this renews the lease.

        Call it only on the GUI thread: if that hangs, the lease must end. A screen that has lost
        control drops its selection and its settings: nothing comes back unasked.
        """
        if self._mux is None or self._closing.is_set():
            return
        if self.drives():
            self._mux.select(self.selection.selected, self._wished())
        else:
            self.selection.check(())
            self._wish, self._changes, self._slow = None, {}, False
        if self._wants_wheel() != self._mux.at_wheel:
            self._worker.do(self._settle_wheel)

    def _wants_wheel(self):
        return self.drives() or self._seat.holds(self) and self.clock() < self._taking_until

    def _settle_wheel(self):
        """Register the topics of the screen that drives, or unregister them (on the worker)."""
        if self._wants_wheel() and not self._closing.is_set():
            if self._mux.take_wheel():
                # What another screen of this program selected no longer counts.
                self._mux.select(self.selection.selected)
        elif not self._closing.is_set():
            self._mux.leave_wheel()

    def take_control(self):
        """Become the operator in control, whoever it is now; every robot gets a zero."""
        self._seat.take(self)
        self.selection.check(())
        self._wish, self._changes, self._slow = None, {}, False
        # The gates give it only to somebody who publishes a selection.
        self._taking_until = self.clock() + TAKING_S
        self.repeat_selection()
        self._worker.do(self._gates.take_control,
                        lambda done, text: done or self._events.put(('told', text)))

    def set_motor_power(self, on):
        """Cut the motor power of all robots that offer it (False), or restore it (True)."""
        self._gates.set_motor_power(on, lambda done, text: self._on_answer(text))

    def add(self, name, parameters=None):
        """Add a robot to the list, unchecked; return None, or why not, as a sentence."""
        problem = name_problem(name)
        if problem:
            return problem
        if not self.selection.add(name):
            return '{} is in the list already'.format(name)
        self._fleet.want(name)
        self._worker.do(self._fleet.connect, name, parameters)
        return None

    def remove(self, name):
        """Stop a robot and remove it from the list."""
        self.select([other for other in self.selection.selected if other != name])
        self.selection.remove(name)
        link = self._fleet.drop(name)
        if link:
            self._worker.do(link.close)

    def look(self):
        """Look for connected robots; the result is the event ``('found', Found)``."""
        if self._ros != ROS_CONNECTED:
            self._events.put(('look_failed', 'no ROS master at {}'.format(self.master_uri)))
            return
        self._worker.do(self._jobs.look, self.selection.robots)

    def talk(self, pressed):
        """Start or stop push-to-talk at the voice node."""
        if self._devices:
            self._devices.talk(pressed)

    def alarm(self):
        """Let the operator feel that a robot was lost."""
        if self._devices:
            self._devices.rumble()

    def stop_all(self):
        """Stop every robot; without a master, keep the stop until there is one."""
        self._pressed = True
        if self._mux:
            self._mux.stop_all()

    def release(self):
        """Release stop-all, if the mux agrees."""
        self._pressed = False
        if self._mux:
            self._mux.release()

    def take_events(self):
        """Return the events since the last call, as a list of tuples."""
        return [self._events.get_nowait() for _ in range(self._events.qsize())]

    def feeds(self, name):
        """Return the :class:`BotFeeds` of a robot, None while there are none."""
        return self._fleet.feeds(name)

    def recordable(self, name):
        """Return what can be recorded of a robot besides its IMU: keys of ``CHOICES``."""
        kind = self._fleet.robot_type(name)
        return tuple(key for key, _ in CHOICES if key == 'commands' or kind and getattr(kind, key))

    def record(self, name, path, choices):
        """Start recording a robot; :attr:`recordings` has the result."""
        kind = self._fleet.robot_type(name)
        if kind is not None:
            self.recordings.start(name, kind, path, choices)

    def do(self, job, *args):
        """Do something slow (e.g. with a file) off the GUI thread."""
        self._feeder.do(job, *args)

    def robot_view(self, name):
        """Return the :class:`RobotView` of one robot."""
        return self._robot_view(name, name in self.selection.selected)

    def _robot_view(self, name, selected):
        ours = {'selected': selected, 'number': self.selection.numbers.of(name)}
        if self._ros == ROS_STARTING or self._mux is None:
            return RobotView(name=name, **ours)
        recording = self.recordings.status(name).state == RECORDING
        return self._fleet.view(name, recording=recording, **ours)

    def _state_of_ros(self):
        """Return the state of the connection, one of ``ROS_*``."""
        if self._mux is not None and rospy.is_shutdown():
            return ROS_CUT_OFF
        lost = self._ros == ROS_CONNECTED and self._watch.lost
        return ROS_NO_MASTER if lost else self._ros

    def _control(self):
        """Return who is in control, a :class:`ControlView`."""
        if self.drives():
            return ControlView()
        return ControlView(False, self._gates.who() if self._seat.holds(self) else OTHER_SCREEN)

    def view(self):
        """Return the :class:`PanelView` of this moment."""
        mode, limits, waits_for = self._mux.state() if self._mux else (None, None, None)
        selected = frozenset(self.selection.selected)
        asked = self._mux.asked() if self._mux else (0.0, 0.0)
        robots = self._asked.compare((self._robot_view(name, name in selected)
                                      for name in self.selection.robots), asked, self.clock())
        answers = self._mux is None or self._gates.answers()
        gates = self._gates.state() if answers else None
        together, share = (gates.together, gates.share) if gates else (False, 1.0)
        view = PanelView(
            ros=self._state_of_ros(), mode=mode, brake=bool(gates and gates.brake),
            stop_all=self._stopped_by_gates or (self._mux.stopped if self._mux else self._pressed),
            stop_note=self._stop_note, limits=limits or (0.5, 1.5),
            robots=robots, together=together, pace=pace_words(robots, together, share),
            slowed=share < 1.0, camera_bits_per_s=self._fleet.camera_bits_per_s(),
            **(self._devices.view() if self._devices else {}),
            control=self._control(), answers=answers,
            stop_taken=answers and self._stopped_by_gates, asked=asked, waits_for=waits_for or '',
            pushed=waits_for is not None and self._mux.pushed,
            **({'advice': self._mux.advice, 'dead_man': self._mux.dead_man} if self._mux else {}))
        status, level = status_line(view, waits_for, self.master_uri)
        return replace(view, status=status, status_level=level)

    def close(self, forget=False):
        """Select nothing, so that the robots stop, and end.

        Takes as long as the word needs to leave, and bags that are open need to be closed whole.

        :param forget: unregister every topic as well, in the background: the program lives on
        """
        if self._closing.is_set():
            return
        self._closing.set()
        if self._mux and self.drives():
            self._mux.select(())
            self._mux.send_stick(0.0, 0.0)
        self._worker.stop()
        self._feeder.stop()
        self._gates.close()
        for part in filter(None, (self._watch, self._diagnostics)):
            part.stop()
        for part in filter(None, (self._devices, self._mux)):
            part.close()
        if self._ros == ROS_CONNECTED:
            time.sleep(FLUSH_S)
            self.recordings.close()
            if forget:
                threading.Thread(target=self._forget, name='forget', daemon=True).start()
                return
        self._seat.leave(self)

    def _forget(self):
        self._fleet.close()
        self._gates.unregister()
        self._mux.unregister()
        self._seat.leave(self)
        self._requests.unregister()
        self._devices.unregister()
