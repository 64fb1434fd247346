# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What to record, under which name, and what to say about it."""
from collections import deque
from dataclasses import dataclass
from datetime import datetime
import re
from typing import Callable, Collection, Deque, Mapping, Match, Optional, Tuple

from mhri.base.names import topic_of
from mhri.base.robot_types import RobotType

# States of a recording; each is reached from the one before, the last two end it.
OFF = 'off'              # not started
RECORDING = 'recording'  # a file is open (also while the last messages are being written)
ENDED = 'ended'          # stopped by the operator, the file is closed whole
FAILED = 'failed'        # never began, or stopped by itself; the note says why and what there is

MB = 10 ** 6
ACTIVE = '.active'
_VARIABLE = re.compile(r'\$(?:([A-Za-z_]\w*)|\{([A-Za-z_]\w*)\})', re.ASCII)
# Folders of the system that never take files.
_NO_FILES_IN = ('/dev', '/proc', '/sys')

#: what an operator may choose: (key, label); the IMU is always recorded
CHOICES = (('odometry', 'Odometry'), ('commands', 'Commands'), ('scan', 'Laser scan'),
           ('rgb', 'RGB camera (compressed)'), ('depth', 'Depth camera (compressed)'))
# Below a robot's namespace: where commands to a robot with a guard go.
GUARD_COMMAND = 'mhri_guard/command'
_COMMAND_TOPICS = ('/robot_controller/twist', '/robot_controller/robot_select',
                   '/robot_controller/stop_all', '/mux/mode')


class PathRefused(Exception):
    """A path that cannot take a recording; the text tells the operator why."""


@dataclass(frozen=True)
class RecordingStatus:
    """A recording as its row shows it.

    ``path`` is that of the file as it is or will be called when it ends ('' before the start),
    ``duration_s`` counts from the opening of the file, ``messages`` and ``bytes`` are received
    (written or about to be), ``rate_hz`` is that of the last second or so. ``note`` is for
    the operator, '' if there is nothing to say; ``attention`` is true if it is a warning.
    """

    state: str = OFF
    path: str = ''
    duration_s: float = 0.0
    messages: int = 0
    bytes: int = 0
    rate_hz: float = 0.0
    note: str = ''
    attention: bool = False


@dataclass(frozen=True)
class RecordingLimits:
    """When a recording warns and stops, and how much a killed program may lose.

    Free space of the disk and memory of the queue in bytes, times in seconds.
    """

    warn_free_bytes: int = 1000 * MB
    stop_free_bytes: int = 256 * MB
    warn_queue_bytes: int = 32 * MB
    stop_queue_bytes: int = 512 * MB
    chunk_bytes: int = 768 * 1024
    chunk_s: float = 0.5
    sync_s: float = 5.0


class RateMeter:
    """Messages per second over the last second or two, from a count that is read often."""

    def __init__(self) -> None:
        self._seen: Deque[Tuple[float, int]] = deque(maxlen=40)

    def rate_hz(self, now_s: float, count: int) -> float:
        """Return the rate [Hz], 0 until there are two readings at least 0.2 s apart."""
        if not self._seen or now_s - self._seen[-1][0] >= 0.05:
            self._seen.append((now_s, count))
        while len(self._seen) > 2 and now_s - self._seen[1][0] >= 1.0:
            self._seen.popleft()
        span_s = now_s - self._seen[0][0]
        return (count - self._seen[0][1]) / span_s if span_s >= 0.2 else 0.0


def topics_of(robot: str, robot_type: RobotType, choices: Collection[str] = ()) -> Tuple[str, ...]:
    """Return the topics to record of a robot, absolute, without repetition.

    Every candidate in a template's list is taken: one that does not exist does no harm. Cameras are
    recorded compressed, with their ``camera_info``; topics without a compressed form can be added
    by name. Commands are recorded on the host and at the robot; a mere listener does not affect the
    gates.

    :param robot_type: :class:`mhri.base.robot_types.RobotType`
    :param choices: keys of ``CHOICES``
    :raises KeyError: a choice that does not exist
    """
    unknown = set(choices) - {key for key, _ in CHOICES}
    if unknown:
        raise KeyError('nothing to record is called {}'.format(', '.join(sorted(unknown))))
    names = list(robot_type.imu)
    for key in ('odometry', 'scan'):
        if key in choices:
            names += getattr(robot_type, key)
    for key, suffix in (('rgb', '/compressed'), ('depth', '/compressedDepth')):
        for topic in getattr(robot_type, key) if key in choices else ():
            names += [topic + suffix, topic.rpartition('/')[0] + '/camera_info']
    if 'commands' in choices:
        names += (*robot_type.command, GUARD_COMMAND)
    topics = [topic_of(robot, name) for name in names]
    if 'commands' in choices:
        topics += _COMMAND_TOPICS
    return tuple(dict.fromkeys(topics))


def ros_home(env: Mapping[str, str]) -> str:
    """Return the folder of ROS: ``$ROS_HOME``, by default ``~/.ros``."""
    return env.get('ROS_HOME') or '{}/.ros'.format(env.get('HOME', '').rstrip('/'))


