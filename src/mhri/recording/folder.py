# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The folder of a session: file names, event lines and ``session.yaml``.

A session is ``<date-time>/`` with bags of a minute (``0000.bag``, ...), ``events.jsonl``,
``stills/`` and ``session.yaml``. This module defines their names and contents; it does not access
the disk.
"""
from dataclasses import asdict, dataclass, field, fields, replace
from datetime import datetime
import itertools
import json
import math
import re
from typing import Any, Dict, Iterable, Iterator, List, Mapping, Optional, Sequence, Tuple

import yaml

from mhri.recording.recording import ACTIVE, ros_home

FORMAT = 1
SESSION_YAML, EVENTS_JSONL, STILLS = 'session.yaml', 'events.jsonl', 'stills'
# Duration of a bag, after which the next one begins [s].
BAG_S = 60.0
INFO, WARNING, ERROR = 'info', 'warning', 'error'
#: the values of ``kind`` in a line
KINDS = ('start', 'end', 'found', 'lost', 'mode', 'selection', 'control', 'stop', 'task', 'link',
         'battery', 'fault', 'brake', 'mark', 'note', 'still', 'record', 'event')
# Values of ``recorded`` for the cameras: all pictures, a limited rate, only stills at marks.
CAMERA_ALL, CAMERA_RATE, CAMERA_STILLS = 'all', 'rate_hz', 'stills'
_BAG = re.compile(r'(\d{4,})\.bag(?:\.active)?\Z')
_NAME = re.compile(r'\d{4}-\d\d-\d\d-\d\d-\d\d-\d\d(-\d+)?\Z')
# Characters excluded from text, as in XML 1.0.
_NO_TEXT = re.compile('[\x00-\x08\x0b\x0c\x0e-\x1f\x7f\ud800-\udfff\ufffe\uffff]')
# Characters of a robot's name that are replaced in a file name.
_UNFIT = re.compile(r'[^A-Za-z0-9_-]')
_DEPTH = '-depth'
_NUMBERED = re.compile(r'm\d{1,6}\Z')
# Maximum length of the words of a mark's flag [characters].
_LABEL = 24


class NotASession(Exception):
    """A folder or file is not a session of mhri; the text is the reason."""


@dataclass(frozen=True)
class SessionEvent:
    """One line of ``events.jsonl``.

    ``wall`` is the time of day [s since 1970], ``ros`` that of ROS [s], ``kind`` one of
    :data:`KINDS`, ``severity`` one of "info", "warning", "error", ``robot`` a name or '' for all,
    ``data`` further values for JSON.
    """

    wall: float
    ros: float
    kind: str
    text: str
    severity: str = INFO
    robot: str = ''
    data: Dict[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class SessionInfo:
    """The content of ``session.yaml``.

    ``started`` is in seconds since 1970; ``mhri`` a version, ``host`` the name of the computer,
    ``frame`` the frame of the map, ``recorded`` "all", "stills" or "rate_hz" for the cameras, the
    latter with ``rate_hz``; ``robots`` is ``{name: {number, type, model,
    silent_after_s, parameters, topics: {kind: absolute topic}}}``.
    """

    started: float
    mhri: str = ''
    host: str = ''
    frame: str = 'map'
    recorded: str = CAMERA_ALL
    rate_hz: float = 0.0
    robots: Dict[str, Dict[str, Any]] = field(default_factory=dict)


def sessions_home(env: Mapping[str, str]) -> str:
    """Return the folder of all sessions: ``$ROS_HOME/mhri/sessions``."""
    return ros_home(env) + '/mhri/sessions'


def folder_name(when: datetime) -> str:
    """Return the name of a session that begins now, e.g. ``2026-03-01-14-03-22``."""
    return '{:%Y-%m-%d-%H-%M-%S}'.format(when)


def free_names(name: str) -> Iterator[str]:
    """Yield a name, then, in case it is in use, the name with ``-2``, ``-3``, ... appended."""
    yield name
    for number in itertools.count(2):
        yield '{}-{}'.format(name, number)


def is_folder_name(name: str) -> bool:
    """Return whether a folder has a name of a session."""
    return _NAME.match(name) is not None


def bag_name(number: int) -> str:
    """Return the name of a session's bag, counted from 0: ``0000.bag``."""
    return '{:04d}.bag'.format(number)


