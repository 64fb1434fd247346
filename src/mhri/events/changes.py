# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Changes from one view of the screen to the next, in the operator's terms.

A flapping state is reported once: it must last a while before it counts, the longer the less
urgent it is.
"""
from math import isfinite
from typing import Callable, Dict, Generic, Iterator, List, Optional, Tuple, TypeVar

from mhri.base.accessories import Accessory, READOUT
from mhri.base.battery import battery_level, FINE, FLAT, LOW
from mhri.base.reasons import DRIVE_SILENT, HARDWARE_STOP, Reason
from mhri.base.views import (
    Change, GONE, LIVE, PROOF_NOT_CONFIRMED, PROOF_STOPPED, RobotView, ROS_CONNECTED, ROS_CUT_OFF,
    ROS_NO_MASTER, ScreenView, SILENT, WAITING)
from mhri.driving.motor_power import CUT, CUT_ASKED, CUT_SENT, FAILED, ON, RESTORE_ASKED
from mhri.recording.recording import ENDED, FAILED as NOT_RECORDED, RECORDING, RecordingStatus
from mhri.robots.link_quality import link_warning

# Time for which a state must last before it is reported [s]; a loss is reported at once.
BACK_S = 2.0
BAD_LINK_S = 2.0
GOOD_LINK_S = 5.0
GUARD_S = 2.0
WITHIN_S = 1.0
SERVICE_S = 1.0
SETTLED_S = 1.0

_T = TypeVar('_T')
# (kind, text).
_Changes = Iterator[Tuple[str, str]]
_POWER = {
    CUT: ('power.cut', 'motor power cut'),
    CUT_SENT: ('power.cut', 'motor power cut: sent to the robot, which cannot confirm it'),
    FAILED: ('power.failed', 'motor power not changed: the log says why'),
    ON: ('power.back', 'motor power restored')}
_BATTERY_WORDS = {LOW: 'battery {:.0f} %: charge it soon', FLAT: 'battery {:.0f} %: charge it now',
                  FINE: 'battery {:.0f} % again'}


def _readout_words(spec: Accessory, value: float, beyond: bool) -> str:
    """Return what a sensor measures, and its limit: "gas 62 ppm, above 50", "bumper left"."""
    words = '{} {}'.format(spec.label, spec.reading(value))
    if not beyond:
        return spec.label + ' clear again' if spec.bits else words + ' again'
    if spec.bits:
        return words
    above = spec.warn_above is not None and value > spec.warn_above
    return '{}, {} {:g}'.format(words, *(('above', spec.warn_above) if above
                                         else ('below', spec.warn_below)))


class Held(Generic[_T]):
    """A debounced value, which counts once it has held for a while; times are [s, monotonic]."""

    def __init__(self, value: _T) -> None:
        self.value = value
        #: time of the last change of the raw value [s]
        self.since = 0.0
        self._next = value

    def take(self, value: _T, hold_s: float, now: float) -> bool:
        """Handle the raw value; return whether the debounced value changes to it now."""
        if value != self._next:
            self._next, self.since = value, now
        if value == self.value or now - self.since < hold_s:
            return False
        self.value = value
        return True


class RobotChanges:
    """Changes of one robot."""

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
        self._power = ON
        self._pressed = False
        self._beyond: Dict[str, Held[bool]] = {}
        self._choices: Dict[str, str] = {}

    def update(self, view: RobotView, answers: bool, now: float) -> List[Change]:
        """Return the changes since the last view.

        :param answers: whether the drive service answers; else guard and power are unknown
        """
        changes = list(self._link_changes(view, now))
        found = [*self._driving_changes(view), *self._battery_changes(view),
                 *self._switch_changes(view), *self._control_changes(view)]
        if view.link == LIVE:
            found += self._quality_changes(view, now)
        if answers:
            found += self._power_changes(view)
            if view.link == LIVE:
                found += self._guard_changes(view, now)
        self._old = view
        changes += [Change(self._name, kind, text) for kind, text in found]
        return changes + list(self._readout_changes(view, now)) + list(
            self._accessory_changes(view))

    def _link_changes(self, view: RobotView, now: float) -> Iterator[Change]:
        """Report found, silent, gone and back; a robot is back once live for a while."""
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
        """Report a lost robot."""
        again = self._link == SILENT
        self._link = view.link
        if not again:
            self._lost_at = now
            # Include the previous state: a lost robot receives zeros and may already be
            # deselected.
            self._lost_driven = any(seen.selected or seen.driven for seen in (view, self._old))
        kind, word = ('link.silent', 'silent') if view.link == SILENT else ('link.gone', 'gone')
        if self._lost_driven:
            kind, word = 'link.lost', 'still gone' if again else 'lost while driven'
        return Change(self._name, kind, word + (': ' + view.note if view.note else ''), again)

    def _driving_changes(self, view: RobotView) -> _Changes:
        """Report selection, and the proof of a stop."""
        if view.selected != self._old.selected:
            yield ('drive.checked', 'selected') if view.selected else \
                ('drive.unchecked', 'deselected')
        before = self._old.proof.state if self._old.proof else None
        if view.proof is not None and view.proof.state != before:
            if view.proof.state == PROOF_STOPPED:
                yield 'proof.stopped', view.proof.text
            elif view.proof.state == PROOF_NOT_CONFIRMED:
                yield 'proof.doubtful', view.proof.text

    def _control_changes(self, view: RobotView) -> _Changes:
        """Report the host in control, if several are linked to the robot."""
        if view.said and view.said != self._old.said:
            yield 'linked.said', view.said

    def _battery_changes(self, view: RobotView) -> _Changes:
        """Report a change of the battery's level."""
        level = battery_level(view.battery, self._battery)
        if level != self._battery and view.battery is not None:
            yield 'battery.' + level, _BATTERY_WORDS[level].format(100.0 * view.battery)
        self._battery = level

    def _readout_changes(self, view: RobotView, now: float) -> Iterator[Change]:
        """Report a sensor beyond its limits at once, and back within them after a while."""
        for sensor in view.accessories:
            spec = sensor.spec
            if spec.kind != READOUT or sensor.stands or not all(map(isfinite, sensor.value)):
                continue
            for value in sensor.value:
                held = self._beyond.setdefault(spec.key, Held(False))
                beyond = spec.warns(value)
                if held.take(beyond, 0.0 if beyond else WITHIN_S, now):
                    yield Change(self._name, 'readout.beyond' if beyond else 'readout.within',
                                 _readout_words(spec, value, beyond),
                                 data={'readout': spec.key, 'value': value, 'unit': spec.unit})

    def _accessory_changes(self, view: RobotView) -> Iterator[Change]:
        """Report another choice of an accessory; its first report is none."""
        for accessory in view.accessories:
            spec, choice = accessory.spec, accessory.choice
            if not accessory.known or spec.kind == READOUT:
                continue
            before = self._choices.get(spec.key, choice)
            self._choices[spec.key] = choice
            if choice and choice != before:
                yield Change(self._name, 'accessory.reported', 'reports: {} {}'.format(
                    spec.label, choice.replace('_', ' ')), data={
                        'key': spec.key, 'choice': choice})

    def _switch_changes(self, view: RobotView) -> _Changes:
        """Report the robot's own emergency stop."""
        pressed = self._pressed if view.hardware_stop is None else view.hardware_stop
        if pressed != self._pressed:
            yield ('hardware.pressed', Reason(HARDWARE_STOP).what) if pressed else \
                ('hardware.released', 'its own emergency stop is released')
        self._pressed = pressed

    def _quality_changes(self, view: RobotView, now: float) -> _Changes:
        """Report a link that is bad, or good again."""
        warning = link_warning(view.figures)
        if self._bad.take(bool(warning), BAD_LINK_S if warning else GOOD_LINK_S, now):
            yield ('quality.bad', warning) if warning else \
                ('quality.good', 'the link is good again')

    def _power_changes(self, view: RobotView) -> _Changes:
        """Report completed changes of the motor power."""
        power = view.power if view.power in _POWER else ON
        if view.power not in (CUT_ASKED, RESTORE_ASKED) and power != self._power:
            self._power = power
            yield _POWER[power]

    def _guard_changes(self, view: RobotView, now: float) -> _Changes:
        """Report a guard that is lost or back."""
        if not self._guarded.take(view.guarded, 0.0 if view.guarded else GUARD_S, now):
            return
        if not view.guarded:
            yield 'guard.lost', 'its guard does not answer: nothing on the robot checks commands'
        elif self._guard_lost:
            yield 'guard.back', 'its guard is back'
        self._guard_lost = not view.guarded


