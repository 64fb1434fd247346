# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Converts a ``sensor_msgs/PointCloud2``, or a depth picture with its lens, to points.

The fields: http://docs.ros.org/en/noetic/api/sensor_msgs/html/msg/PointCloud2.html and
PointField; ``rgb`` is four bytes, 0x00rrggbb as a number in the message's byte order, regardless of
their declared type (pcl/point_types.h). A message describes its own layout, so all of that is
checked before a byte is read. ``sensor_msgs.point_cloud2`` makes a tuple of each point, which takes
230 ms for 640 x 480 of them; here it is 9 ms.
"""
from dataclasses import dataclass
import math
from typing import Dict, List, NamedTuple, Optional, Sequence, Tuple

import numpy as np

from mhri.base.plausible import BOUNDS, RANGE
from mhri.base.wire import Data, Wire

CLOUD_TYPE = 'sensor_msgs/PointCloud2'
#: A larger cloud is thinned evenly: a screen cannot resolve more points.
MAX_POINTS = 500_000
_MAX_FIELDS = 100
_TYPES = {1: 'i1', 2: 'u1', 3: 'i2', 4: 'u2', 5: 'i4', 6: 'u4', 7: 'f4', 8: 'f8'}
_AXES = ('x', 'y', 'z')
_PACKED = ('rgb', 'rgba')
_PARTS = ('r', 'g', 'b')
_INTENSITIES = ('intensity', 'intensities', 'i')
# Suffix of the names of frames in which z is ahead and y is down (REP-103).
_OPTICAL = '_optical_frame'
_OPAQUE = np.uint32(0xff000000)


class CloudError(ValueError):
    """A cloud cannot be read; the text names its declared layout and the fault."""


class Field(NamedTuple):
    """A ``sensor_msgs/PointField``: the offset of a value in the bytes of a point, and its type."""

    name: str
    offset: int
    datatype: int
    values: int = 1


class RawCloud(NamedTuple):
    """The fields of a ``sensor_msgs/PointCloud2``; ``data`` is not a copy."""

    fields: Tuple[Field, ...]
    width: int
    height: int
    point_step: int
    row_step: int
    is_bigendian: bool
    data: Data
    frame_id: str = ''


class Lens(NamedTuple):
    """The pinhole of a ``sensor_msgs/CameraInfo``: focal lengths, centre and size [px]."""

    fx: float
    fy: float
    cx: float
    cy: float
    width: int
    height: int


@dataclass(frozen=True, eq=False)
class Cloud:
    """The measured points of one message.

    ``points`` is float32 (n, 3), x, y and z [m] in the frame of the message, all finite.
    ``colours`` is uint32 (n,), each 0xffrrggbb; ``intensity`` float32 (n,) in the unit of the
    sensor, NaN if it measured none; None if the message has no such field. ``optical``: z is ahead,
    x to the right, y down; else x is ahead, y to the left, z up (REP-103). ``sent`` is the number
    of points in the message, measured or not, ``kept_of`` the factor of thinning.
    ``received_s``: time of receipt [s, monotonic].
    """

    points: np.ndarray
    colours: Optional[np.ndarray] = None
    intensity: Optional[np.ndarray] = None
    optical: bool = False
    sent: int = 0
    kept_of: int = 1
    received_s: float = 0.0


def read_cloud(data: Data) -> RawCloud:
    """Return the :class:`RawCloud` of a serialised ``sensor_msgs/PointCloud2``.

    :raises CloudError: it is truncated, or declares an absurd number of fields
    """
    wire = Wire(CLOUD_TYPE, data, CloudError)
    wire.header()
    frame_id = wire.text()
    height, width, count = wire.numbers('<III')
    if count > _MAX_FIELDS:
        raise CloudError('{}: refused, it claims {:,} fields'.format(CLOUD_TYPE, count))
    fields = tuple(Field(wire.text(), *wire.numbers('<IBI')) for _ in range(count))
    is_bigendian, point_step, row_step = wire.numbers('<BII')
    return RawCloud(fields, width, height, point_step, row_step, bool(is_bigendian), wire.array(),
                    frame_id)


def parse_cloud(raw: RawCloud, received_s: float = 0.0) -> Cloud:
    """Return the :class:`Cloud` of a message; it is empty if the message is.

    Points are left out if they are NaN, infinite, farther than any sensor sees, or at the sensor
    itself (which some drivers use for "nothing").

    :raises CloudError: it has no readable x, y and z, or too little data
    """
    optical = raw.frame_id.endswith(_OPTICAL)
    _check_sizes(raw)
    if not raw.width * raw.height:
        return Cloud(np.empty((0, 3), np.float32), None, None, optical, received_s=received_s)
    view = _View(raw)
    axes = view.columns(_AXES)
    if axes is None:
        raise CloudError('{}: no fields x, y and z among {}'.format(
            CLOUD_TYPE, ', '.join(repr(field.name) for field in raw.fields[:9]) or 'none'))
    # A row for each axis: numpy is several times as fast on rows as on columns.
    points = np.empty((3, axes[0].size), np.float32)
    with np.errstate(over='ignore', invalid='ignore'):
        for row, axis in zip(points, axes):
            row.reshape(axis.shape)[...] = axis
    kept = _measured(points)
    return Cloud(_chosen(points, kept).T, _only(view.colours(), kept), _only(
        view.intensity(), kept), optical, raw.width * raw.height, view.kept_of, received_s)


def slopes(lens: Lens, width: int, height: int) -> Tuple[np.ndarray, np.ndarray]:
    """Return the offsets of pixels to the right (w,) and down (h,) per metre of depth.

    :param lens: of the camera; scaled to the picture if their sizes differ
    :raises CloudError: the lens is impossible
    """
    numbers = np.array(lens[:4], float)
    if not (np.isfinite(numbers).all() and min(lens.fx, lens.fy) > 0.0
            and np.abs(numbers).max() < 1e6):
        raise CloudError('camera_info: no possible focal length and centre; is the camera '
                         'calibrated?')
    across = width / lens.width if lens.width > 0 else 1.0
    along = height / lens.height if lens.height > 0 else 1.0
    # The centre of a pixel is at whole numbers.
    centre_x, centre_y = (lens.cx + 0.5) * across - 0.5, (lens.cy + 0.5) * along - 0.5
    return ((np.arange(width) - centre_x) / (lens.fx * across),
            (np.arange(height) - centre_y) / (lens.fy * along))


def from_depth(depth_m: np.ndarray, lens: Lens, received_s: float = 0.0) -> Cloud:
    """Return the :class:`Cloud` of a depth picture; lens distortion is ignored.

    :param depth_m: float32 (h, w), along the optical axis [m], NaN if invalid
    :param lens: of the camera; scaled to the picture if their sizes differ
    :raises CloudError: the lens is impossible
    """
    height, width = depth_m.shape
    right, down = slopes(lens, width, height)
    step = max(1, -(-width * height // MAX_POINTS))
    depth = depth_m[::step]
    points = np.empty((3,) + depth.shape, np.float32)
    np.multiply(depth, right.astype(np.float32), out=points[0])
    np.multiply(depth, down[::step].astype(np.float32)[:, None], out=points[1])
    points[2] = depth
    points = points.reshape(3, -1)
    return Cloud(_chosen(points, _measured(points)).T, optical=True, sent=depth_m.size,
                 kept_of=step, received_s=received_s)


def _check_sizes(raw: RawCloud) -> None:
    """Check that the sizes in a message match each other and its data."""
    what = '{} of {:,} x {:,} points'.format(CLOUD_TYPE, raw.width, raw.height)
    if min(raw.width, raw.height, raw.point_step, raw.row_step) < 0:
        raise CloudError('{}: refused, a size below zero'.format(what))
    if not raw.width * raw.height:
        return
    row = raw.width * raw.point_step
    if raw.point_step == 0 or (raw.height > 1 and 0 < raw.row_step < row):
        raise CloudError('{}: refused, with {:,} bytes for a point and {:,} for a row'.format(
            what, raw.point_step, raw.row_step))
    needed = _row_step(raw) * (raw.height - 1) + row
    if len(raw.data) < needed:
        raise CloudError('{}: truncated, {:,} of {:,} bytes'.format(what, len(raw.data), needed))


def _row_step(raw: RawCloud) -> int:
    """Return the bytes per row; for a single row some drivers set it to 0 or a wrong value."""
    row = raw.width * raw.point_step
    return (raw.row_step or row) if raw.height > 1 else row


class _View:
    """The values of the points to keep, read without copying."""

    def __init__(self, raw: RawCloud) -> None:
        self._raw = raw
        self._fields: Dict[str, Field] = {}
        for field in raw.fields:
            self._fields.setdefault(field.name, field)
        self._every, self.kept_of = _thinned(raw.height, raw.width)

    def columns(self, names: Sequence[str]) -> Optional[List[np.ndarray]]:
        """Return the values of some fields, each (h, w); None if one is missing.

        :raises CloudError: a field cannot be read
        """
        found = [self._fields.get(name) for name in names]
        return [self._column(field) for field in found if field] if all(found) else None

    def colours(self) -> Optional[np.ndarray]:
        """Return 0xffrrggbb of each point, (n,); None if the message has no colours."""
        for name in _PACKED:
            field = self._fields.get(name)
            if field is not None:
                self._check(field, 4)
                return self._column(field, 'u4').ravel().astype(np.uint32, copy=False) | _OPAQUE
        parts = self.columns(_PARTS)
        if parts is None or any(part.dtype != np.uint8 for part in parts):
            return None
        red, green, blue = (part.ravel().astype(np.uint32) for part in parts)
        return _OPAQUE | red << 16 | green << 8 | blue

    def intensity(self) -> Optional[np.ndarray]:
        """Return the intensity of each point, (n,); None if the message has none."""
        for name in _INTENSITIES:
            column = self.columns((name,))
            if column is not None:
                with np.errstate(over='ignore', invalid='ignore'):
                    return column[0].ravel().astype(np.float32, copy=False)
        return None

    def _check(self, field: Field, size: int) -> None:
        """Check that a field is a single value within the bytes of a point."""
        # Old drivers write a count of 0 for a single value.
        if field.values not in (0, 1):
            raise CloudError('{}: refused, field {!r} has {:,} values'.format(
                CLOUD_TYPE, field.name, field.values))
        if field.offset < 0 or field.offset + size > self._raw.point_step:
            raise CloudError('{}: refused, field {!r} ends at byte {:,} of a point of {:,}'.format(
                CLOUD_TYPE, field.name, field.offset + size, self._raw.point_step))

    def _column(self, field: Field, kind: str = '') -> np.ndarray:
        """Return the values of a field, (h, w), as a view of the message."""
        raw = self._raw
        kind = kind or _TYPES.get(field.datatype, '')
        if not kind:
            raise CloudError('{}: refused, field {!r} has the unknown type {}'.format(
                CLOUD_TYPE, field.name, field.datatype))
        stored = np.dtype(kind).newbyteorder('>' if raw.is_bigendian else '<')
        self._check(field, stored.itemsize)
        whole = np.ndarray((raw.height, raw.width), stored, raw.data, field.offset,
                           (_row_step(raw), raw.point_step))
        return whole[self._every]


def _thinned(height: int, width: int) -> Tuple[Tuple[slice, slice], int]:
    """Return (slices that keep about :data:`MAX_POINTS`, factor of thinning).

    Rows and columns are thinned alike, as far as possible, so that an organised cloud stays even.
    """
    times = -(-width * height // MAX_POINTS)
    across = min(width, max(math.isqrt(max(0, times - 1)) + 1, -(-times // height)))
    along = max(1, -(-height * -(-width // across) // MAX_POINTS))
    return (slice(None, None, along), slice(None, None, across)), along * across


def _measured(points: np.ndarray) -> Optional[np.ndarray]:
    """Return the indices of the points that are measurements, None if all are.

    :param points: float32 (3, n)
    """
    with np.errstate(invalid='ignore'):
        reach = np.abs(points).max(axis=0, initial=0.0)
        # Also false for NaN, and for a point at the sensor itself.
        good = (reach > 0.0) & (reach < BOUNDS[RANGE].greatest)
    return None if good.all() else np.flatnonzero(good)


def _chosen(values: np.ndarray, kept: Optional[np.ndarray]) -> np.ndarray:
    return values if kept is None else values.take(kept, axis=-1)


def _only(values: Optional[np.ndarray], kept: Optional[np.ndarray]) -> Optional[np.ndarray]:
    return None if values is None else _chosen(values, kept)
