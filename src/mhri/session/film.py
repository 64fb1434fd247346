# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The film of a session: the choice of pictures and the layout of a frame."""
from dataclasses import dataclass
import math
from typing import Any, List, Mapping, Optional, Sequence, Tuple

import numpy as np

from mhri.base.numbers import natural_key
from mhri.base.opencv import cv2
from mhri.recording.recording import duration_text
from mhri.session.report import Report
from mhri.session.timeline import MARK

# Tile sizes: (maximum number of tiles, width, height) [px]; even, as encoders require.
_TILES = ((1, 960, 720), (2, 640, 480), (4, 640, 480), (9, 424, 318), (16, 320, 240))
MAX_CAMERAS = 16
_BAR_PX, _WORDS_PX = 40, 28
# An older picture is darkened and labelled with its age [s].
OLD_S = 1.0
# How long the text of a mark stays [s].
_MARK_S = 4.0
_PAPER, _BAR, _INK = (24, 24, 24), (40, 40, 40), (240, 240, 240)
_STOP = (0, 83, 198)
MAP_WORDS = 'map: where each robot is, and its path so far'


@dataclass(frozen=True)
class Camera:
    """A camera of the film: its robot, the robot's number, its topic."""

    robot: str
    number: int
    topic: str


@dataclass(frozen=True)
class Tile:
    """One camera in a frame: BGR picture (None before the first), its age [s], robot speed."""

    camera: Camera
    picture: Optional[np.ndarray] = None
    age_s: float = 0.0
    speed_mps: Optional[float] = None

    def words(self) -> str:
        """Return the caption."""
        text = '{} {}'.format(self.camera.number, self.camera.robot)
        if self.speed_mps is not None:
            text += '  {:.2f} m/s'.format(self.speed_mps)
        if self.picture is None:
            return text + '  no picture yet'
        return text + ('  picture of {:.0f} s ago'.format(self.age_s)
                       if self.age_s > OLD_S else '')


def cameras_of(robots: Mapping[str, Mapping[str, Any]], numbers: Mapping[str, int],
               pictures: Sequence[str]) -> List[Camera]:
    """Return the cameras of a film, at most :data:`MAX_CAMERAS`.

    :param robots: entries of ``session.yaml``; a robot's rgb camera is preferred, else its first
        recorded camera is used
    :param pictures: topics of the recorded compressed pictures
    """
    found = []
    for name in sorted(robots, key=lambda one: (numbers[one], natural_key(one))):
        topics = robots[name].get('topics')
        wanted = topics.get('rgb') if isinstance(topics, dict) else None
        mine = sorted(topic for topic in pictures if topic.startswith('/{}/'.format(name))
                      and not topic.endswith('/compressedDepth'))
        if wanted in pictures:
            found.append(Camera(name, numbers[name], str(wanted)))
        elif mine:
            found.append(Camera(name, numbers[name], mine[0]))
    return found[:MAX_CAMERAS]


def frame_count(length_s: float, fps: float) -> int:
    """Return the number of frames of a session, at least 1."""
    return max(1, math.ceil(length_s * fps - 1e-6))


def columns_of(count: int) -> int:
    """Return the number of tiles in a row."""
    return math.ceil(math.sqrt(count))


def frame_size(count: int) -> Tuple[int, int]:
    """Return (width, height) [px] of a frame with this many tiles."""
    width, height = _tile_size(count)
    columns = columns_of(count)
    return width * columns, _BAR_PX + height * math.ceil(count / columns)


def _tile_size(count: int) -> Tuple[int, int]:
    return next((width, height) for most, width, height in _TILES if count <= most)


def map_size(count: int) -> Optional[Tuple[int, int]]:
    """Return (width, height) [px] of the map of a film with this many tiles; None without room.

    It takes the place that the tiles leave empty, below the line for its caption.
    """
    width, height = _tile_size(count)
    return (width, height - _WORDS_PX) if count % columns_of(count) else None


def frame_of(tiles: Sequence[Tile], heading: str, stopped: bool,
             the_map: Optional[np.ndarray] = None) -> np.ndarray:
    """Return a BGR frame: the heading with the clock above the tiles.

    :param the_map: a picture of at most :func:`map_size`; None without one
    """
    wide, high = frame_size(len(tiles))
    frame = np.full((high, wide, 3), _PAPER, np.uint8)
    frame[:_BAR_PX] = _STOP if stopped else _BAR
    _write(frame, heading, 12, 28, wide - 24)
    width, height = _tile_size(len(tiles))
    for place, tile in enumerate(tiles):
        row, column = divmod(place, columns_of(len(tiles)))
        left, top = column * width, _BAR_PX + row * height
        part = frame[top:top + height, left:left + width]
        if tile.picture is not None:
            _fit(part, tile.picture, tile.age_s > OLD_S)
        part[:_WORDS_PX] //= 3
        part[:, -1] = part[-1] = _BAR
        _write(part, tile.words(), 10, 20, width - 20)
    if the_map is not None:
        row, column = divmod(len(tiles), columns_of(len(tiles)))
        left, top = column * width, _BAR_PX + row * height
        _write(frame[top:top + height, left:left + width], MAP_WORDS, 10, 20, width - 20)
        top += _WORDS_PX
        _fit(frame[top:top + height - _WORDS_PX, left:left + width], the_map, False)
    return frame


def _fit(part: np.ndarray, picture: np.ndarray, dark: bool) -> None:
    """Scale a picture into a tile, keeping its aspect ratio."""
    high, wide = part.shape[:2]
    scale = min(wide / picture.shape[1], high / picture.shape[0])
    width, height = (min(most, max(1, round(side * scale)))
                     for side, most in ((picture.shape[1], wide), (picture.shape[0], high)))
    small = cv2.resize(picture, (width, height),
                       interpolation=cv2.INTER_AREA if scale < 1.0 else cv2.INTER_LINEAR)
    left, top = (wide - width) // 2, (high - height) // 2
    part[top:top + height, left:left + width] = small // 2 if dark else small


def _write(part: np.ndarray, text: str, x: int, y: int, most_px: int) -> None:
    """Write a line in ASCII, the only letters of OpenCV's font; cut it to the maximum width."""
    text = text.encode('ascii', 'replace').decode()
    while text and cv2.getTextSize(text, cv2.FONT_HERSHEY_SIMPLEX, 0.55, 1)[0][0] > most_px:
        text = text[:-1]
    cv2.putText(part, text, (x, y), cv2.FONT_HERSHEY_SIMPLEX, 0.55, _INK, 1, cv2.LINE_AA)


class Headings:
    """The heading of each frame; call :meth:`at` in order of time.

    :param report: the :class:`Report` of the session
    """

    def __init__(self, report: Report) -> None:
        self._report = report
        self._marks = [tick for tick in report.line.ticks if tick.kind == MARK]
        self._next = 0

    def at(self, at_s: float) -> Tuple[str, bool]:
        """Return (heading, whether STOP ALL is in force) at a time from the start [s]."""
        line = self._report.line
        stopped = any(span.begin_s <= at_s < span.end_s for span in line.stopped)
        driven = line.driven_at(at_s)
        while self._next < len(self._marks) and self._marks[self._next].at_s <= at_s:
            self._next += 1
        mark = self._marks[self._next - 1] if self._next else None
        parts = ['{}   {}'.format(self._report.clock(at_s), duration_text(at_s))]
        parts += ['STOP ALL'] if stopped else []
        parts += ['driven: ' + ', '.join(driven)] if driven else []
        if mark is not None and at_s - mark.at_s < _MARK_S:
            parts.append(' '.join(mark.text[:200].split()))
        return '   '.join(parts), stopped
