# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The ROS side of the panel: comes up when a master is there, and never blocks the GUI thread.

Its methods are called on the GUI thread and return at once; what takes time is
done on threads of its own, and what comes of it waits in :meth:`ScreenBackend.take_events`.
"""
import queue
import threading
import time
from dataclasses import replace

import rosgraph
import rospy

from mhri.core.robots.discovery import parse_ignore_list
from mhri.core.robots.names import name_problem
from mhri.core.driving.group_speed import pace_of
from mhri.core.recording.recording import CHOICES, RECORDING
from mhri.core.driving.selection import Selection
from mhri.core.screen.settings import NAMESPACE, PanelSettings, parse_settings
from mhri.core.screen.source_rows import source_rows
from mhri.core.screen.status import status_line
from mhri.core.screen.views import (
    PanelView, ROS_CONNECTED, ROS_NO_MASTER, ROS_STARTING, RobotView)
from mhri.ros.devices.device_client import DeviceClient
from mhri.ros.doctor.examination import examine
from mhri.ros.robots.fleet import Fleet
from mhri.ros.driving.gates import GateBank
from mhri.ros.graph.look import look_for_robots
from mhri.ros.driving.keeper import KeeperLink
from mhri.ros.graph.master_api import MasterApi, MasterError
from mhri.ros.graph.master_watch import LOST, MasterWatch
from mhri.ros.driving.mux_client import MuxClient
from mhri.ros.screen.panel_diagnostics import PanelDiagnostics
from mhri.ros.screen.panel_requests import PanelRequests
from mhri.ros.recording.recordings import Recordings
from mhri.ros.resources import read_resource, resource_path, robot_types
from mhri.ros.worker import Worker

NODE_NAME = 'mhri_panel'
# The robots in the panel's list, in its order.
ROBOTS_PARAMETER = '/mhri/robots'
FLUSH_S = 0.1
HOLD_S = 0.2


class ScreenBackend:
    """Everything that one operator can do, and all that there is to see.

    :param argv: the node's command line (remappings)
    """

    def __init__(self, argv=()):
        self._argv = list(argv)
        self._types, self._type_errors = robot_types()
        self.selection = Selection()
        self.recordings = Recordings()
        self._events = queue.Queue()
        self._bank = GateBank(on_stop=self._on_stop)
        self._keeper = KeeperLink(self._bank)
        self._feeder = Worker('feeds')
        self._fleet = Fleet(self._types, self._bank, self._feeder, self.recordings.put_command)
        self._holder = Worker('link_watch', self._fleet.hold_silent, HOLD_S)
        self.settings = PanelSettings()
        self._together = False
        self._setting_errors = ()
        self._told_robots = None
        self._mux = None
        self._watch = None
        self._requests = None
        self._devices = None
        self._sources = ()
        self._first_limits = None
        self._first_mode = None
        self._stop_note = ''
        self._ros = ROS_STARTING
        self._closing = threading.Event()
        self._worker = Worker('panel_jobs', self._supervise)
        self.master_uri = rosgraph.get_master_uri()

    def start(self):
        """Begin to look for a master; returns at once."""
        threading.Thread(target=self._connect, name='ros_start', daemon=True).start()

    def _connect(self):
        """Wait for a master, then open everything (on a thread of its own)."""
        api = MasterApi('/' + NODE_NAME, timeout_s=1.0)
        while not self._closing.is_set() and not rospy.core.is_initialized():
            try:
                api.call('getPid')
                break
            except MasterError:
                self._ros = ROS_NO_MASTER
                self._closing.wait(1.0)
        if self._closing.is_set():
            return
        if not rospy.core.is_initialized():
            rospy.init_node(NODE_NAME, argv=self._argv, disable_signals=True)
        for error in self._type_errors:
            rospy.logwarn('robot type left out: %s', error)
        mux = MuxClient(self._bank, self._on_answer, lambda: self._worker.do(self._meet_mux))
        self._watch = MasterWatch().start()
        self._keeper.start()
        self._bank.start()
        self._mux = mux
        if self._bank.stopped:
            mux.stop_all()
        if self._first_limits:
            mux.request_limits(*self._first_limits)
        mux.select(self.selection.selected)
        self._requests = PanelRequests(self._events)
        self._devices = DeviceClient()
        PanelDiagnostics(self).start()
        self._feeder.start()
        self._holder.start()
        self._worker.start()
        self._worker.do(self._supervise)
        self._ros = ROS_CONNECTED

    def _supervise(self):
        """Mend what is missing: the sources of the mux, the links and types of robots."""
        if self._watch.state != LOST:
            self._meet_mux()
            self._settle_parameters()
            self._fleet.supervise()

    def _settle_parameters(self):
        """Read the panel's parameters, and write the list of robots for voice and pad."""
        robots = list(self.selection.robots)
        calls = [('getParam', NAMESPACE)]
        if robots != self._told_robots:
            calls.append(('setParam', ROBOTS_PARAMETER, robots))
        try:
            parameters = MasterApi(rospy.get_name()).call_many(calls)[0]
        except MasterError as error:
            rospy.logdebug('the parameters cannot be read now: %s', error)
            return
        self._told_robots = robots
        self.settings, errors = parse_settings(parameters, self.settings)
        self.recordings.limits = self.settings.recording_limits()
        errors = tuple(str(error) for error in errors)
        if errors != self._setting_errors:
            self._setting_errors = errors
            for text in errors:
                rospy.logwarn('%s', text)

    def _meet_mux(self):
        """Read the names of the mux's sources, and ask for the mode of the last run."""
        if self._mux is None:
            return
        try:
            rows = MasterApi(rospy.get_name()).call_many([('getParam', '/mux/sources')])[0]
        except MasterError as error:
            rospy.logdebug('the sources cannot be read now: %s', error)
            return
        self._sources = source_rows(rows)
        mode = self._mux.state()[0]
        if self._first_mode and mode:
            if self._first_mode != mode:
                self._mux.request_mode(self._first_mode)
            self._first_mode = None

    def _on_stop(self, stopped, now):
        self._fleet.on_stop(stopped, now)

    def _on_answer(self, text):
        self._stop_note = text

    # What the operator does.

    def send_stick(self, forward, turn):
        """Send the virtual joystick; nothing happens before ROS is there."""
        if self._mux:
            self._mux.send_stick(forward, turn)

    def request_mode(self, name):
        """Ask the mux to drive from another source."""
        if self._mux:
            self._mux.request_mode(name)

    def restore_mode(self, name):
        """Ask for a source as soon as the mux is there."""
        self._first_mode = name

    def request_limits(self, linear_mps, angular_rad_s):
        """Ask the mux for another speed limit [m/s, rad/s]."""
        self._first_limits = (linear_mps, angular_rad_s)
        if self._mux:
            self._mux.request_limits(linear_mps, angular_rad_s)

    def keep_together(self, together):
        """Hold all selected robots to what the slowest of them can do, or let each do its best."""
        self._together = together

    def select(self, names):
        """Drive exactly these robots; those no longer among them are stopped before anything."""
        self.selection.check(names)
        chosen = self.selection.selected
        self._bank.deselect_others(chosen)
        if self._mux:
            self._mux.select(chosen)

    def add(self, name, parameters=None):
        """Add a robot to the list, unchecked.

        :returns: None, or why not, as a sentence
        """
        problem = name_problem(name)
        if problem:
            return problem
        if not self.selection.add(name):
            return '{} is in the list already'.format(name)
        self._fleet.want(name)
        self._worker.do(self._fleet.connect, name, parameters)
        return None

    def remove(self, name):
        """Stop a robot and take it out of the list."""
        self.select([other for other in self.selection.selected if other != name])
        self.selection.remove(name)
        link = self._fleet.drop(name)
        if link:
            self._worker.do(link.close)

    def look(self):
        """Look for connected robots; the result comes as the event ``('found', Found)``."""
        if self._ros != ROS_CONNECTED:
            self._events.put(('look_failed', 'no ROS master at {}'.format(self.master_uri)))
            return
        self._worker.do(self._look, self.selection.robots)

    def examine(self):
        """Examine network, master and robots; the result comes as ``('examined', (list, s))``."""
        threading.Thread(target=self._examine, name='doctor', daemon=True).start()

    def _examine(self):
        begun = time.monotonic()
        try:
            found = examine()
        except Exception as error:  # the guard of this thread: the operator is told what failed
            rospy.logerr('the examination failed: %r', error)
            found = 'the examination failed: {}'.format(error)
        self._events.put(('examined', (found, time.monotonic() - begun)))

    def _look(self, known):
        try:
            ignore = parse_ignore_list(read_resource('discovery.yaml'),
                                       resource_path('discovery.yaml'))
            self._events.put(('found', look_for_robots(
                rospy.get_name(), ignore, known, types=self._types)))
        except (MasterError, ValueError, OSError) as error:
            self._events.put(('look_failed', str(error)))

    def talk(self, pressed):
        """Open or close the ear of the voice node (push-to-talk)."""
        if self._devices:
            self._devices.talk(pressed)

    def alarm(self):
        """Let the operator feel that a robot was lost."""
        if self._devices:
            self._devices.rumble()

    def stop_all(self):
        """Stop every robot in the list, now; pressed without a master, it waits for the mux."""
        if self._mux:
            self._mux.stop_all()
        else:
            self._bank.press_stop()

    def release(self):
        """Give up stop-all, where the mux agrees."""
        if self._mux:
            self._mux.release()
        else:
            self._bank.withdraw_press()

    # What there is to see.

    def take_events(self):
        """Return what has come of :meth:`look` since the last call, as a list of tuples."""
        events = []
        while not self._events.empty():
            events.append(self._events.get_nowait())
        return events

    def feeds(self, name):
        """Return the :class:`BotFeeds` of a robot, None while there are none."""
        return self._fleet.feeds(name)

    def recordable(self, name):
        """Return what of a robot can be recorded besides its IMU: keys of ``CHOICES``."""
        kind = self._fleet.robot_type(name)
        return tuple(key for key, _ in CHOICES if key == 'commands' or kind and getattr(kind, key))

    def record(self, name, path, choices):
        """Begin to record a robot; :attr:`recordings` says what comes of it."""
        kind = self._fleet.robot_type(name)
        if kind is not None:
            self.recordings.start(name, kind, path, choices)

    def do(self, job, *args):
        """Do something that may take a while (a file) off the GUI thread."""
        self._feeder.do(job, *args)

    def robot_view(self, name):
        """Return the :class:`RobotView` of one robot."""
        return self._robot_view(name, name in self.selection.selected)

    def _robot_view(self, name, selected):
        if self._ros == ROS_STARTING or self._mux is None:
            return RobotView(name=name, selected=selected)
        return self._fleet.view(name, selected,
                                self.recordings.status(name).state == RECORDING)

    def view(self):
        """Return the :class:`PanelView` of this moment."""
        ros = self._ros
        if ros == ROS_CONNECTED and self._watch.state == LOST:
            ros = ROS_NO_MASTER
        mode, limits, waits_for = self._mux.state() if self._mux else (None, None, None)
        selected = frozenset(self.selection.selected)
        robots = tuple(self._robot_view(name, name in selected)
                       for name in self.selection.robots)
        share, pace = pace_of(robots, self._together, self.settings.slow_with_link)
        self._bank.set_pace(self._together, share)
        view = PanelView(
            ros=ros, sources=self._sources, mode=mode, stop_all=self._bank.stopped,
            stop_note=self._stop_note, limits=limits or self._first_limits or (0.5, 1.5),
            robots=robots, together=self._together, pace=pace,
            slowed=share < 1.0,
            camera_bits_per_s=self._fleet.camera_bits_per_s(),
            heard=self._devices.heard() if self._devices else None)
        status, level = status_line(view, waits_for, self.master_uri)
        return replace(view, status=status, status_level=level)

    def close(self, forget=False):
        """Stop the robots (one zero each) and end.

        Takes as long as a zero needs to leave, and bags that are open need to be closed whole.

        :param forget: give every topic back as well, in the background: for a program that lives on
        """
        if self._closing.is_set():
            return
        self._closing.set()
        self._keeper.end()
        self._bank.close()
        self._worker.stop()
        self._holder.stop()
        self._feeder.stop()
        if self._watch:
            self._watch.stop()
        if self._devices:
            self._devices.close()
        if self._mux:
            self._mux.close()
            time.sleep(FLUSH_S)
            self.recordings.close()
            if forget:
                threading.Thread(target=self._forget, name='forget', daemon=True).start()

    def _forget(self):
        self._fleet.close()
        self._bank.unregister()
        self._mux.unregister()
        self._requests.unregister()
        self._devices.unregister()
