# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The ROS side of the voice: publishes recognised speech, and subscribes robots and mode.

Interfaces beside those of :class:`mhri.devices.ros.input_node.InputNode`:

- publishes ``~heard`` (``mhri/Heard``, each utterance), ``/panel_in/request``
  (``mhri/PanelRequest``), ``/mux_in/mode_select`` (``mhri/ControlMode``)
- calls ``/mux/set_stop_all`` (``std_srvs/SetBool``, true) at a spoken stop
- subscribes ``~push_to_talk`` (``std_msgs/Bool``; true is valid for ``push_to_talk_s`` of the
  language, 10 s, unless it is sent again), ``/mux/mode`` (``mhri/ControlMode``),
  ``/robot_controller/robot_select`` (``mhri/RobotSelect``)
- reads ``/mhri/robots`` (list of names) and ``/mhri/robot_numbers`` ({name: number}) once a second
while it listens; if the panel has not set them, the operator can address the selected robots
- reads the parameters of these robots every two seconds while it listens, for what is said to use
their accessories
"""
import threading
import time

import rospy
from std_msgs.msg import Bool

from mhri.base.names import names_in, NUMBERS, ROBOTS
from mhri.devices.ros.device import Device
from mhri.driving.operator_lease import MAX_ROBOTS
from mhri.driving.ros.stop_line import LOOK_S, StopLine
from mhri.graph.ros import parameters
from mhri.graph.ros.live_parameter import LiveParameter
from mhri.graph.ros.master_api import MasterError
from mhri.graph.ros.resources import read_text, resource_path, robot_types
from mhri.graph.ros.service_owner import ServiceOwner, STOP_SERVICE
from mhri.graph.ros.worker import Worker
from mhri.msg import ControlMode, Heard, PanelRequest, RobotSelect
from mhri.robots.ros.registry import RobotRegistry
from mhri.voice.accessories import spoken_rows
from mhri.voice.grammar import MODE, PANEL, STOP
from mhri.voice.io.voice import VoiceReader
from mhri.voice.language import parse_language
from mhri.voice.names import in_places

VOICE_SOURCE = 'voice'
# A stop that fails is repeated for this long [s], then logged as an error.
_INSIST_S = 3.0
_RETRY_S = 0.2


def voice():
    """Return the :class:`Device`; see :mod:`mhri.nodes.mhri_voice`.

    :raises ConfigError, OSError: the language's file cannot be used
    """
    name = parameters.text('~language', 'english')
    path = name if '/' in name else resource_path('voice', name + '.yaml')
    link = VoiceLink()
    reader = VoiceReader(parse_language(read_text(path), path), path, link.on_heard, link.on_act)
    return Device(reader, {'~source': reader.choose_source, '~voice': reader.choose_voice},
                  start=lambda node: link.start(reader, node.resumed))


class VoiceLink:
    """Publishes recognised speech, and keeps the reader up to date.

    :class:`mhri.voice.io.voice.VoiceReader` calls ``on_heard`` and ``on_act``; they return at once.
    """

    def __init__(self):
        self._reader = None
        self._lock = threading.Lock()
        self._listed = self._selected = ()
        self._numbers = {}
        self._heard = rospy.Publisher('~heard', Heard, queue_size=10)
        self._request = rospy.Publisher('/panel_in/request', PanelRequest, queue_size=10)
        self._mode = rospy.Publisher('/mux_in/mode_select', ControlMode, queue_size=10)
        self._line = StopLine(rospy.get_name())
        # A spoken stop must not depend on the master.
        self._stopper = Worker('stop_all', self._line.connect, LOOK_S).start()
        self._types = Worker('robot_types', self._look)

    def start(self, reader, wanted):
        """Start the subscriptions.

        :param reader: :class:`mhri.voice.io.voice.VoiceReader`
        :param wanted: ``threading.Event``, set while the node listens
        """
        self._reader, self._wanted = reader, wanted
        self._registry = RobotRegistry(robot_types()[0])
        rospy.Subscriber('~push_to_talk', Bool, self._on_push, queue_size=10, tcp_nodelay=True)
        # An older mux may keep its end of the connection open.
        force = ServiceOwner(STOP_SERVICE, on_new=lambda caller: self._stopper.do(self._line.close))
        force.start().subscribe('/mux/mode', ControlMode, self._on_mode, queue_size=10)
        rospy.Subscriber('/robot_controller/robot_select', RobotSelect, self._on_selection,
                         queue_size=1)
        LiveParameter(NUMBERS, {}, self._on_numbers, wanted).start()
        LiveParameter(ROBOTS, [], self._on_robots, wanted).start()
        self._types.start()

    def _on_push(self, message):
        self._reader.push_to_talk(message.data)

    def _on_mode(self, message):
        self._reader.set_drives(message.source == VOICE_SOURCE)

    def _on_robots(self, value):
        with self._lock:
            self._listed = tuple(names_in(value)[:MAX_ROBOTS])
            self._update_robots()

    def _on_numbers(self, value):
        with self._lock:
            self._numbers = value
            self._update_robots()

    def _look(self):
        """Look which accessories the robots have, on the worker."""
        with self._lock:
            names = self._listed or self._selected
        if not self._wanted.is_set():
            return
        for name in self._registry.seen().difference(names):
            # One of its name may come back as another type.
            self._registry.forget(name)
        try:
            types = self._registry.look(names, self._registry.seen())
        except MasterError as error:
            rospy.logdebug('the types of the robots: %s', error)
            return
        self._reader.set_accessories(spoken_rows(
            row for name in names for row in types[name].accessories))

    def _update_robots(self):
        """Update the robots that can be addressed; call it with the lock held."""
        self._reader.set_robots(in_places(self._listed, self._numbers) if self._listed
                                else self._selected)

    def _on_selection(self, message):
        with self._lock:
            # A robot keeps its number once selected.
            self._selected = tuple(dict.fromkeys(
                self._selected + tuple(names_in(message.robots))))[:MAX_ROBOTS]
            self._update_robots()

    def on_heard(self, heard):
        """Publish an utterance."""
        message = Heard(text=heard.text, command=heard.command, accepted=heard.accepted,
                        reason=heard.reason, confidence=heard.confidence)
        message.stamp = rospy.Time.now()
        self._heard.publish(message)

    def on_act(self, command):
        """Carry out a command that is not a motion."""
        if command.kind == STOP:
            self._stopper.do(self._stop_all)
        elif command.kind == MODE:
            self._mode.publish(source=command.action)
        elif command.kind == PANEL:
            self._request.publish(action=command.action, robots=command.robots, key=command.key,
                                  choice=command.choice)

    def _stop_all(self):
        """Engage stop-all, on the worker; retry for a while."""
        deadline = time.monotonic() + _INSIST_S
        wait_s = 0.0
        while not rospy.is_shutdown():
            time.sleep(wait_s)
            done, words = self._line.call(True)
            if done:
                return
            if time.monotonic() > deadline:
                rospy.logerr('a stop was heard, but not taken: %s', words)
                return
            wait_s = _RETRY_S
