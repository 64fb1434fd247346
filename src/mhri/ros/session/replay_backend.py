# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The ROS side of a screen that shows a replay: it looks, and can ask nobody but the player."""
from dataclasses import replace
import time

import rospy

from mhri.core.robots.link_quality import RecordedQuality
from mhri.core.screen.views import ControlView, LIVE
from mhri.core.session.lines import link_notes
from mhri.core.session.playing import ReplayClock
from mhri.msg import ReplayState, RobotSelect
from mhri.ros.graph.look import Found
from mhri.ros.screen.backend import ScreenBackend
from mhri.ros.screen.seat import Seat
from mhri.ros.worker import Worker
from mhri.srv import ControlReplay

ROBOTS_PARAMETER = '/mhri/replay/robots'
CONTROL_SERVICE = '/mhri_replay/control'
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
    :param lines: the :class:`mhri.core.session.folder.SessionEvent` values of the session
    """

    speaks = False

    def __init__(self, argv=(), lines=()):
        clock = ReplayClock(time.monotonic)
        super().__init__(argv, Seat(), (clock, clock.wall))
        self._fleet.quality = RecordedQuality
        self._link_notes = link_notes(lines)
        self._selected = ()
        self._state = None
        self._topics = []
        self._caller = Worker('replay_calls').start()

    def _connect(self):
        super()._connect()
        if self._closing.is_set():
            return
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
                self._events.put(('found', Found(live=tuple(map(_Named, robots)),
                                                 facts=dict.fromkeys(robots))))
                return

    def _on_state(self, state):
        self._state = state
        if self._mux is not None:
            self._mux.tell(tuple(state.asked) or (0.0, 0.0), tuple(state.limits) or None)
        self.clock.hear(state.start.to_sec(), state.position_s, state.until_s,
                        state.speed if state.playing else 0.0, state.jumps)

    def _on_selected(self, message):
        self._selected = tuple(message.robots)

    def replay(self):
        """Return the newest ``mhri/ReplayState``, None before the first."""
        return self._state

    def control(self, action, value=0.0):
        """Ask the player for something, as ``mhri/ControlReplay`` says; returns at once."""
        self._caller.do(self._control_player, action, value)

    def _control_player(self, action, value):
        try:
            rospy.wait_for_service(CONTROL_SERVICE, timeout=1.0)
            answer = rospy.ServiceProxy(CONTROL_SERVICE, ControlReplay)(action, value)
        except (rospy.ServiceException, rospy.ROSException, OSError) as error:
            rospy.logwarn('%s: %s', CONTROL_SERVICE, error)
            self._events.put(('told', 'the player does not answer'))
            return
        if not answer.success:
            self._events.put(('told', answer.message))

    def view(self):
        """Return the :class:`PanelView` of this moment of the session."""
        self.selection.check(self._selected)
        return super().view()

    def _robot_view(self, name, selected):
        view = super()._robot_view(name, selected)
        now = self.clock.wall()
        words = [words for at_s, words in self._link_notes.get(name, ()) if at_s <= now][-1:]
        if view.link == LIVE and not view.slow and any(words):
            return replace(view, note=words[0], slow=True)
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
