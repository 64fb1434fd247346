# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What has changed from one view of the screen to the next, as an operator would put it.

A state that flaps is reported once: it must last a while before it counts, the longer the less
urgent it is.
"""
from typing import Callable, Dict, Generic, Iterator, List, NamedTuple, Optional, Tuple, TypeVar

from mhri.base.battery import battery_level, FINE, FLAT, LOW
from mhri.base.views import (
    GONE, LIVE, PanelView, PROOF_NOT_CONFIRMED, PROOF_STOPPED, RobotView, ROS_CONNECTED,
    ROS_CUT_OFF, ROS_NO_MASTER, SILENT, UNANSWERED, WAITING)
from mhri.driving.motor_power import CUT, CUT_SENT, FAILED, UNTOUCHED
from mhri.recording.recording import ENDED, FAILED as NOT_RECORDED, RECORDING, RecordingStatus
from mhri.robots.link_quality import link_warning

# How long [s] something must last before it is reported. A loss is reported at once.
BACK_S = 2.0
BAD_LINK_S = 2.0
GOOD_LINK_S = 5.0
GUARD_S = 2.0
SERVICE_S = 1.0
SETTLED_S = 1.0

_T = TypeVar('_T')
# Kind and words.
_Told = Iterator[Tuple[str, str]]
# How an answer of the drive service begins if it refuses.
_REFUSALS = ('not ', 'motor power unchanged')
_FAILED = FAILED.format('')
_BATTERY_WORDS = {LOW: 'battery {:.0f} %: charge it soon', FLAT: 'battery {:.0f} %: charge it now',
                  FINE: 'battery {:.0f} % again'}


class Change(NamedTuple):
    """One thing that has changed: its robot ('' for all), kind and sentence.

    The kind is "subject.what", e.g. ``link.lost``; the last change of a subject holds. ``again``
    is true if it only adds to what was already reported.
    """

    robot: str
    kind: str
    text: str
    again: bool = False


class Held(Generic[_T]):
    """A value that counts once it has held for a while; time is monotonic seconds."""

    def __init__(self, value: _T) -> None:
        self.value = value
        #: since when it has been as it is now [s]
        self.since = 0.0
        self._next = value

    def take(self, value: _T, hold_s: float, now: float) -> bool:
        """Take in the present value; return whether it counts from now on and did not before."""
        if value != self._next:
            self._next, self.since = value, now
        if value == self.value or now - self.since < hold_s:
            return False
        self.value = value
        return True


class RobotChanges:
    """What changes about one robot."""

    def __init__(self, name: str) -> None:
        self._name = name
        self._old = RobotView(name)
        self._link = WAITING
        self._lost_at = 0.0
        self._lost_driven = False
        self._live = Held(False)
        self._bad = Held(False)
        self._guarded = Held(False)
        self._guard_lost = False
        self._battery = FINE
        self._power = UNTOUCHED
        self._pressed = False

    def see(self, view: RobotView, answers: bool, now: float) -> List[Change]:
        """Return what has changed since the last view.

        :param answers: whether the gates are heard; without them guard and power are unknown
        """
        told = list(self._see_link(view, now))
        found = [*self._see_driving(view), *self._see_battery(view), *self._see_switch(view),
                 *self._see_control(view)]
        if view.link == LIVE:
            found += self._see_quality(view, now)
        if answers:
            found += self._see_power(view)
            if view.link == LIVE:
                found += self._see_guard(view, now)
        self._old = view
        return told + [Change(self._name, kind, text) for kind, text in found]

    def _see_link(self, view: RobotView, now: float) -> Iterator[Change]:
        """Report found, silent, gone and back; a robot is back once it has stayed a while."""
        self._live.take(view.link == LIVE, BACK_S if self._link in (SILENT, GONE) else 0.0, now)
        if view.link == LIVE and self._link == WAITING:
            self._link = LIVE
            yield Change(self._name, 'link.found', 'found')
        elif self._live.value and self._link in (SILENT, GONE):
            self._link = LIVE
            yield Change(self._name, 'link.back',
                         'back after {:.0f} s'.format(max(1.0, self._live.since - self._lost_at)))
        elif (view.link, self._link) in ((SILENT, LIVE), (GONE, LIVE), (GONE, SILENT)):
            yield self._lose(view, now)

    def _lose(self, view: RobotView, now: float) -> Change:
        """Report a robot that is no longer heard."""
        again = self._link == SILENT
        self._link = view.link
        if not again:
            self._lost_at = now
            # A robot that is not heard gets zeros and may be unchecked by now: the state before
            # counts, too.
            self._lost_driven = any(seen.selected or seen.driven for seen in (view, self._old))
        kind, word = ('link.silent', 'silent') if view.link == SILENT else ('link.gone', 'gone')
        if self._lost_driven:
            kind, word = 'link.lost', 'still gone' if again else 'lost while driven'
        return Change(self._name, kind, word + (': ' + view.note if view.note else ''), again)

    def _see_driving(self, view: RobotView) -> _Told:
        """Report the check and the proof of a stop."""
        if view.selected != self._old.selected:
            yield ('drive.checked', 'checked') if view.selected else \
                ('drive.unchecked', 'unchecked')
        before = self._old.proof.state if self._old.proof else None
        if view.proof is not None and view.proof.state != before:
            if view.proof.state == PROOF_STOPPED:
                yield 'proof.stopped', view.proof.text
            elif view.proof.state == PROOF_NOT_CONFIRMED:
                yield 'proof.doubtful', view.proof.text

    def _see_control(self, view: RobotView) -> _Told:
        """Report what the robot says of who has control, where several hosts are linked to it."""
        if view.said and view.said != self._old.said:
            yield 'linked.said', view.said

    def _see_battery(self, view: RobotView) -> _Told:
        """Report a battery that is low, flat, or charged again."""
        level = battery_level(view.battery, self._battery)
        if level != self._battery and view.battery is not None:
            yield 'battery.' + level, _BATTERY_WORDS[level].format(100.0 * view.battery)
        self._battery = level

    def _see_switch(self, view: RobotView) -> _Told:
        """Report the robot's own emergency stop."""
        pressed = self._pressed if view.hardware_stop is None else view.hardware_stop
        if pressed != self._pressed:
            yield ('hardware.pressed', 'its own emergency stop is pressed') if pressed else \
                ('hardware.released', 'its own emergency stop is released')
        self._pressed = pressed

    def _see_quality(self, view: RobotView, now: float) -> _Told:
        """Report a link that is bad, or good again."""
        warning = link_warning(view.figures)
        if self._bad.take(bool(warning), BAD_LINK_S if warning else GOOD_LINK_S, now):
            words = 'bad link: ' + warning.replace('bad link: ', '')
            yield ('quality.bad', words) if warning else \
                ('quality.good', 'the link is good again')

    def _see_power(self, view: RobotView) -> _Told:
        """Report changes of its motor power once they are complete."""
        before = self._power
        if view.power.startswith(_FAILED) or view.power in (CUT, CUT_SENT, UNTOUCHED):
            self._power = view.power
        if self._power == before:
            return
        if view.power.startswith(_FAILED):
            yield 'power.failed', 'motor power not changed: ' + view.power[len(_FAILED):]
        elif view.power == UNTOUCHED:
            yield 'power.back', 'motor power restored'
        else:
            yield 'power.cut', 'motor power cut' + (
                '' if view.power == CUT else ': sent to the robot, which cannot confirm it')

    def _see_guard(self, view: RobotView, now: float) -> _Told:
        """Report a guard that has gone, or is back."""
        if not self._guarded.take(view.guarded, 0.0 if view.guarded else GUARD_S, now):
            return
        if not view.guarded:
            yield 'guard.lost', 'its guard does not answer: nothing on the robot checks commands'
        elif self._guard_lost:
            yield 'guard.back', 'its guard is back'
        self._guard_lost = not view.guarded