def default_name(robot: str, when: datetime) -> str:
    """Return ``<robot>_<date-time>.bag``.

    :param when: a :class:`datetime.datetime` in local time
    """
    return '{}_{:%Y-%m-%d-%H-%M-%S}.bag'.format(robot, when)


def expand(text: str, env: Mapping[str, str]) -> str:
    """Return a path with ``~``, ``$NAME`` and ``${NAME}`` replaced.

    :param env: {name: value} of the environment
    :raises PathRefused: a variable that is not set; a home folder of somebody else
    """
    def value(match: Match[str]) -> str:
        name = match.group(1) or match.group(2)
        if name not in env:
            raise PathRefused('${} is not set'.format(name))
        return env[name]

    text = _VARIABLE.sub(value, text)
    if text == '~' or text.startswith('~/'):
        return env.get('HOME', '') + text[1:]
    if text.startswith('~'):
        raise PathRefused('~name is not known here: write the whole path')
    return text


def split_path(text: str, env: Mapping[str, str],
               is_folder: Callable[[str], bool]) -> Tuple[str, str]:
    """Return (folder, name) of what the operator typed; the name is '' if only a folder is.

    A path that is a folder, or ends in a slash, is a folder; anything else is a file, to which
    ``.bag`` is added if missing. Relative paths start at the folder of ROS. An empty text is the
    folder of ROS.

    :param is_folder: function from a path to True if a folder of this name exists
    :raises PathRefused: there cannot be such a file
    """
    text = text.strip()
    if '\0' in text:
        raise PathRefused('it contains a character that no name can have')
    home = ros_home(env)
    if not text:
        return home, ''
    path = expand(text, env)
    if not path.startswith('/'):
        path = '{}/{}'.format(home, path)
    if is_folder(path) and not (path.endswith('.bag') or path.endswith('.bag/')):
        return path, ''
    folder, _, name = path.rpartition('/')
    if not name and not folder.endswith('.bag'):
        return folder or '/', ''
    if not name or name in ('.', '..'):
        raise PathRefused('that is a folder, not a file')
    if not name.endswith('.bag'):
        name += '.bag'
    if is_folder('{}/{}'.format(folder, name)):
        raise PathRefused('{} is a folder, not a file'.format(name))
    return folder or '/', name


def system_folder(real_folder: str) -> Optional[str]:
    """Return the system folder that a (real) folder is in, or None if it may take files."""
    for top in _NO_FILES_IN:
        if real_folder == top or real_folder.startswith(top + '/'):
            return top
    return None


def numbered(name: str, number: int) -> str:
    """Return the name, or for 1, 2, ... with ``-1``, ``-2``, ... before its ending."""
    return name if not number else '{}-{}.bag'.format(name[:-len('.bag')], number)


def fallback_note(text: str, reason: str, path: str) -> str:
    """Return a note that a path could not be used, and what is used instead."""
    shown = ''.join(char if char.isprintable() else '?' for char in text.strip())
    if len(shown) > 80:
        shown = shown[:77] + '...'
    return 'cannot write to "{}": {}; saving to {} instead'.format(shown, reason, path)


_FALLBACK = re.compile(r'cannot write to ".*": (.*); saving to /.* instead(?:; )?', re.DOTALL)


def read_fallback(note: str) -> Tuple[str, str]:
    """Return (why the path could not be used, the rest of a note); ('', note) if it could.

    The inverse of :func:`fallback_note`, for a caller that shows the path elsewhere.
    """
    found = _FALLBACK.search(note)
    if found is None:
        return '', note
    return found.group(1), note[:found.start()] + note[found.end():]


def size_text(count: float) -> str:
    """Return a number of bytes in words, e.g. ``0.8 MB``, ``12 kB``."""
    if count < 99500:
        return '{:.0f} kB'.format(count / 1e3)
    return '{:.1f} GB'.format(count / 1e9) if count >= 1e9 else '{:.1f} MB'.format(count / 1e6)


def warning_of(limits: RecordingLimits, free_bytes: Optional[int],
               queue_bytes: int) -> Tuple[str, bool]:
    """Return (words about the disk, whether to stop); ('', False) while all is well.

    :param free_bytes: space left on the disk, None if unknown
    :param queue_bytes: received but not yet written
    """
    if queue_bytes >= limits.stop_queue_bytes:
        return 'the disk is too slow: {} wait to be written'.format(size_text(queue_bytes)), True
    if free_bytes is not None and free_bytes < limits.stop_free_bytes:
        return 'the disk is full: {} free'.format(size_text(free_bytes)), True
    if queue_bytes >= limits.warn_queue_bytes:
        return 'the disk is slow: {} wait in memory'.format(size_text(queue_bytes)), False
    if free_bytes is not None and free_bytes < limits.warn_free_bytes:
        return 'the disk is nearly full: {} free'.format(size_text(free_bytes)), False
    return '', False