class RecordingChanges:
    """Changes of the recordings.

    :param status_of: function that returns the :class:`RecordingStatus` of a robot
    """

    def __init__(self, status_of: Callable[[str], RecordingStatus]) -> None:
        self._status_of = status_of
        self._old: Dict[str, RecordingStatus] = {}

    def update(self, names: Tuple[str, ...]) -> List[Change]:
        """Return the changes, including those of removed robots until their files are closed.

        :param names: the robots in the list
        """
        changes: List[Change] = []
        for name in dict.fromkeys((*names, *self._old)):
            status, old = self._status_of(name), self._old.get(name, RecordingStatus())
            changes += [Change(name, kind, text) for kind, text in self._changes_of(old, status)]
            if name in names or status.state == RECORDING:
                self._old[name] = status
            else:
                self._old.pop(name, None)
        return changes

    @staticmethod
    def _changes_of(old: RecordingStatus, status: RecordingStatus) -> _Changes:
        """Report start, end and trouble."""
        if status.state == NOT_RECORDED:
            if (old.state, old.note) != (status.state, status.note):
                yield 'recording.failed', 'not recorded: ' + status.note
        elif status.state == ENDED != old.state:
            yield 'recording.ended', status.words or 'recording ended: ' + status.path
        elif status.state == RECORDING:
            if old.state != RECORDING:
                yield 'recording.begun', 'recording to ' + status.path if status.path \
                    else 'recording'
            if status.attention and not (old.attention and old.state == RECORDING):
                yield 'recording.warning', 'recording: ' + status.words


