# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The ROS side of a screen that shows a replay: it looks, and can ask nobody but the player."""
from dataclasses import replace
import time

import rospy
from std_msgs.msg import UInt32

from mhri.base.views import ControlView, LIVE, PROOF_STOPPED, ROS_CONNECTED
from mhri.graph.ros.node_client import call
from mhri.graph.ros.worker import Worker
from mhri.msg import ReplayState, RobotSelect
from mhri.robots.link_quality import RecordedQuality
from mhri.robots.ros.look import Found
from mhri.screen.ros.backend import ScreenBackend
from mhri.screen.ros.seat import Seat
from mhri.screen.status import CALM
from mhri.session.playing import ReplayClock
from mhri.session.recalled import Recalled
from mhri.srv import ControlReplay

ROBOTS_PARAMETER, DRIVEN_PARAMETER = '/mhri/replay/robots', '/mhri/replay/driven'
CONTROL_SERVICE = '/mhri_replay/control'
NOT_OURS = 'recorded by another program: who drove is not known'
# The player reads its files before it says who was there.
LOOK_S, PATIENCE_S = 0.2, 60.0


class _Named:
    """A robot that was recorded, as one that was found."""

    def __init__(self, name):
        self.name = name


class ReplayBackend(ScreenBackend):
    """What a :class:`ScreenBackend` shows, counted by the session's own time; what it does, not.

    Everything that would ask the mux, the gates or a robot for something does nothing.

    :param argv: the node's command line (remappings)
    :param lines: the :class:`mhri.recording.folder.SessionEvent` values of the session
    """

    speaks = False

    def __init__(self, argv=(), lines=()):
        clock = ReplayClock(time.monotonic)
        super().__init__(argv, Seat(), (clock, clock.wall))
        self._fleet.quality = RecordedQuality
        self.recalled = Recalled(lines)
        #: called, on a ROS thread, when the session jumps: what was heard before counts no more
        self.on_jump = lambda: None
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
            rospy.Subscriber('/robot_controller/robot_select', RobotSelect, self._on_selected,
                             queue_size=10, tcp_nodelay=True)]
        begun = time.monotonic()
        while not self._closing.wait(LOOK_S) and time.monotonic() - begun < PATIENCE_S:
            robots = rospy.get_param(ROBOTS_PARAMETER, None)
            if robots is not None:
                self.selection.numbers.restore({name: number for name, number in robots.items()
                                                if number})
                self._gates.expected = rospy.get_param(DRIVEN_PARAMETER, True)
                self._events.put(('found', Found(live=tuple(map(_Named, robots)),
                                                 facts=dict.fromkeys(robots))))
                return

    def _on_state(self, state):
        jumped = self._state is not None and self._state.jumps != state.jumps
        self._state = state
        if jumped:
            self.on_jump()
        if self._mux is not None:
            self._mux.tell(tuple(state.asked) or (0.0, 0.0), tuple(state.limits) or None)
        self.clock.hear(state.start.to_sec(), state.position_s, state.until_s,
                        state.speed if state.playing else 0.0, state.jumps)
        self._heard.publish(state.number)

    def _on_selected(self, message):
        self._selected = tuple(message.robots)

    def replay(self):
        """Return the newest ``mhri/ReplayState``, None before the first."""
        return self._state

    def control(self, action, value=0.0):
        """Ask the player for something, as ``mhri/ControlReplay`` says; returns at once."""
        self._caller.do(self._control_player, action, value)

    def _control_player(self, action, value):
        answer = call(CONTROL_SERVICE, ControlReplay, action, value, wait_s=1.0)
        if answer is None:
            self._events.put(('told', 'the player does not answer'))
        elif not answer.success:
            self._events.put(('told', answer.message))

    def view(self):
        """Return the :class:`PanelView` of this moment of the session."""
        # The message of an older mhri cannot be read any more; the lines of its session can.
        selected = self.recalled.selected(self.clock.wall())
        self.selection.check(self._selected if selected is None else selected)
        view = super().view()
        if self._gates.expected or view.ros != ROS_CONNECTED:
            return view
        return replace(view, status=NOT_OURS, status_level=CALM)

    def _robot_view(self, name, selected):
        view = super()._robot_view(name, selected)
        now = self.clock.wall()
        proof = self.recalled.proof(name, now)
        if proof is not None and (view.proof is None or proof.state == PROOF_STOPPED
                                  or view.proof.state != proof.state):
            view = replace(view, proof=proof)
        words = self.recalled.link_note(name, now)
        if view.link == LIVE and not view.slow and words:
            return replace(view, note=words, slow=True)
        return view

    def _control(self):
        return ControlView()

    def drives(self):
        """Tell that this screen never drives."""
        return False

    def repeat_selection(self):
        """Leave the selection as it was recorded."""

    def select(self, names):
        """Leave the selection as it was recorded."""

    def _nothing(self, *_):
        """Do nothing: what was done was done then."""

    stop_all = release = take_control = set_motor_power = keep_together = brake = talk = _nothing
    alarm = request_mode = restore_mode = request_limits = send_stick = record = _nothing

    def close(self, forget=False):
        """End; the player is not told."""
        self._caller.stop()
        super().close(forget)
