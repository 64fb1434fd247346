# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The folder of a session: its names, its lines of events and its ``session.yaml``.

A session is ``<date-time>/`` with bags of a minute (``0000.bag``, ...), ``events.jsonl``,
``stills/`` and ``session.yaml``. Here is what they are called and what is in them; nothing here
touches a disk.
"""
from dataclasses import asdict, dataclass, field, fields
from datetime import datetime
import json
import math
import re
from typing import Any, Dict, Iterable, List, Mapping, Optional, Tuple

import yaml

from mhri.recording.recording import ACTIVE, ros_home

FORMAT = 1
SESSION_YAML, EVENTS_JSONL, STILLS = 'session.yaml', 'events.jsonl', 'stills'
# A bag is closed and the next one begun after so long [s].
BAG_S = 60.0
INFO, WARNING, ERROR = 'info', 'warning', 'error'
#: what ``kind`` of a line may be
KINDS = ('start', 'end', 'found', 'lost', 'mode', 'selection', 'control', 'stop', 'task', 'link',
         'battery', 'fault', 'brake', 'mark', 'note', 'still', 'record', 'event')
# What ``recorded`` may say of the cameras: as they come, so many pictures a second, only at marks.
CAMERA_ALL, CAMERA_RATE, CAMERA_STILLS = 'all', 'rate_hz', 'stills'
_BAG = re.compile(r'(\d{4,})\.bag(?:\.active)?\Z')
_NAME = re.compile(r'\d{4}-\d\d-\d\d-\d\d-\d\d-\d\d(-\d+)?\Z')
# As in XML 1.0.
_NO_TEXT = re.compile('[\x00-\x08\x0b\x0c\x0e-\x1f\x7f\ud800-\udfff\ufffe\uffff]')
# What is no letter, digit, "_" or "-" in a robot's name does not go into a file name.
_UNFIT = re.compile(r'[^A-Za-z0-9_-]')


class NotASession(Exception):
    """A folder or a file that is no session of ours; the text says what is wrong with it."""


@dataclass(frozen=True)
class SessionEvent:
    """One line of ``events.jsonl``.

    ``wall`` is the time of day [s since 1970], ``ros`` that of ROS [s], ``kind`` one of
    :data:`KINDS`, ``severity`` one of "info", "warning", "error", ``robot`` a name or '' for all,
    ``data`` what else belongs to it, as JSON values.
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
    """What ``session.yaml`` says.

    ``started`` is in seconds since 1970; ``mhri`` a version, ``host`` the name of the computer,
    ``frame`` that of the map, ``recorded`` "all", "stills" or "rate_hz" as of the cameras, with
    ``rate_hz`` beside it; ``robots`` is ``{name: {number, type, model, parameters, topics: {kind:
    absolute topic}}}``.
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


def folder_name(when: datetime, taken: Iterable[str] = ()) -> str:
    """Return the name of a session that begins now, e.g. ``2026-03-01-14-03-22``.

    :param taken: names that are in use; ``-2``, ``-3``, ... is put behind it then
    """
    name = '{:%Y-%m-%d-%H-%M-%S}'.format(when)
    used, number = set(taken), 1
    while (name if number == 1 else '{}-{}'.format(name, number)) in used:
        number += 1
    return name if number == 1 else '{}-{}'.format(name, number)


def is_folder_name(name: str) -> bool:
    """Tell whether a folder is called as sessions are."""
    return _NAME.match(name) is not None


def bag_name(number: int) -> str:
    """Return the name of a session's bag, counted from 0: ``0000.bag``."""
    return '{:04d}.bag'.format(number)


def bag_number(name: str) -> Optional[int]:
    """Return which bag of a session a file is, also while it is open; None if it is none."""
    found = _BAG.match(name)
    return int(found.group(1)) if found else None


def bags_of(names: Iterable[str]) -> Tuple[str, ...]:
    """Return those of a folder's file names that are bags, in their order.

    One that was never closed (``0007.bag.active``) is among them, unless its closed form is, too.
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


def still_name(stem: str, robot: str) -> str:
    """Return a picture's path in the folder, e.g. ``stills/m1_bot1.jpg``; ``stem``: mark, time."""
    return '{}/{}_{}.jpg'.format(STILLS, _UNFIT.sub('-', stem), _UNFIT.sub('-', robot.strip('/')))


def event_line(event: SessionEvent) -> str:
    """Return the line of an event, with its line's end; NaN and infinity become null."""
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

    What is no event (a half last line of a killed program, a later format's) is left out. What no
    page may have in it (NUL, other control characters, half a pair of surrogates) becomes U+FFFD.
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
    # A local time with its offset, for people; the seconds are what programs read.
    iso = datetime.fromtimestamp(info.started).astimezone().isoformat(timespec='milliseconds')
    found['started'] = {'iso': iso, 'seconds': info.started}
    return str(yaml.safe_dump(dict(format=FORMAT, **found), sort_keys=False, allow_unicode=True))


def read_info(text: str) -> SessionInfo:
    """Return what a ``session.yaml`` says; keys of a later version are ignored.

    :raises NotASession: it is no such file, or of a format that this program does not know
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
    """Return the robots of a file that somebody may have edited: what is no robot is left out."""
    if not isinstance(found, dict):
        return {}
    return {str(name): robot for name, robot in found.items() if isinstance(robot, dict)}


def robots_of(info: SessionInfo, events: Iterable[SessionEvent]) -> Dict[str, Dict[str, Any]]:
    """Return all robots of a session: those of its start, and those found later."""
    robots = dict(info.robots)
    for event in events:
        if event.kind == 'found' and event.robot and 'topics' in event.data:
            robots[event.robot] = event.data
    return robots


@dataclass(frozen=True)
class SessionMark:
    """A mark with what was typed to it; ``poses`` is ``{robot: [x_m, y_m, yaw_rad, frame]}``."""

    id: str
    wall: float
    ros: float
    text: str
    poses: Dict[str, List[Any]]
    stills: Tuple[str, ...]


def marks_of(events: Iterable[SessionEvent]) -> Tuple[SessionMark, ...]:
    """Return the marks of a session in their order; the last note typed to each is its text."""
    marks: Dict[str, SessionMark] = {}
    for event in events:
        data = event.data
        if event.kind == 'mark' and data.get('id'):
            poses, stills = data.get('poses'), data.get('stills')
            marks[str(data['id'])] = SessionMark(
                str(data['id']), event.wall, event.ros, event.text,
                poses if isinstance(poses, dict) else {},
                tuple(map(str, stills)) if isinstance(stills, list) else ())
        elif event.kind == 'note' and str(data.get('mark')) in marks:
            mark = marks[str(data['mark'])]
            marks[mark.id] = SessionMark(mark.id, mark.wall, mark.ros, event.text, mark.poses,
                                         mark.stills)
    return tuple(marks.values())
