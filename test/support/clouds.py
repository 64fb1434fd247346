# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Point clouds for tests, in every layout, as fields and as bytes of the wire.

Stands alone: nothing but numpy and the standard library.
"""
import struct

import numpy as np

TYPES = {'i1': 1, 'u1': 2, 'i2': 3, 'u2': 4, 'i4': 5, 'u4': 6, 'f4': 7, 'f8': 8}
XYZ = (('x', 'f4'), ('y', 'f4'), ('z', 'f4'))


def laid_out(columns, kinds=XYZ, gap=0, row_gap=0, width=None, bigendian=False):
    """Return (fields, width, height, point_step, row_step, data) of a message.

    A field is (name, offset, datatype, count).

    :param columns: {name: values}
    :param kinds: (name, type) in the order of the bytes
    :param gap: bytes of padding after each value
    :param row_gap: bytes of padding after each row
    :param width: points of a row, None: all
    """
    count = len(next(iter(columns.values())))
    width = count if width is None else width
    place, fields, formats = 0, [], []
    for name, kind in kinds:
        fields.append((name, place, TYPES[kind], 1))
        formats.append((name, kind, place))
        place += np.dtype(kind).itemsize + gap
    stored = np.dtype({
        'names': [name for name, _, _ in formats], 'offsets': [at for _, _, at in formats],
        'formats': [('>' if bigendian else '<') + kind for _, kind, _ in formats],
        'itemsize': place})
    points = np.zeros(count, stored)
    for name, _ in kinds:
        points[name] = columns[name]
    rows = [points[begin:begin + width].tobytes() + b'\xee' * row_gap
            for begin in range(0, count, width)]
    return (fields, width, len(rows), place, width * place + row_gap, b''.join(rows))


def cloud_message(fields, width, height, point_step, row_step, data, bigendian=False,
                  frame_id='laser'):
    """Return a serialised ``sensor_msgs/PointCloud2``."""
    def text(value):
        value = value.encode()
        return struct.pack('<I', len(value)) + value
    return b''.join((
        struct.pack('<III', 1, 2, 3), text(frame_id), struct.pack('<III', height, width,
                                                                  len(fields)),
        *(text(name) + struct.pack('<IBI', offset, kind, count)
          for name, offset, kind, count in fields),
        struct.pack('<BIII', bigendian, point_step, row_step, len(data)), data, b'\1'))


def room(count=307_200, seed=3):
    """Return columns of a floor, a wall ahead, and a box: x ahead, y left, z up [m], and rgb."""
    random = np.random.default_rng(seed)
    part = count // 3
    u, v = random.random((2, count), np.float32)
    x, y, z = 6.0 * u, 6.0 * v - 3.0, np.full(count, -0.3, np.float32)
    x[part:2 * part], z[part:2 * part] = 6.0, 2.4 * u[part:2 * part] - 0.3
    x[2 * part:], y[2 * part:] = 2.5, 0.5 * v[2 * part:]
    z[2 * part:] = 0.5 * u[2 * part:] - 0.3
    return {'x': x, 'y': y, 'z': z, 'rgb': random.integers(0, 1 << 24, count)}
