# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Scans of a robot's depth camera for the obstacle brake, at most ten per second."""
from collections import namedtuple

from mhri.base.names import topic_of
from mhri.base.wire import Wire
from mhri.camera.images import FrameError
from mhri.camera.ros.pictures import read_depth
from mhri.sensors.depth_beams import DepthBeams
from mhri.sensors.point_cloud import CloudError
from mhri.sensors.ros.cloud_feed import CloudDecoder, CloudFeed

# The rate of a laser; each scan takes a few milliseconds.
MAX_HZ = 10.0

_Read = namedtuple('_Read', 'received_s')


class _ScanDecoder(CloudDecoder):
    """Reads depth pictures once their lens is known, and passes each on as a scan."""

    def __init__(self, name, wanted, clock, mounts, on_scan):
        self._mounts = mounts
        self._on_scan = on_scan
        self._beams = DepthBeams()
        super().__init__(name, wanted, clock)

    def read(self, message_type, data, view, received_s):
        """Pass a picture on as a scan; return a stand-in for it, and its transport.

        :raises FrameError: it is unreadable, has no measurement, or its lens is not known yet
        """
        if self._lens is None:
            raise FrameError('nothing has come on camera_info yet')
        try:
            wire = Wire(message_type, data, FrameError)
            _, stamp_s = wire.header()
            depth_m, _, transport = read_depth(message_type, data)
            scan = self._beams.scan(depth_m, self._lens, *self._mounts.camera(wire.text()))
        except (CloudError, FrameError) as error:
            self._refusals.note(str(error))
            raise FrameError(str(error))
        self._on_scan(scan, received_s, stamp_s)
        return _Read(received_s), transport


class DepthScans(CloudFeed):
    """Looks for the depth pictures of a robot and the ``camera_info`` beside them, once open.

    ``/<robot>/<depth>/compressedDepth`` (``sensor_msgs/CompressedImage``) or ``/<robot>/<depth>``
    (``sensor_msgs/Image``): the first one published.

    :param depths: topics relative to the robot, in order of preference, without transport
    :param mounts: :class:`mhri.sensors.ros.mounts.Mounts`
    :param on_scan: called with (:class:`mhri.sensors.brake.Scan`, when it was received [s],
        its stamp [s]) on the decoder's thread
    """

    def __init__(self, robot, depths, mounts, on_scan, clock):
        super().__init__(robot, (), depths, clock)
        self._mounts = mounts
        self._on_scan = on_scan
        self._name = ', '.join(topic_of(robot, topic) for topic in depths)
        self.set_view(max_hz=MAX_HZ)

    def new_session(self, wanted):
        """Return the decoder of one opening."""
        return _ScanDecoder(self._name, wanted, self._clock, self._mounts, self._on_scan)
