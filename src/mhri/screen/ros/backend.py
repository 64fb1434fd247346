# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The ROS side of the screen: starts once a master is available, and never blocks the GUI thread.

Its methods are called on the GUI thread and return at once; slow work runs on other threads, and
:meth:`ScreenBackend.take_events` returns its results.
"""
import math
import queue
import threading
import time
from dataclasses import replace

import rosgraph
import rospy

from mhri.base.limits import ZERO
from mhri.base.names import name_problem
from mhri.base.views import (
    ControlView, RobotView, ROS_CONNECTED, ROS_CUT_OFF, ROS_NO_MASTER, ROS_STARTING, ScreenView)
from mhri.camera.ros.picture_relay import PICTURE_RELAY
from mhri.devices.ros.device_client import DeviceClient
from mhri.driving.control import ScreenRole
from mhri.driving.group_speed import pace_words
from mhri.driving.ros.drive_client import DriveClient
from mhri.driving.selection import Selection
from mhri.driving.stop_words import requested_proof
from mhri.graph.ros.log import start_screen_node
from mhri.graph.ros.master_api import MasterApi, MasterError
from mhri.graph.ros.master_watch import MasterWatch
from mhri.graph.ros.peers import limit_peers
from mhri.graph.ros.resources import robot_types
from mhri.graph.ros.rospy_inside import is_initialised
from mhri.graph.ros.worker import Worker
from mhri.recording.recording import CHOICES, RECORDING
from mhri.recording.ros.recordings import Recordings
from mhri.robots.ros.controls import ask_for_control
from mhri.robots.ros.convert import from_twist
from mhri.robots.ros.robot_monitors import RobotMonitors
from mhri.screen.asked import AskedAndDone
from mhri.screen.ros.active_screen import SEAT
from mhri.screen.ros.panel_diagnostics import PanelDiagnostics
from mhri.screen.ros.panel_jobs import PanelJobs
from mhri.screen.ros.panel_requests import PanelRequests
from mhri.screen.status import status_line

NODE_NAME = 'mhri_panel'
FLUSH_S = 0.1
# Maximum time to publish a selection while requesting control [s].
TAKING_S = 3.0
OTHER_SCREEN = 'another screen of this program'


class ScreenBackend:
    """All commands and views of one operator.

    :param argv: the node's command line (remappings)
    :param seat: :class:`mhri.screen.ros.active_screen.ActiveScreen`, shared by the screens of this
        process
    :param clocks: functions that return monotonic time and time of day [s]
    """

    #: whether it may send commands and requests; the screen of a replay may not
    speaks = True

    def __init__(self, argv=(), seat=SEAT, clocks=(time.monotonic, time.time)):
        self._seat, (self.clock, self.wall) = seat, clocks
        self._argv = list(argv)
        self._types, self._type_errors = robot_types()
        self.selection = Selection()
        self.recordings = Recordings()
        self._events = queue.Queue()
        self._drive = DriveClient(self._on_drive, self._on_answer, clocks[0], self.speaks,
                                  self._on_single_stop)
        self._feeder = Worker('feeds')
        self._monitors = RobotMonitors(self._types, self._drive, self._feeder, *clocks)
        self._jobs = PanelJobs(self._types, self._events)
        self._stopped, self._sources_of = False, None
        # Settings made on this screen, None before the first; changes to be merged into them.
        self._settings, self._changes, self._slow = None, {}, False
        self._taking_until = -math.inf
        self._asked = AskedAndDone()
        self._watch = self._requests = self._diagnostics = self._devices = None
        self._role = self._first_mode = None
        # (text, whether it is a refusal) of the last answers about the stop, and about motor power.
        self._stop_note, self._power_note = ('', False), ('', False)
        self._ros = ROS_STARTING
        self._closing = threading.Event()
        self._worker = Worker('panel_jobs', self._supervise)
        self.master_uri = rosgraph.get_master_uri()

    @property
    def settings(self):
        """The current :class:`mhri.screen.settings.PanelSettings`."""
        return self._jobs.settings

    def start(self):
        """Start to wait for a master; return at once."""
        threading.Thread(target=self._connect, name='ros_start', daemon=True).start()

    def _connect(self):
        """Wait for a master, then connect everything (on its own thread)."""
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
        self._role = ScreenRole(rospy.get_name())
        self._drive.start()
        # If a topic is unregistered at once, its subscribers keep trying to connect.
        self._drive.wait_first()
        if self.drives():
            self._drive.start_driving()
        self.repeat_selection()
        self._requests = PanelRequests(self._events)
        self._devices = DeviceClient()
        PICTURE_RELAY.open()
        self._diagnostics = PanelDiagnostics(self, self._drive.strangers).start()
        self._feeder.start()
        self._worker.start()
        self._worker.do(self._supervise)
        self._ros = ROS_CONNECTED
        if self._closing.is_set():
            # close() was called before everything was connected.
            self._closing.clear()
            self.close(forget=True)

    def _supervise(self):
        """Read sources and parameters, and complete the links and types of robots."""
        if not self._watch.lost:
            self._read_sources()
            self._jobs.settle_parameters(self.selection.numbered() if self.drives() else None)
            self.recordings.limits = self.settings.recording_limits()
            self._monitors.supervise()

    def _read_sources(self):
        """Read the names of the sources, and request the mode of the last run."""
        try:
            rows = MasterApi(rospy.get_name()).call_many([('getParam', '/mux/sources')])[0]
        except MasterError as error:
            rospy.logdebug('the sources cannot be read now: %s', error)
            return
        self._devices.follow(rows)
        state = self._drive.state()
        if self._first_mode and state and self._drive.answers():
            if self._first_mode != state.mode:
                self._drive.request_mode(self._first_mode)
            self._first_mode = None

    def _on_drive(self, state, now):
        """Handle the state of the drive (on a ROS thread)."""
        self._role.update(state.operator, now, self._drive.refuses(rospy.get_name()))
        self._monitors.on_drive(state.robots)
        if state.stop_all != self._stopped:
            self._stopped = state.stop_all
            self._monitors.on_stop(state.stop_all, now)
        if (state.run, state.mode) != self._sources_of:
            self._sources_of = state.run, state.mode
            self._worker.do(self._read_sources)

    def _on_answer(self, text):
        self._stop_note = text, bool(text)

    def _on_single_stop(self, problem):
        self._events.put(('single_stop', ''))
        if problem:
            self._events.put(('message', problem))

    def send_stick(self, forward, turn, sideways=0.0):
        """Send the virtual joystick's position, only while in control."""
        if self.drives():
            self._drive.send_stick(forward, turn, sideways)

    def use_accessory(self, robots, key, choice='', value=()):
        """Use an accessory, only while in control; see :class:`DriveClient`."""
        if self.drives():
            self._drive.use_accessory(robots, key, choice, value)

    def request_mode(self, name):
        """Request another source."""
        self._drive.request_mode(name)

    def restore_mode(self, name):
        """Request a source as soon as the drive is running."""
        self._first_mode = name

    def request_limits(self, linear_mps, angular_rad_s):
        """Request another speed limit [m/s, rad/s]."""
        self._change(linear_mps=linear_mps, angular_rad_s=angular_rad_s)

    def keep_together(self, together):
        """Set whether to limit all selected robots to the speed of the slowest."""
        self._change(together=together)

    def brake(self, on):
        """Switch the brake on or off: driven robots slow down for obstacles."""
        self._change(brake=on)

    def _change(self, **settings):
        """Request these settings; does nothing while another operator is in control."""
        if self.drives():
            self._changes.update(settings)
            self.repeat_selection()

    def _requested_settings(self):
        """Return the :class:`Settings` requested by this screen, None before the first change.

        Settings not made here keep their current values, which must be known first.
        """
        if self.settings.slow_with_link != self._slow:
            self._slow = self.settings.slow_with_link
            self._changes['slow_with_link'] = self._slow
        known = self._settings or self._drive.settings()
        if self._changes and known:
            self._settings, self._changes = known._replace(**self._changes), {}
        return self._settings

    def select(self, names):
        """Select exactly these robots; does nothing while another operator is in control."""
        if self.drives():
            self.selection.check(names)
            self._drive.select(self.selection.selected, self._requested_settings())

    def drives(self):
        """Return whether this screen is in control, as far as known."""
        return self._seat.holds(self) and (self._role is None or self._role.drives)

    def repeat_selection(self):
        """Repeat selection and settings, at 2 Hz, to renew the lease.

        Call it only on the GUI thread: if that hangs, the lease must end. A screen that has lost
        control drops its selection and settings, so that they do not return unexpectedly.
        """
        if self._role is None or self._closing.is_set():
            return
        if self.drives():
            self._drive.select(self.selection.selected, self._requested_settings())
        else:
            self.selection.check(())
            self._settings, self._changes, self._slow = None, {}, False
        if self._ros == ROS_CONNECTED and self._publishes() != self._drive.driving:
            self._worker.do(self._settle_publishers)

    def _publishes(self):
        return self.drives() or self._seat.holds(self) and self.clock() < self._taking_until

    def _settle_publishers(self):
        """Register the topics of the active screen, or unregister them (on the worker)."""
        if self._publishes() and not self._closing.is_set():
            if self._drive.start_driving():
                # The selection of another screen of this program no longer counts.
                self._drive.select(self.selection.selected)
        elif not self._closing.is_set():
            self._drive.stop_driving()

    def take_control(self):
        """Take control from any other operator; every robot receives a zero command."""
        self._seat.take(self)
        self.selection.check(())
        self._settings, self._changes, self._slow = None, {}, False
        # The drive service grants control only to a node that publishes a selection.
        self._taking_until = self.clock() + TAKING_S
        self.repeat_selection()
        self._worker.do(self._drive.take_control,
                        lambda done, text: done or self._events.put(('message', text)))

    def set_motor_power(self, on):
        """Cut the motor power of all robots that offer it (False), or restore it (True)."""
        self._drive.set_motor_power(on, self._on_power)

    def _on_power(self, done, text):
        self._power_note = text, not done

    def add(self, name, parameters=None):
        """Add a robot to the list, not selected; return None, or the reason for a refusal."""
        problem = name_problem(name)
        if problem:
            return problem
        if not self.selection.add(name):
            return '{} is in the list already'.format(name)
        self._monitors.add(name)
        self._worker.do(self._monitors.connect, name, parameters)
        return None

    def remove(self, name):
        """Stop a robot and remove it from the list."""
        self.select([other for other in self.selection.selected if other != name])
        self.selection.remove(name)
        link = self._monitors.drop(name)
        if link:
            self._worker.do(link.close)

    def look(self):
        """Search for connected robots; the result is the event ``('found', Found)``."""
        if self._ros != ROS_CONNECTED:
            self._events.put(('look_failed', 'no ROS master at {}'.format(self.master_uri)))
            return
        self._worker.do(self._jobs.look, self.selection.robots)

    def ask_for_control(self, name):
        """Request control of a linked robot; a second request soon after takes it."""
        ask_for_control(name, lambda text: self._events.put(('message', text)))

    def talk(self, pressed):
        """Start or stop push-to-talk at the voice node."""
        if self._devices:
            self._devices.talk(pressed)

    def alarm(self):
        """Rumble the pad, because a robot was lost."""
        if self._devices:
            self._devices.rumble()

    def stop_all(self):
        """Stop every robot; without a master, keep the request until there is one."""
        self._power_note = '', False
        self._drive.stop_all()

    def stop_robots(self, names):
        """Stop these robots alone, and deselect them; each stands until it is selected anew.

        Anybody may stop a robot. Repeated until the drive service answers. Never a toggle.
        """
        self._drive.stop_robots(names)
        self.select([name for name in self.selection.selected if name not in names])

    def release(self):
        """Release STOP ALL, unless the drive service refuses."""
        self._power_note = '', False
        self._drive.release()

    def take_events(self):
        """Return the events since the last call, as a list of tuples."""
        return [self._events.get_nowait() for _ in range(self._events.qsize())]

    def feeds(self, name):
        """Return the :class:`BotFeeds` of a robot, None before they exist."""
        return self._monitors.feeds(name)

    def recordable(self, name):
        """Return the recording options of a robot besides its IMU: keys of ``CHOICES``."""
        kind = self._monitors.robot_type(name)
        return tuple(key for key, _ in CHOICES if key == 'commands' or kind and getattr(kind, key))

    def record(self, name, path, choices):
        """Start recording a robot; :attr:`recordings` has the result."""
        kind = self._monitors.robot_type(name)
        if kind is not None:
            self.recordings.start(name, kind, path, choices)

    def do(self, job, *args):
        """Run a slow job, e.g. on a file, off the GUI thread."""
        self._feeder.do(job, *args)

    def robot_view(self, name):
        """Return the :class:`RobotView` of one robot."""
        return self._robot_view(name, name in self.selection.selected)

    def _robot_view(self, name, selected):
        ours = {'selected': selected, 'number': self.selection.numbers.of(name)}
        if self._ros != ROS_CONNECTED:
            return RobotView(name=name, **ours)
        recording = self.recordings.status(name).state == RECORDING
        view = self._monitors.view(name, recording=recording, **ours)
        if view.proof is None and self._drive.stops(name):
            return replace(view, proof=requested_proof(self._drive.answers()))
        return view

    def _state_of_ros(self):
        """Return the state of the connection, one of ``ROS_*``."""
        if self._ros != ROS_CONNECTED:
            return self._ros
        if rospy.is_shutdown():
            return ROS_CUT_OFF
        return ROS_NO_MASTER if self._watch.lost else self._ros

    def _control(self):
        """Return the :class:`ControlView` of the operator in control."""
        if self.drives():
            return ControlView()
        return self._drive.who() if self._seat.holds(self) else ControlView(False, OTHER_SCREEN)

    def view(self):
        """Return the current :class:`ScreenView`."""
        answers = self._ros != ROS_CONNECTED or self._drive.answers()
        state = self._drive.state() if answers else None
        settings = state and self._drive.settings()
        command = from_twist(state.command) if state else ZERO
        selected = frozenset(self.selection.selected)
        robots = self._asked.compare((self._robot_view(name, name in selected)
                                      for name in self.selection.robots), command, self.clock())
        together, share = (settings.together, state.share) if settings else (False, 1.0)
        said = {'mode': state.mode, 'waits_for': state.waits_for, 'pushed': state.pushed,
                'dead_man': state.dead_man, 'advice': self._drive.advice()} if state else {}
        if settings:
            said.update(limits=settings[:2], brake=settings.brake)
        note, refused = self._stop_note if self._stop_note[0] else self._power_note
        view = ScreenView(
            ros=self._state_of_ros(), stop_all=self._drive.stopped, stop_note=note,
            stop_refused=refused, robots=robots, together=together,
            pace=pace_words(robots, together, share), slowed=share < 1.0,
            camera_bits_per_s=self._monitors.camera_bits_per_s(),
            **(self._devices.view() if self._devices else {}),
            control=self._control(), answers=answers, asked=command,
            stop_taken=bool(state and state.stop_all), **said)
        status, level = status_line(view, self.master_uri)
        return replace(view, status=status, status_level=level)

    def close(self, forget=False):
        """Deselect all robots, so that they stop, and close everything.

        Blocks until the deselection is sent and open bags are closed.

        :param forget: also unregister every topic, in the background, if the program goes on
        """
        if self._closing.is_set():
            return
        self._closing.set()
        if self.drives():
            self._drive.select(())
            self._drive.send_stick(0.0, 0.0)
        self._worker.stop()
        self._feeder.stop()
        self._drive.close()
        for part in filter(None, (self._watch, self._diagnostics)):
            part.stop()
        if self._devices:
            self._devices.close()
        if self._ros == ROS_CONNECTED:
            time.sleep(FLUSH_S)
            self.recordings.close()
            if forget:
                threading.Thread(target=self._forget, name='forget', daemon=True).start()
                return
        self._seat.leave(self)

    def _forget(self):
        self._monitors.close()
        self._drive.unregister()
        self._seat.leave(self)
        self._requests.unregister()
        self._devices.unregister()
        PICTURE_RELAY.close()
