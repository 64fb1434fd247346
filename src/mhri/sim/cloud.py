# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The point cloud from a simulated robot's camera."""
import numpy as np

from mhri.sim.lens import CENTRE_X_PX, CENTRE_Y_PX, FOCAL_PX, HEIGHT, WIDTH

#: The memory layout of a pcl::PointXYZRGB: metres, and 0x00rrggbb in four bytes.
LAYOUT = np.dtype({'names': ['x', 'y', 'z', 'rgb'], 'formats': ['<f4', '<f4', '<f4', '<u4'],
                   'offsets': [0, 4, 8, 16], 'itemsize': 32})
_RIGHT = ((np.arange(WIDTH) - CENTRE_X_PX) / FOCAL_PX).astype(np.float32)
_DOWN = ((np.arange(HEIGHT) - CENTRE_Y_PX) / FOCAL_PX).astype(np.float32)[:, None]


def cloud_of(depth_mm, rgb):
    """Return the points of a picture, (480, 640) of :data:`LAYOUT`, NaN without depth.

    x is to the right, y down, z ahead (REP-103, optical frames).

    :param depth_mm: uint16 (480, 640), 0 for no measurement
    :param rgb: uint8 (480, 640, 3)
    """
    points = np.zeros(depth_mm.shape, LAYOUT)
    depth_m = depth_mm * np.float32(0.001)
    depth_m[depth_mm == 0] = np.nan
    points['z'] = depth_m
    points['x'] = depth_m * _RIGHT
    points['y'] = depth_m * _DOWN
    red, green, blue = (rgb[..., index].astype(np.uint32) for index in range(3))
    points['rgb'] = red << 16 | green << 8 | blue
    return points
