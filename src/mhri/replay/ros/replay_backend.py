# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The backend of a replay's screen: it subscribes, and sends requests only to the player."""
from dataclasses import replace
import time

import rospy
from std_msgs.msg import String, UInt32

from mhri.base.views import ControlView, LIVE, PROOF_STOPPED, ROS_CONNECTED
from mhri.camera.images import DEPTH, RGB
from mhri.graph.ros.node_client import call
from mhri.graph.ros.worker import Worker
from mhri.msg import ReplayState, RobotSelect
from mhri.robots.link_quality import RecordedQuality
from mhri.robots.ros.graph_scan import Found
from mhri.screen.ros.active_screen import ActiveScreen
from mhri.screen.ros.backend import ScreenBackend
from mhri.screen.status import CALM
from mhri.session.playing import ReplayClock
from mhri.session.history import SessionHistory
from mhri.srv import ControlReplay

ROBOTS_PARAMETER, DRIVEN_PARAMETER = '/mhri/replay/robots', '/mhri/replay/driven'
CONTROL_SERVICE = '/mhri_replay/control'
NOT_OURS = 'recorded by another program, or an older mhri: who drove is not known'
# The player reads its files before it publishes the robots.
LOOK_S, TIMEOUT_S = 0.2, 60.0


class _Named:
    """A recorded robot, with the interface of a robot found on the graph."""

    def __init__(self, name):
        self.name = name


class ReplayBackend(ScreenBackend):
    """A read-only :class:`ScreenBackend` whose clock is the session's time.

    All requests to the drive or a robot do nothing.

    :param argv: the node's command line (remappings)
    :param lines: the :class:`mhri.recording.folder.SessionEvent` values of the session
    """

    speaks = False

    def __init__(self, argv=(), lines=()):
        clock = ReplayClock(time.monotonic)
        super().__init__(argv, ActiveScreen(), (clock, clock.wall))
        self._monitors.quality = RecordedQuality
        self.history = SessionHistory(lines)
        #: called, on a ROS thread, when the session jumps, which makes earlier messages invalid
        self.on_jump = lambda: None
        #: {robot: RGB or DEPTH}: the kind of picture that was recorded of it at this time
        self.pictures = {}
        self._selected = ()
        self._state = None
        self._topics = []
        self._caller = Worker('replay_calls').start()

    def _connect(self):
        super()._connect()
        if self._closing.is_set():
            return
        self._heard = rospy.Publisher('/mhri_replay/heard', UInt32, queue_size=10,
                                      tcp_nodelay=True)
        self._topics = [
            rospy.Subscriber('/mhri_replay/state', ReplayState, self._on_state, queue_size=10,
                             tcp_nodelay=True),
            rospy.Subscriber('/mhri_replay/pictures', String, self._on_pictures),
            rospy.Subscriber('/robot_controller/robot_select', RobotSelect, self._on_selected,
                             queue_size=10, tcp_nodelay=True)]
        begun = time.monotonic()
        while not self._closing.wait(LOOK_S) and time.monotonic() - begun < TIMEOUT_S:
            robots = rospy.get_param(ROBOTS_PARAMETER, None)
            if robots is not None:
                self.selection.numbers.restore({name: number for name, number in robots.items()
                                                if number})
                self._drive.expected = rospy.get_param(DRIVEN_PARAMETER, True)
                self._events.put(('found', Found(live=tuple(map(_Named, robots)),
                                                 facts=dict.fromkeys(robots))))
                return

    def _on_state(self, state):
        jumped = self._state is not None and self._state.jumps != state.jumps
        self._state = state
        if jumped:
            self.on_jump()
        self.clock.update(state.start.to_sec(), state.position_s, state.until_s,
                          state.speed if state.playing else 0.0, state.jumps)
        self._heard.publish(state.number)

    def _on_pictures(self, message):
        kinds = {}
        for topic in message.data.split():
            kinds.setdefault(topic.split('/')[1], set()).add(
                DEPTH if 'depth' in topic.lower() else RGB)
        self.pictures = {name: kind for name, found in kinds.items() if len(found) == 1
                         for kind in found}

    def _on_selected(self, message):
        self._selected = tuple(message.robots)

    def replay(self):
        """Return the newest ``mhri/ReplayState``, None before the first."""
        return self._state

    def control(self, action, value=0.0):
        """Send a request to the player, see ``mhri/ControlReplay``; return at once."""
        self._caller.do(self._control_player, action, value)

    def _control_player(self, action, value):
        answer = call(CONTROL_SERVICE, ControlReplay, action, value, wait_s=1.0)
        if answer is None:
            self._events.put(('message', 'the player does not answer'))
        elif not answer.success:
            self._events.put(('message', answer.message))

    def view(self):
        """Return the :class:`ScreenView` at the current time of the session."""
        # Messages of an older mhri can no longer be read; the lines of its session can.
        selected = self.history.selected(self.clock.wall())
        self.selection.check(self._selected if selected is None else selected)
        view = super().view()
        if self._drive.expected or view.ros != ROS_CONNECTED:
            return view
        return replace(view, status=NOT_OURS, status_level=CALM)

    def _robot_view(self, name, selected):
        view = super()._robot_view(name, selected)
        now = self.clock.wall()
        proof, words = self.history.proof(name, now), self.history.link_note(name, now)
        then = {}
        if proof is not None and (view.proof is None or proof.state == PROOF_STOPPED
                                  or view.proof.state != proof.state):
            then['proof'] = proof
        if view.link == LIVE and not view.slow and words:
            then.update(note=words, slow=True)
        return replace(view, **then)

    def _control(self):
        return ControlView()

    def drives(self):
        """Return False: this screen never drives."""
        return False

    def repeat_selection(self):
        """Leave the selection as it was recorded."""

    def select(self, names):
        """Leave the selection as it was recorded."""

    def _nothing(self, *_):
        """Do nothing in a replay."""

    stop_all = stop_robots = release = take_control = set_motor_power = _nothing
    keep_together = brake = talk = alarm = request_mode = restore_mode = _nothing
    request_limits = send_stick = record = _nothing

    def close(self, forget=False):
        """Close the backend; the player continues."""
        self._caller.stop()
        super().close(forget)