def bag_number(name: str) -> Optional[int]:
    """Return the number of a session's bag, open or closed; None for another file."""
    found = _BAG.match(name)
    return int(found.group(1)) if found else None


def bags_of(names: Iterable[str]) -> Tuple[str, ...]:
    """Return the bags among a folder's file names, in their order.

    A bag that was never closed (``0007.bag.active``) is included, unless its closed form exists.
    """
    found: Dict[int, str] = {}
    for name in names:
        number = bag_number(name)
        if number is not None and (number not in found or not name.endswith(ACTIVE)):
            found[number] = name
    return tuple(found[number] for number in sorted(found))


def next_bag(names: Iterable[str]) -> int:
    """Return the number of the bag to begin in a folder with these files."""
    return max((number + 1 for number in map(bag_number, names) if number is not None), default=0)


def still_name(stem: str, robot: str, depth: bool = False) -> str:
    """Return a picture's path in the folder, e.g. ``stills/m1_bot1.jpg``; ``stem``: mark, time.

    That of a depth camera is ``stills/m1_bot1-depth.jpg``; no robot has a hyphen in its name.
    """
    return '{}/{}_{}{}.jpg'.format(STILLS, _UNFIT.sub('-', stem), _UNFIT.sub('-', robot.strip('/')),
                                   _DEPTH if depth else '')


def words_of_still(name: str) -> str:
    """Return the robot of a still: "bot1" for ``stills/m1_bot1.jpg``, or "bot1, depth"."""
    robot = name.rpartition('/')[2].partition('_')[2].rpartition('.')[0]
    return robot[:-len(_DEPTH)] + ', depth' if robot.endswith(_DEPTH) else robot


def event_line(event: SessionEvent) -> str:
    """Return the line of an event, with a newline; NaN and infinity become null."""
    try:
        text = json.dumps(asdict(event), ensure_ascii=False, allow_nan=False)
    except ValueError:
        text = json.dumps(_finite(asdict(event)), ensure_ascii=False)
    return text + '\n'


def _finite(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _finite(part) for key, part in value.items()}
    if isinstance(value, (list, tuple)):
        return [_finite(part) for part in value]
    return None if isinstance(value, float) and value - value != 0.0 else value


def read_events(text: str) -> List[SessionEvent]:
    """Return the events of ``events.jsonl`` in the order of the file.

    Other lines (an incomplete last line of a killed program, a line of a later format) are left
    out. Characters that a page must not contain (control characters, single surrogates) become
    U+FFFD.
    """
    return [event for event in map(_read_line, text.split('\n')) if event is not None]


def _read_line(line: str) -> Optional[SessionEvent]:
    try:
        found = _readable(json.loads(line))
        data = found.get('data')
        wall, ros = float(found['wall']), float(found['ros'])
        if not (math.isfinite(wall) and math.isfinite(ros)):
            return None
        return SessionEvent(wall, ros, str(found['kind']),
                            str(found['text']), str(found.get('severity', INFO)),
                            str(found.get('robot', '')), data if isinstance(data, dict) else {})
    except (ValueError, TypeError, KeyError, AttributeError, OverflowError, RecursionError):
        return None


def _readable(value: Any) -> Any:
    if isinstance(value, dict):
        return {_readable(key): _readable(part) for key, part in value.items()}
    if isinstance(value, list):
        return [_readable(part) for part in value]
    return _NO_TEXT.sub('\ufffd', value) if isinstance(value, str) else value


def info_text(info: SessionInfo) -> str:
    """Return the text of ``session.yaml``."""
    found = asdict(info)
    # A local time with its offset for people, seconds for programs.
    iso = datetime.fromtimestamp(info.started).astimezone().isoformat(timespec='milliseconds')
    found['started'] = {'iso': iso, 'seconds': info.started}
    return str(yaml.safe_dump(dict(format=FORMAT, **found), sort_keys=False, allow_unicode=True))


