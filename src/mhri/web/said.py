# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What the server says to the page: text frames, and pictures behind a header."""
import json
import math
import struct
from typing import Any, Dict, Iterable, List, Optional, Tuple

from mhri.base.text import tidy_text
from mhri.camera.image_message import read_compressed

PROTOCOL = 1
# Longest text and list that are passed on.
_LONGEST, _MOST = 300, 200
_LENGTH = struct.Struct('>I')
# The header of compressed_depth_image_transport in front of its PNG [bytes].
_DEPTH_HEADER = 12
# The state while no screen has said any.
NO_STATE: Dict[str, Any] = {
    'driving': '', 'mode': '', 'waits_for': '', 'stop_all': False, 'linear_mps': None,
    'angular_rad_s': None, 'worst': '', 'robots': []}
NO_PLACES: Dict[str, Any] = {'frame': '', 'robots': [], 'marks': [], 'fence': []}


def clean(value: Any) -> Any:
    """Return a value as JSON can hold it: None for what is not finite, texts and lists bounded."""
    if isinstance(value, float):
        return round(value, 4) if math.isfinite(value) else None
    if isinstance(value, str):
        return tidy_text(value, _LONGEST)
    if isinstance(value, dict):
        return {key: clean(one) for key, one in value.items()}
    if isinstance(value, (list, tuple)):
        return [clean(one) for one in value[:_MOST]]
    return value


def frame(key: str, value: Any, **more: Any) -> str:
    """Return a text frame: a JSON object with one key; ``more`` goes into its value."""
    return json.dumps({key: clean(dict(value, **more) if more else value)},
                      separators=(',', ':'), ensure_ascii=False, allow_nan=False)


def placed(robots: Iterable[Dict[str, Any]]) -> List[Dict[str, Any]]:
    """Return where the robots of the state are on the map, those whose place is known."""
    return [{'name': robot['name'], 'x': robot['x'], 'y': robot['y'], 'yaw': robot['yaw'],
             'age_s': robot['place_age_s']} for robot in robots if robot['placed']]


def picture_of(data: Any) -> Optional[Tuple[str, bytes]]:
    """Return (jpeg, png or depth; bytes) of a ``sensor_msgs/CompressedImage`` as it came.

    :returns: None of what a browser cannot show
    """
    try:
        kind, view = read_compressed(data)
    except ValueError:
        return None
    picture = bytes(view)
    if 'compressedDepth' in kind:
        picture = picture[_DEPTH_HEADER:]
        return ('depth', picture) if picture[:4] == b'\x89PNG' else None
    if picture[:2] == b'\xff\xd8':
        return 'jpeg', picture
    return ('png', picture) if picture[:4] == b'\x89PNG' else None


def picture_frame(number: int, robot: str, topic: str, age_s: float, kind: str,
                  picture: bytes) -> bytes:
    """Return a binary frame: length of the header (32 bit, big endian), header as JSON, picture."""
    header = json.dumps({'n': number, 'robot': robot, 'topic': topic, 'age_s': round(age_s, 3),
                         'format': kind}).encode()
    return _LENGTH.pack(len(header)) + header + picture
