# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Pictures as real cameras make them, and messages as they lie on the wire, without ROS."""
import struct

import cv2
import numpy as np


def colour_picture(width=640, height=480, seed=1):
    """Return an RGB picture with gradients, edges and sensor noise."""
    random = np.random.RandomState(seed)
    y, x = np.indices((height, width))
    picture = np.stack([x * 255 // width, y * 255 // height, (x + y) // 4 % 256], 2)
    picture = np.ascontiguousarray(picture, np.uint8)
    for _ in range(40):
        left, top = random.randint(0, width), random.randint(0, height)
        size = random.randint(10, 120, 2)
        cv2.rectangle(picture, (left, top), (left + int(size[0]), top + int(size[1])),
                      tuple(int(value) for value in random.randint(0, 255, 3)), -1)
    noisy = picture + random.normal(0, 5, picture.shape)
    return np.clip(noisy, 0, 255).astype(np.uint8)


def depth_picture(width=640, height=480, seed=1):
    """Return a depth picture [mm]: floor, wall, boxes, noise, shadows at edges and specks (0)."""
    random = np.random.RandomState(seed)
    y, x = np.indices((height, width))
    depth = np.where(y > height // 2, height / np.maximum(y - height / 2 + 1, 1), 6.0)
    depth = np.minimum(depth, 4.0 + x / width)
    for _ in range(12):
        left, top = random.randint(0, width), random.randint(height // 5, height)
        size = random.randint(20, 90)
        box = (abs(x - left) < size) & (abs(y - top) < size)
        depth = np.where(box, np.minimum(depth, random.uniform(0.8, 4.0)), depth)
    edges = (abs(np.diff(depth, axis=1, prepend=depth[:, :1])) > 0.1).astype(np.uint8)
    depth += random.normal(0, 0.0012, depth.shape) * depth ** 2
    millimetres = np.clip(depth * 1000.0, 400, 10000).astype(np.uint16)
    millimetres[cv2.dilate(edges, np.ones((3, 7))) > 0] = 0
    millimetres[random.uniform(size=depth.shape) < 0.004] = 0
    millimetres[:, :12] = 0
    return millimetres


def _text(value):
    data = value.encode()
    return struct.pack('<I', len(data)) + data


def compressed_message(fmt, data):
    """Return a serialised ``sensor_msgs/CompressedImage``."""
    return (struct.pack('<III', 1, 2, 3) + _text('camera') + _text(fmt)
            + struct.pack('<I', len(data)) + bytes(data))


def raw_message(encoding, height, width, data, step=0, is_bigendian=0):
    """Return a serialised ``sensor_msgs/Image``."""
    return (struct.pack('<III', 1, 2, 3) + _text('camera') + struct.pack('<II', height, width)
            + _text(encoding) + struct.pack('<BII', is_bigendian, step, len(data)) + bytes(data))
