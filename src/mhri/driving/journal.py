# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The journal of a drive, with every event and every velocity, and its replay.

A line is a JSON array. Its first two values are the run of the drive that wrote it (one file may
hold several) and the type of the line::

    begin   {version, config, now, kept}, answers
    <event> arguments, named arguments, answers, orders, refused
    left    robot, topic, [x, turn, y]

An event is a method of :class:`mhri.driving.drive.Drive`. ``answers`` are the results of the
drive's queries during the event: ["connected", source, nodes] and ["brake", robot, velocity,
reduced velocity]; brakes that reduced nothing are left out. ``orders`` are [robot, x, turn, y], or
[robot, key, choice, values, whether it ends a motion] for an accessory; null if the event raised an
error; ``refused`` is true if it was refused. The velocities sent to a robot, on any topic, follow
the event that caused them. Times [s] are the drive's, velocities are in m/s and rad/s.
"""
from dataclasses import fields, is_dataclass
import functools
import inspect
import json
import struct
from typing import (
    AbstractSet, Any, Callable, Dict, Iterable, List, Mapping, NamedTuple, Optional, Sequence,
    Tuple)

from mhri.base.accessories import Accessory, Feedback
from mhri.base.limits import Velocity
from mhri.base.robot_types import Limits
from mhri.devices.profile import Asked, JoyRefused, Stick, Wanted
from mhri.driving.drive import Drive, Orders
from mhri.driving.operator_lease import Caller
from mhri.driving.robot_rule import Brake
from mhri.driving.settings import Settings
from mhri.driving.sources import MuxConfig, Source

VERSION = 2
BEGIN, LEFT = 'begin', 'left'
_CONNECTED, _BRAKE, _FAILED = 'connected', 'brake', 'failed'
# Methods that change nothing.
_QUESTIONS = frozenset(('stop_reason', 'owner', 'next_tick', 'waits_for', 'kept'))
#: names of the methods of a drive that handle an event
EVENTS = frozenset(name for name, thing in vars(Drive).items()
                   if inspect.isfunction(thing) and not name.startswith('_')) - _QUESTIONS
# The last 48 bytes of a serialized geometry_msgs/Twist or TwistStamped: x, y, ..., turn.
_TWIST = struct.Struct('<6d')
# Maximum number of events replayed in the search for the shortest list.
_MOST = 10 ** 7

Entry = List[Any]


def _read(*told: Any) -> Callable[[bool], Wanted]:
    """Return a function that replays the two readings of a message (no sideways, sideways)."""
    def read(sideways: bool) -> Wanted:
        found = told[sideways]
        if isinstance(found, Exception):
            raise found
        return found  # type: ignore[no-any-return]
    return read


# Robots and nodes cannot have names with "!".
_KINDS: Dict[str, Callable[..., Any]] = {'!' + kind.__name__: kind for kind in (
    Accessory, Asked, Caller, Feedback, JoyRefused, Limits, MuxConfig, Settings, Source, Stick,
    Velocity)}
_KINDS.update({'!set': lambda *values: frozenset(values), '!read': _read, '!error': Exception})


def _plain(value: Any) -> Any:
    """Convert a value to JSON values."""
    kind = '!' + type(value).__name__
    if isinstance(value, JoyRefused):
        return {kind: [value.kind, str(value)]}
    if isinstance(value, Exception):
        return {'!error': [repr(value)]}
    if isinstance(value, (set, frozenset)):
        return {'!set': sorted(value)}
    if is_dataclass(value):
        # A replay needs no profile: the commands read with it are recorded.
        return {kind: [_plain(getattr(value, field.name)) for field in fields(value)]} \
            if kind in _KINDS else None
    if isinstance(value, (list, tuple)):
        parts = [_plain(part) for part in value]
        return {kind: parts} if kind in _KINDS else parts
    return {'!read': [_plain(_try(value, sideways)) for sideways in (False, True)]} \
        if callable(value) else value


def _try(read: Callable[[bool], Wanted], sideways: bool) -> Any:
    try:
        return read(sideways)
    except Exception as error:  # recorded in place of the result
        return error


def _real(value: Any) -> Any:
    """Invert :func:`_plain`, with tuples for lists."""
    if isinstance(value, list):
        return tuple(map(_real, value))
    if isinstance(value, dict):
        (kind, parts), = value.items()
        return _KINDS[kind](*map(_real, parts))
    return value


class JournalDrive(Drive):
    """A drive that records every event.

    A function that reads a message must return the same command when called again later.

    :param note: called with the values of each entry, as :func:`line_of` takes them (at any later
        time), on the thread of the event; it must return at once
    """

    def __init__(self, note: Callable[..., None], config: MuxConfig, now: float,
                 kept: Optional[Mapping[str, Any]] = None,
                 on_refused: Callable[[str, str], None] = lambda caller, what: None,
                 connected: Callable[[str], AbstractSet[str]] = lambda source: frozenset()
                 ) -> None:
        self._note = note
        self._answers: List[Any] = []

        def asked(source: str) -> AbstractSet[str]:
            found = connected(source)
            self._answers.append((_CONNECTED, source, frozenset(found)))
            return found
        super().__init__(config, now, kept, on_refused, asked)
        note(BEGIN, {'version': VERSION, 'config': config, 'now': now, 'kept': kept},
             self._answers)

    def open(self, name: str, limits: Limits, now: float,
             brake: Brake = lambda velocity, _: velocity,
             accessories: Sequence[Accessory] = (), presumed: bool = False) -> Orders:
        """Add a robot, and record the results of its brake."""
        def asked(velocity: Velocity, at: float) -> Velocity:
            found: Any = None
            try:
                found = brake(velocity, at)
            except Exception as error:  # raised below
                found = error
            self._answers.append((_BRAKE, name, velocity, found))
            if isinstance(found, Exception):
                raise found
            return found  # type: ignore[no-any-return]
        return super().open(name, limits, now, asked, accessories, presumed)

    def record_event(self, event: Callable[..., Any], args: Sequence[Any],
                     named: Mapping[str, Any]) -> Any:
        """Pass an event to the drive, and record it."""
        self._answers = []
        answer: Any = _FAILED
        try:
            answer = event(self, *args, **named)
        finally:
            self._note(event.__name__, args, named, self._answers, answer)
        return answer


def _noted(event: Callable[..., Any]) -> Callable[..., Any]:
    @functools.wraps(event)
    def noted(self: JournalDrive, *args: Any, **named: Any) -> Any:
        return self.record_event(event, args, named)
    return noted


for _name in EVENTS:
    setattr(JournalDrive, _name, _noted(getattr(JournalDrive, _name)))


def line_of(run: str, what: str, *values: Any) -> str:
    """Return the line of an entry.

    :param run: identifies the drive
    :param what: with the values, an entry of :class:`JournalDrive`; or LEFT with a robot, a topic,
        and the serialized Twist or TwistStamped that was sent
    """
    if what == BEGIN:
        about, answers = values
        entry = [{**about, 'config': _plain(about['config'])}, _plain(answers)]
    elif what == LEFT:
        robot, topic, data = values
        twist = _TWIST.unpack_from(data, len(data) - _TWIST.size)
        entry = [robot, topic, [twist[0], twist[5], twist[1]]]
    else:
        args, named, answers, answer = values
        if what == 'open':
            args = (*args[:3], *args[4:])  # without its brake, whose answers are recorded
        if all(one[-1] == one[-2] for one in answers if one[0] == _BRAKE):
            answers = [one for one in answers if one[0] != _BRAKE]
        entry = [_plain(args), {name: _plain(value) for name, value in named.items()},
                 _plain(answers)] + _said(answer)
    return json.dumps([run, what] + entry, separators=(',', ':'))


def _said(answer: Any) -> Entry:
    """Return [orders, refused] for the result of an event."""
    if answer == _FAILED:
        return [None, False]
    orders, problem = answer if isinstance(answer, tuple) else (answer or [], '')
    return [[[name, *_plain(list(order))] for name, order in orders], bool(problem)]


class Report(NamedTuple):
    """The result of a replay: counts, and the first difference ('' for none).

    ``shortest`` is the shortest list of lines that still shows it: a journal in which the drive
    agrees with all but the last event.
    """

    runs: int
    events: int
    velocities: int
    difference: str = ''
    shortest: Tuple[str, ...] = ()


class Replay:
    """A drive that receives the recorded events again.

    :param begin: the first entry of its journal
    """

    def __init__(self, begin: Entry) -> None:
        about, answers = begin[2:]
        self._answers = list(answers)
        self.drive = Drive(_real(about['config']), about['now'], about['kept'],
                           connected=self._connected)
        # The orders not sent yet; the robots to which anything was ever sent.
        self._ordered: List[Any] = []
        self._lines: Dict[str, None] = {}

    def _connected(self, source: str) -> AbstractSet[str]:
        found = self._answer(_CONNECTED, source)
        return frozenset(_real(found[2]) if found else ())

    def _brake(self, robot: str, velocity: Velocity, _: float) -> Velocity:
        found = self._answer(_BRAKE, robot, _plain(velocity))
        left = _real(found[3]) if found else velocity
        if isinstance(left, Exception):
            raise left
        return Velocity(*left)

    def _answer(self, *asked: Any) -> Entry:
        """Return the next recorded answer to a query, [] if there is none."""
        found: Entry = next(
            (one for one in self._answers if one[:len(asked)] == list(asked)), [])
        if found:
            self._answers.remove(found)
        return found

    def do(self, entry: Entry) -> Entry:
        """Pass an event to the drive; return [orders, refused]."""
        _, name, args, named, answers = entry[:5]
        self._answers, args = list(answers), _real(args)
        named = {key: _real(value) for key, value in named.items()}
        if name == 'open':
            args = (*args[:3], functools.partial(self._brake, args[0]), *args[3:])
        try:
            return _said(getattr(self.drive, name)(*args, **named))
        except Exception:  # expected if the recorded event failed, too
            return [None, False]

    def judge(self, entry: Entry) -> str:
        """Handle an entry of the journal; return how the drive differs from it, '' if it agrees."""
        if entry[1] == LEFT:
            return self._leave(*entry[2:])
        waits = [order for order in self._ordered if order[0] in self._lines
                 and not any(order[1:])]
        if waits:
            return 'before that, {} was ordered and has not left'.format(waits[0])
        said = self.do(entry)
        self._ordered = said[0] or []
        return '' if said == entry[5:] else 'the journal says {}, the drive {}'.format(
            entry[5:], said)

    def _leave(self, robot: str, topic: str, velocity: List[float]) -> str:
        """Handle a sent velocity: each command once, on one topic; zeros at any time."""
        self._lines[robot] = None
        order = [robot, *velocity]
        if not any(velocity):
            self._ordered = [other for other in self._ordered if other != order]
        elif order in self._ordered:
            self._ordered.remove(order)
        else:
            return '{} has left on {}, and was not ordered'.format(order, topic)
        return ''

    def situation(self) -> Tuple[Any, ...]:
        """Return the externally visible state, without times."""
        drive = self.drive
        return (drive.mode, drive.arbiter.state, drive.command, drive.lease.holder,
                drive.lease.state, drive.lease.chosen, drive.alone, drive.settings, drive.share,
                {name: (rule.state, rule.sent, rule.limits, rule.held_by)
                 for name, rule in drive.robots.items()})


def replay(lines: Iterable[str]) -> Report:
    """Replay a journal with new drives, up to the first difference.

    A line may be incomplete where a drive was killed: at the end, and before another drive begins.

    :raises ValueError: it is not a journal, or has another version
    """
    drives: Dict[str, Replay] = {}
    history: Dict[str, List[Entry]] = {}
    counts, broken = {True: 0, False: 0}, 0
    for number, line in enumerate(lines, 1):
        if not line.strip():
            continue
        entry = _entry(line)
        if entry is None:
            broken = broken or number
            continue
        run, what = entry[:2]
        if what == BEGIN:
            _check(entry, number)
            drives[run], history[run], broken = Replay(entry), [entry], 0
            continue
        if broken or run not in drives or what not in EVENTS | {LEFT}:
            raise ValueError('line {} is no line of a journal'.format(broken or number))
        counts[what == LEFT] += 1
        history[run].append(entry)
        problem = drives[run].judge(entry)
        if problem:
            return Report(len(drives), counts[False], counts[True],
                          'line {}: {}: {}'.format(number, what, problem),
                          _shortest(history[run]))
    if not drives:
        raise ValueError('no drive begins in it: it is no journal')
    return Report(len(drives), counts[False], counts[True])


def _entry(line: str) -> Optional[Entry]:
    """Parse a line; return None if it is incomplete."""
    try:
        entry = json.loads(line)
    except ValueError:
        return None
    return entry if isinstance(entry, list) and len(entry) > 2 else None


def _check(begin: Entry, number: int) -> None:
    """Check the version of a journal.

    :raises ValueError: the version is not supported
    """
    version = begin[2].get('version') if isinstance(begin[2], dict) else None
    if version != VERSION:
        raise ValueError('line {}: a journal of version {}; this program reads version {}'.format(
            number, version, VERSION))


def _shortest(history: List[Entry]) -> Tuple[str, ...]:
    """Return the lines of the shortest part of a history that shows the difference at its end.

    In that part the drive agrees with the journal on all but the last event. Before that event its
    visible state, and for that event its result, are the same as in the whole history.
    """
    begin, *events = [entry for entry in history if entry[1] != LEFT]
    if history[-1][1] == LEFT or len(events) < 2:
        # The drive agrees: the difference is between its order and the velocity sent.
        at = history.index(events[-1]) if events else 1
        return tuple(map(_line, [begin] + history[at:]))
    *events, last = events
    left_to_do, wanted = _MOST, _end(begin, events, last)
    size = max(1, len(events) // 2)
    while True:
        at, before = 0, len(events)
        while at < len(events) and left_to_do > 0:
            fewer = events[:at] + events[at + size:]
            left_to_do -= len(fewer)
            if _end(begin, fewer, last) == wanted:
                events = fewer
            else:
                at += size
        if size == 1 and len(events) == before or left_to_do <= 0:
            return tuple(map(_line, [begin] + events + [last]))
        size = max(1, size // 2)


def _line(entry: Entry) -> str:
    return json.dumps(entry, separators=(',', ':'))


def _end(begin: Entry, events: List[Entry], last: Entry) -> Optional[Tuple[Any, ...]]:
    """Return the visible state before the last event, and the drive's result for that event.

    :returns: None if the drive contradicts the journal earlier
    """
    drive = Replay(begin)
    if any(drive.do(entry) != entry[5:] for entry in events):
        return None
    return drive.situation(), drive.do(last)
