# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The registry of views: what a tile can show of its robot.

To add a view, write a file in ``gui/`` (the widget), one in ``ros/`` (its feed), and a row here.
The classes are named, not imported: neither side knows the other, and a view is loaded only when
somebody looks at it.

A feed class has ``of(robot, kind, key)``, which returns a feed, or None if a robot of this type has
none; a feed has ``open()``, ``close()``, ``take()`` (the newest value, None if nothing is
new) and ``age_s()``. A widget class has ``show_value(value)``, ``show_age(age_s)``,
``save_settings()`` and ``restore_settings(settings)``. If a feed has ``status()``, a
:class:`mhri.camera.images.StreamStatus`, its bits count with those of the pictures, and its
widget has ``show_status(status)``.
"""
from dataclasses import dataclass
from importlib import import_module
from typing import Any, Tuple

IMU, SCAN, CLOUD, RGB, DEPTH, RECORD = 'imu', 'scan', 'cloud', 'rgb', 'depth', 'record'


@dataclass(frozen=True)
class ViewRow:
    """One view: key, label of its switch, class of its feed and of its widget.

    ``picture`` is true for views of which a tile shows one at a time; rows with the same widget
    share it.
    """

    key: str
    label: str
    feed: str
    widget: str
    picture: bool = False


VIEW_ROWS: Tuple[ViewRow, ...] = (
    ViewRow(RGB, 'RGB', 'mhri.camera.ros.camera_feed.CameraFeed',
            'mhri.camera.gui.camera_view.CameraView', picture=True),
    ViewRow(DEPTH, 'depth', 'mhri.camera.ros.camera_feed.CameraFeed',
            'mhri.camera.gui.camera_view.CameraView', picture=True),
    ViewRow(CLOUD, 'Point cloud', 'mhri.sensors.ros.cloud_feed.CloudFeed',
            'mhri.sensors.gui.cloud_view.CloudView'),
    ViewRow(SCAN, 'Laser scan', 'mhri.sensors.ros.lasers.Lasers',
            'mhri.sensors.gui.scan_view.ScanView'),
    ViewRow(IMU, 'IMU graph', 'mhri.sensors.ros.imu_feed.ImuFeed',
            'mhri.sensors.gui.imu_graph.ImuGraph'),
)
PICTURES = frozenset(row.key for row in VIEW_ROWS if row.picture)
KEYS = frozenset(row.key for row in VIEW_ROWS)


def load(name: str) -> Any:
    """Return the class that a row names as ``package.module.Class``."""
    module, _, attribute = name.rpartition('.')
    return getattr(import_module(module), attribute)