class RecordingChanges:
    """What happens to the recordings.

    :param status_of: function that returns the :class:`RecordingStatus` of a robot
    """

    def __init__(self, status_of: Callable[[str], RecordingStatus]) -> None:
        self._status_of = status_of
        self._old: Dict[str, RecordingStatus] = {}

    def see(self, names: Tuple[str, ...]) -> List[Change]:
        """Return what has changed; a robot that has left the list counts until its file is closed.

        :param names: the robots in the list
        """
        told: List[Change] = []
        for name in dict.fromkeys((*names, *self._old)):
            status, old = self._status_of(name), self._old.get(name, RecordingStatus())
            told += [Change(name, kind, text) for kind, text in self._tell(old, status)]
            if name in names or status.state == RECORDING:
                self._old[name] = status
            else:
                self._old.pop(name, None)
        return told

    @staticmethod
    def _tell(old: RecordingStatus, status: RecordingStatus) -> _Told:
        """Report start, end and trouble."""
        if status.state == NOT_RECORDED:
            if (old.state, old.note) != (status.state, status.note):
                yield 'recording.failed', 'not recorded: ' + status.note
        elif status.state == ENDED != old.state:
            yield 'recording.ended', status.note or 'recording ended: ' + status.path
        elif status.state == RECORDING:
            if old.state != RECORDING:
                yield 'recording.begun', 'recording to ' + status.path if status.path \
                    else 'recording'
            if status.attention and not (old.attention and old.state == RECORDING):
                yield 'recording.warning', 'recording: ' + status.note