def read_info(text: str) -> SessionInfo:
    """Return the content of a ``session.yaml``; keys of a later version are ignored.

    :raises NotASession: the file is something else, or its format is unknown
    """
    try:
        found = yaml.safe_load(text)
    except yaml.YAMLError as error:
        raise NotASession('{} cannot be read: {}'.format(SESSION_YAML, error))
    if not isinstance(found, dict) or 'format' not in found:
        raise NotASession('{} has no "format:"'.format(SESSION_YAML))
    if found['format'] != FORMAT:
        raise NotASession('{} has format {!r}; this program reads {}'.format(
            SESSION_YAML, found['format'], FORMAT))
    started = found.get('started')
    seconds = started.get('seconds') if isinstance(started, dict) else None
    if not isinstance(seconds, (int, float)) or isinstance(seconds, bool):
        raise NotASession('{}: started/seconds: a number is missing'.format(SESSION_YAML))
    known: Dict[str, Any] = {key: found[key] for key in _PLAIN if found.get(key) is not None}
    known['robots'] = _robots(found.get('robots'))
    return SessionInfo(float(seconds), **known)


_PLAIN = {part.name for part in fields(SessionInfo)} - {'started', 'robots'}


def _robots(found: Any) -> Dict[str, Dict[str, Any]]:
    """Return the valid robots of a file, which may have been edited by hand."""
    if not isinstance(found, dict):
        return {}
    return {str(name): robot for name, robot in found.items() if isinstance(robot, dict)}


def robots_of(info: SessionInfo, events: Iterable[SessionEvent]) -> Dict[str, Dict[str, Any]]:
    """Return all robots of a session, from its start and found later."""
    robots = dict(info.robots)
    for event in events:
        if event.kind == 'found' and event.robot and 'topics' in event.data:
            robots[event.robot] = event.data
    return robots


@dataclass(frozen=True)
class SessionMark:
    """A mark with its note; ``poses`` is ``{robot: [x_m, y_m, yaw_rad, frame]}``.

    ``robot`` is the one it was made at, '' if unknown.
    """

    id: str
    wall: float
    ros: float
    text: str
    poses: Dict[str, List[Any]]
    stills: Tuple[str, ...]
    robot: str = ''

    @property
    def number(self) -> str:
        """Its number in the session as text: "3" for m3."""
        return self.id[1:] if _NUMBERED.match(self.id) else self.id

    @property
    def note(self) -> str:
        """Its note in one line, '' without one."""
        text = ' '.join(self.text.split())
        return '' if text in ('mark', 'mark ' + self.number) else text

    @property
    def words(self) -> str:
        """The mark and its note in one line: "mark 3: a red door", or "mark 3"."""
        return 'mark {}{}'.format(self.number, ': ' + self.note if self.note else '')

    @property
    def label(self) -> str:
        """The words of its flag: its number, and the first words of its note."""
        return ' '.join((self.number[:8], first_words(self.note, _LABEL))).strip()


def first_words(text: str, most: int) -> str:
    """Return a text of at most ``most`` characters: its first words, then an ellipsis."""
    if len(text) <= most:
        return text
    cut = text[:most - 1]
    return (cut[:cut.rfind(' ')] if ' ' in cut[most // 2:] else cut).rstrip(' ,.;:') + '\u2026'


def is_of_mark(event: SessionEvent) -> bool:
    """Return whether a line is a mark, its note, or its robot."""
    return event.kind == 'mark' or 'mark' in event.data


def marks_of(events: Iterable[SessionEvent]) -> Tuple[SessionMark, ...]:
    """Return the marks of a session in order, each with the last note typed for it.

    A later line about a mark, by a screen, may name the robot that it was made at.
    """
    marks: Dict[str, SessionMark] = {}
    for event in events:
        data = event.data
        if event.kind == 'mark' and data.get('id'):
            poses, stills = data.get('poses'), data.get('stills')
            marks[str(data['id'])] = SessionMark(
                str(data['id']), event.wall, event.ros, event.text,
                poses if isinstance(poses, dict) else {},
                tuple(map(str, stills)) if isinstance(stills, list) else (), event.robot)
        elif str(data.get('mark')) in marks:
            mark = marks[str(data['mark'])]
            marks[mark.id] = replace(mark, text=event.text) if event.kind == 'note' else \
                replace(mark, robot=event.robot or mark.robot)
    return tuple(marks.values())


def with_notes(events: Sequence[SessionEvent]) -> List[SessionEvent]:
    """Return the events with each mark and its note as one line, at the time of the mark."""
    marks = {mark.id: mark for mark in marks_of(events)}
    found = []
    for event in events:
        mark = marks.get(str(event.data.get('id'))) if event.kind == 'mark' else None
        if mark is not None:
            found.append(replace(event, text=mark.words, robot=mark.robot))
        elif str(event.data.get('mark')) not in marks:
            found.append(event)
    return found
