# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The topics, names and states of a recording."""
from collections import deque
from dataclasses import dataclass
from datetime import datetime
import re
from typing import Callable, Collection, Deque, Mapping, Match, Optional, Tuple

from mhri.base.names import topic_of
from mhri.base.robot_types import RobotType

# States of a recording, in order; the last two end it.
OFF = 'off'              # not started
RECORDING = 'recording'  # a file is open (also while the last messages are being written)
ENDED = 'ended'          # stopped by the operator, the file is complete and closed
FAILED = 'failed'        # never started, or stopped by itself; the note has details

MB = 10 ** 6
ACTIVE = '.active'
_VARIABLE = re.compile(r'\$(?:([A-Za-z_]\w*)|\{([A-Za-z_]\w*)\})', re.ASCII)
# System folders in which no files are written.
_NO_FILES_IN = ('/dev', '/proc', '/sys')
# Simulated time begins near 0; a ROS time before this one (2001) is no time of day [s].
_FIRST_DATE_S = 1e9

#: extras to choose from: (key, label); the IMU is always recorded
CHOICES = (('odometry', 'Odometry'), ('commands', 'Commands'), ('scan', 'Laser scan'),
           ('rgb', 'RGB camera (compressed)'), ('depth', 'Depth camera (compressed)'))
# Topic of the commands to a robot with a guard, below its namespace.
GUARD_COMMAND = 'mhri_guard/command'
_COMMAND_TOPICS = ('/robot_controller/twist', '/robot_controller/robot_select',
                   '/robot_controller/stop_all', '/mux/mode')


class PathRefused(Exception):
    """A path cannot be used for a recording; the text is the reason, for the operator."""


@dataclass(frozen=True)
class RecordingStatus:
    """The state of a recording for its row.

    ``path`` is the final path of the file ('' before the start), ``duration_s`` counts from the
    opening of the file, ``messages`` and ``bytes`` are the totals received (written or queued),
    ``rate_hz`` is the rate of the last second or so. ``note`` is a sentence for the operator or
    ''; ``attention`` is true if it is a warning. ``elsewhere`` is the reason why the file is not
    at the requested path, '' if it is.
    """

    state: str = OFF
    path: str = ''
    duration_s: float = 0.0
    messages: int = 0
    bytes: int = 0
    rate_hz: float = 0.0
    note: str = ''
    attention: bool = False
    elsewhere: str = ''

    @property
    def words(self) -> str:
        """The note, after the reason why the file is elsewhere."""
        moved = '{} elsewhere, {}'.format('saved' if self.state == ENDED else 'saving',
                                          self.elsewhere) if self.elsewhere else ''
        return '; '.join(filter(None, (moved, self.note)))


@dataclass(frozen=True)
class RecordingLimits:
    """Limits for warning, for stopping, and for the data lost with a killed program.

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
    """Messages per second over the last second or two, from a frequently read counter."""

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

    Every candidate in a template's list is included; missing topics do no harm. Cameras are
    recorded compressed, with their ``camera_info``; topics without a compressed form can be added
    by name. Commands are recorded both on the host and at the robot, which is safe since the
    recorder only listens.

    :param robot_type: :class:`mhri.base.robot_types.RobotType`
    :param choices: keys of ``CHOICES``
    :raises KeyError: a choice does not exist
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
    :raises PathRefused: a variable is not set, or it is the home folder of another user
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
    """Return (folder, name) of a typed path; the name is '' if the path is a folder.

    A path that is a folder, or ends in a slash, is a folder; anything else is a file, to which
    ``.bag`` is added if missing. Relative paths start at the folder of ROS. An empty text is the
    folder of ROS.

    :param is_folder: function that returns whether a path is an existing folder
    :raises PathRefused: such a file is impossible
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
    """Return the system folder that a (real) folder is in, None if files may be written to it."""
    for top in _NO_FILES_IN:
        if real_folder == top or real_folder.startswith(top + '/'):
            return top
    return None


def numbered(name: str, number: int) -> str:
    """Return the name, for numbers above 0 with ``-<number>`` before its extension."""
    return name if not number else '{}-{}.bag'.format(name[:-len('.bag')], number)


def duration_text(seconds: float) -> str:
    """Return a duration as "00:12", from an hour on as "1:00:12"; negative ones count as zero."""
    minutes, rest = divmod(int(max(0.0, seconds) + 1e-6), 60)
    hours, minutes = divmod(minutes, 60)
    return '{}:{:02d}:{:02d}'.format(hours, minutes, rest) if hours else \
        '{:02d}:{:02d}'.format(minutes, rest)


def is_simulated(ros_s: float) -> bool:
    """Return whether a ROS time [s] is a simulated one and so no time of day; so is 0: unknown."""
    return ros_s < _FIRST_DATE_S


def moment_text(ros_s: float) -> str:
    """Return a ROS time [s] as a local time, "14:02:06"; a simulated one as a duration, "00:12"."""
    if is_simulated(ros_s):
        return duration_text(ros_s)
    return datetime.fromtimestamp(ros_s).strftime('%H:%M:%S')


def size_text(count: float) -> str:
    """Return a number of bytes in words, e.g. ``0.8 MB``, ``12 kB``."""
    if count < 99500:
        return '{:.0f} kB'.format(count / 1e3)
    return '{:.1f} GB'.format(count / 1e9) if count >= 1e9 else '{:.1f} MB'.format(count / 1e6)


def warning_of(limits: RecordingLimits, free_bytes: Optional[int],
               queue_bytes: int) -> Tuple[str, bool]:
    """Return (warning about the disk, whether to stop); ('', False) while all is well.

    :param free_bytes: free space of the disk, None if unknown
    :param queue_bytes: size of the messages received but not yet written
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