class ScreenChanges:
    """Changes of the whole screen and everything on it.

    :param status_of: as for :class:`RecordingChanges`
    """

    def __init__(self, status_of: Callable[[str], RecordingStatus]) -> None:
        self._old: Optional[ScreenView] = None
        self._robots: Dict[str, RobotChanges] = {}
        self._recordings = RecordingChanges(status_of)
        self._mode: Optional[str] = None
        self._master = True
        self._drive = Held(True)
        self._advice: Held[Optional[Reason]] = Held(None)
        self._limits: Optional[Held[Tuple[float, float]]] = None

    def update(self, view: ScreenView, now: float) -> List[Change]:
        """Return the changes since the last view, in the order to report them.

        :param now: time [s, monotonic]
        """
        old = self._old or ScreenView(ros=view.ros)
        changes = [Change('', kind, text) for kind, text in (
            *self._ros_changes(old, view), *self._services_changes(view, now),
            *self._driver_changes(old, view), *self._source_changes(view, now))]
        changes += self._list_changes(view, now)
        changes += self._recordings.update(tuple(robot.name for robot in view.robots))
        self._old = view
        return changes

    def _list_changes(self, view: ScreenView, now: float) -> Iterator[Change]:
        """Report added and removed robots, and the changes of each robot."""
        names = {robot.name for robot in view.robots}
        for name in [name for name in self._robots if name not in names]:
            del self._robots[name]
            yield Change(name, 'robot.removed', 'removed from the list')
        for robot in view.robots:
            if robot.name not in self._robots:
                self._robots[robot.name] = RobotChanges(robot.name)
                if self._old is not None:
                    yield Change(robot.name, 'robot.added', 'added to the list')
            yield from self._robots[robot.name].update(robot, view.answers, now)

    def _ros_changes(self, old: ScreenView, view: ScreenView) -> _Changes:
        """Report loss and return of the master, and the disconnection of this screen."""
        if view.ros == ROS_CUT_OFF != old.ros:
            yield 'screen.cut_off', 'this screen is cut off and shows nothing new: restart it'
        elif view.ros == ROS_NO_MASTER and self._master:
            self._master = False
            yield 'master.lost', 'no ROS master: looking again every second'
        elif view.ros == ROS_CONNECTED and not self._master:
            self._master = True
            yield 'master.back', 'the ROS master is back'

    def _services_changes(self, view: ScreenView, now: float) -> _Changes:
        """Report loss and return of the drive service."""
        if view.ros == ROS_CONNECTED and self._drive.take(view.answers, SERVICE_S, now):
            yield ('mux.back', 'the drive service answers again') if view.answers else \
                ('mux.silent', Reason(DRIVE_SILENT).sentence)

    def _driver_changes(self, old: ScreenView, view: ScreenView) -> _Changes:
        """Report STOP ALL, changes of control, and refused requests."""
        if view.stop_all != old.stop_all:
            yield ('stop.engaged', 'STOP ALL') if view.stop_all else \
                ('stop.released', 'STOP ALL released')
        if view.control.ours != old.control.ours:
            yield ('control.taken', 'this screen drives now') if view.control.ours else \
                ('control.lost', 'read-only: {} is in control'.format(view.control.words))
        if view.stop_note != old.stop_note and view.stop_refused:
            yield 'request.refused', view.stop_note

    def _source_changes(self, view: ScreenView, now: float) -> _Changes:
        """Report a new source, a source that cannot drive, and a new speed limit."""
        if view.mode is None:
            return
        if self._mode not in (None, view.mode):
            yield 'mode.changed', 'driving with {}'.format(
                dict(view.sources).get(view.mode, view.mode))
        self._mode = view.mode
        if self._advice.take(view.advice, SETTLED_S, now):
            yield ('source.trouble', view.advice.sentence) if view.advice else \
                ('source.fine', 'the active source sends again')
        if self._limits is None:
            self._limits = Held(view.limits)
        if self._limits.take(view.limits, SETTLED_S, now):
            yield 'limits.changed', 'speed limit {:.2f} m/s, {:.2f} rad/s'.format(*view.limits)
