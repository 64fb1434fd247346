# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The registry of views: the displays of a robot in its tile.

To add a view, write a file in ``gui/`` (the widget), one in ``ros/`` (its feed), and a row here.
The classes are named, not imported: neither side depends on the other, and a view is loaded only
when it is shown.

A feed class has ``of(robot, kind, key)``, which returns a feed, or None if a robot of this type has
none; a feed has ``open()``, ``close()``, ``take()`` (the newest value, None if nothing is
new) and ``age_s()``. A widget class has ``show_value(value)``, ``show_age(age_s)``,
``save_settings()`` and ``restore_settings(settings)``. If a feed has ``status()``, a
:class:`mhri.camera.images.StreamStatus`, its bits count with those of the pictures, and its
widget has ``show_status(status)``. A widget may also have ``show_old(old)`` (the robot is silent),
``show_kind(kind)`` (of a shared widget), ``show_strip(strip)`` (it is a strip over the picture) and
``tools``, a widget with figures and controls that the tile shows with its switches.

The widget of a picture has ``canvas``, the widget with the picture itself, which has ``room()``
(the rectangle of the picture) and ``keep_clear(height)`` (of the top, covered by the header).
"""
from dataclasses import dataclass
from importlib import import_module
from typing import Any, Tuple

IMU, SCAN, CLOUD, RGB, DEPTH, RECORD = 'imu', 'scan', 'cloud', 'rgb', 'depth', 'record'
# Key of a feed without a view: pose and lens of the camera, to draw on the floor of its pictures.
FLOOR_CAMERA = 'floor_camera'
# Places of a view over a picture.
CORNER, STRIP = 'corner', 'strip'


@dataclass(frozen=True)
class ViewRow:
    """One view: key, label of its switch, class of its feed and of its widget.

    ``picture`` is true for views that fill the tile, one at a time; ``overlay`` is the place of the
    others over a picture: CORNER, or STRIP at the bottom. Rows with the same widget share it.
    """

    key: str
    label: str
    feed: str
    widget: str
    picture: bool = False
    overlay: str = ''


VIEW_ROWS: Tuple[ViewRow, ...] = (
    ViewRow(RGB, 'RGB', 'mhri.camera.ros.camera_feed.CameraFeed',
            'mhri.camera.gui.camera_view.CameraView', picture=True),
    ViewRow(DEPTH, 'depth', 'mhri.camera.ros.camera_feed.CameraFeed',
            'mhri.camera.gui.camera_view.CameraView', picture=True),
    ViewRow(CLOUD, 'point cloud', 'mhri.sensors.ros.cloud_feed.CloudFeed',
            'mhri.sensors.gui.cloud_view.CloudView', picture=True),
    ViewRow(SCAN, 'Laser scan', 'mhri.sensors.ros.lasers.Lasers',
            'mhri.sensors.gui.scan_view.ScanView', overlay=CORNER),
    ViewRow(IMU, 'IMU graph', 'mhri.sensors.ros.imu_feed.ImuFeed',
            'mhri.sensors.gui.imu_graph.ImuGraph', overlay=STRIP),
)
PICTURES = frozenset(row.key for row in VIEW_ROWS if row.picture)
CAMERAS = frozenset((RGB, DEPTH))
KEYS = frozenset(row.key for row in VIEW_ROWS)


def load(name: str) -> Any:
    """Return the class with the name ``package.module.Class``, as in a row."""
    module, _, attribute = name.rpartition('.')
    return getattr(import_module(module), attribute)