class ScreenChanges:
    """What changes about the whole screen and everything on it.

    :param status_of: as for :class:`RecordingChanges`
    """

    def __init__(self, status_of: Callable[[str], RecordingStatus]) -> None:
        self._old: Optional[PanelView] = None
        self._robots: Dict[str, RobotChanges] = {}
        self._recordings = RecordingChanges(status_of)
        self._mode: Optional[str] = None
        self._master = True
        self._mux = Held(True)
        self._gates = Held(True)
        self._advice = Held('')
        self._limits: Optional[Held[Tuple[float, float]]] = None

    def see(self, view: PanelView, now: float) -> List[Change]:
        """Return what has changed since the last view, in the order in which to report it.

        :param now: seconds of a clock that never goes back
        """
        old = self._old or PanelView(ros=view.ros)
        told = [Change('', kind, text) for kind, text in (
            *self._see_ros(old, view), *self._see_services(view, now),
            *self._see_driver(old, view), *self._see_source(view, now))]
        told += self._see_list(view, now)
        told += self._recordings.see(tuple(robot.name for robot in view.robots))
        self._old = view
        return told

    def _see_list(self, view: PanelView, now: float) -> Iterator[Change]:
        """Report robots that come and go, and what changes about each."""
        names = {robot.name for robot in view.robots}
        for name in [name for name in self._robots if name not in names]:
            del self._robots[name]
            yield Change(name, 'robot.removed', 'taken off the list')
        for robot in view.robots:
            if robot.name not in self._robots:
                self._robots[robot.name] = RobotChanges(robot.name)
                if self._old is not None:
                    yield Change(robot.name, 'robot.added', 'added to the list')
            yield from self._robots[robot.name].see(robot, view.answers, now)

    def _see_ros(self, old: PanelView, view: PanelView) -> _Told:
        """Report the master, and this screen's own end."""
        if view.ros == ROS_CUT_OFF != old.ros:
            yield 'screen.cut_off', 'this screen is cut off and shows nothing new: restart it'
        elif view.ros == ROS_NO_MASTER and self._master:
            self._master = False
            yield 'master.lost', 'no ROS master: looking again every second'
        elif view.ros == ROS_CONNECTED and not self._master:
            self._master = True
            yield 'master.back', 'the ROS master is back'

    def _see_services(self, view: PanelView, now: float) -> _Told:
        """Report mux and gates that fall silent or come back."""
        if view.ros != ROS_CONNECTED:
            return
        if self._mux.take(view.mode is not None, SERVICE_S, now):
            yield ('mux.back', 'what decides who drives is running again') if self._mux.value else \
                ('mux.silent', 'what decides who drives is not running')
        if self._gates.take(view.answers, SERVICE_S, now):
            yield ('gates.back', 'the drive service answers again') if view.answers else \
                ('gates.silent', UNANSWERED + ': no robot can be driven')

    def _see_driver(self, old: PanelView, view: PanelView) -> _Told:
        """Report stop-all, who drives, and what was refused."""
        if view.stop_all != old.stop_all:
            yield ('stop.engaged', 'STOP ALL') if view.stop_all else \
                ('stop.released', 'STOP ALL released')
        if view.control.ours != old.control.ours:
            yield ('control.taken', 'this screen drives now') if view.control.ours else \
                ('control.lost', '{} drives now: this screen looks on'.format(
                    view.control.who or 'somebody else'))
        if view.stop_note != old.stop_note and view.stop_note.lower().startswith(_REFUSALS):
            yield 'request.refused', view.stop_note

    def _see_source(self, view: PanelView, now: float) -> _Told:
        """Report a new source, one that cannot drive, and a new speed limit."""
        if view.mode is None:
            return
        if self._mode not in (None, view.mode):
            yield 'mode.changed', 'driving with {}'.format(
                dict(view.sources).get(view.mode, view.mode))
        self._mode = view.mode
        if self._advice.take(view.advice, SETTLED_S, now):
            yield ('source.trouble', view.advice) if view.advice else \
                ('source.fine', 'what drives is heard again')
        if self._limits is None:
            self._limits = Held(view.limits)
        if self._limits.take(view.limits, SETTLED_S, now):
            yield 'limits.changed', 'speed limit {:.2f} m/s, {:.2f} rad/s'.format(*view.limits)
