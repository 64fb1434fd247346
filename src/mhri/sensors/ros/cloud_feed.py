# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A robot's newest point cloud: as published, or made from a depth picture and its lens."""
import time

from sensor_msgs.msg import CameraInfo

from mhri.base.names import topic_of
from mhri.camera.images import DEPTH, FrameError
from mhri.camera.ros.camera_decoder import Decoder
from mhri.camera.ros.camera_feed import CameraFeed
from mhri.camera.ros.pictures import read_depth
from mhri.camera.ros.samples import Samples
from mhri.camera.transports import find_offers, Offer
from mhri.graph.ros.refusals import Refusals
from mhri.graph.ros.subscription import Subscription
from mhri.sensors.point_cloud import (
    CLOUD_TYPE, CloudError, from_depth, Lens, parse_cloud, read_cloud)

# More are of no use to an operator, and each takes tens of milliseconds.
MAX_HZ = 5.0
_INFO_TYPE = 'sensor_msgs/CameraInfo'


def info_topic(depth_topic):
    """Return the topic of a depth picture's lens: ``camera_info`` beside it (image_transport)."""
    return depth_topic.rpartition('/')[0] + '/camera_info'


class CloudDecoder(Decoder):
    """Reads clouds, and depth pictures once their lens is known.

    :param name: the owner of the clouds, for the log
    """

    def __init__(self, name, wanted, clock):
        self._refusals = Refusals(name, clock)
        self._lens = None
        super().__init__(name, DEPTH, wanted, clock)

    def receive_lens(self, _, data):
        """Store the newest ``sensor_msgs/CameraInfo`` (rospy's thread)."""
        try:
            info = CameraInfo().deserialize(bytes(data))
        except Exception as error:  # genpy raises various types for malformed bytes
            self._refusals.note('a {} of these bytes ({!r})'.format(_INFO_TYPE, error))
            return
        self._lens = Lens(info.K[0], info.K[4], info.K[2], info.K[5], info.width, info.height)

    def read(self, message_type, data, view, received_s):
        """Return (:class:`mhri.sensors.point_cloud.Cloud`, its transport in words).

        :raises FrameError: the message is unreadable, or its lens has not been received yet
        """
        try:
            if message_type == CLOUD_TYPE:
                return parse_cloud(read_cloud(data), received_s), 'cloud'
            if self._lens is None:
                raise FrameError('nothing has come on camera_info yet')
            depth_m, _, transport = read_depth(message_type, data)
            return from_depth(depth_m, self._lens, received_s=received_s), transport
        except (CloudError, FrameError) as error:
            self._refusals.note(str(error))
            raise FrameError(str(error))


class _WithLens:
    """Adds a subscription of the lens to one of a depth picture."""

    def __init__(self, lens_topic, on_lens, *line):
        super().__init__(*line)
        self._lens = Subscription(lens_topic, on_lens)

    def close(self):
        try:
            super().close()
        finally:
            self._lens.close()


class _Depths(_WithLens, Subscription):
    """All pictures, and their lens."""


class _DepthSamples(_WithLens, Samples):
    """Single pictures, and their lens."""


class CloudFeed(CameraFeed):
    """A robot's point clouds, for a widget that polls them on a timer; newest only.

    Subscribes the first published one of ``/<robot>/<cloud>`` (``sensor_msgs/PointCloud2``) and
    ``/<robot>/<depth>`` (``sensor_msgs/CompressedImage`` or ``sensor_msgs/Image``, with the
    ``camera_info`` beside it, ``sensor_msgs/CameraInfo``). Search, subscription and decoding work
    as for a camera's pictures; :meth:`take` returns a :class:`Cloud`.

    :param robot: namespace of the robot
    :param clouds: topics of clouds relative to it, in order of preference
    :param depths: topics of depth pictures relative to it, without transport
    """

    @classmethod
    def of(cls, robot, kind, key):
        """Return the feed of a robot, None for a type with neither clouds nor depth pictures."""
        return cls(robot, kind.cloud, kind.depth) if kind.cloud or kind.depth else None

    def __init__(self, robot, clouds, depths=(), clock=time.monotonic):
        super().__init__(robot, [*clouds, *depths], DEPTH, clock=clock)
        self.word = 'point cloud'
        self._clouds = [topic_of(robot, topic) for topic in clouds]
        self._depths = [topic_of(robot, topic) for topic in depths]
        self.set_view(max_hz=MAX_HZ)

    def refused(self):
        """Return the number of unreadable clouds left out."""
        return self.status().bad

    def new_session(self, wanted):
        """Return the decoder of one opening."""
        return CloudDecoder(self.robot, wanted, self._clock)

    def find_offers(self, published):
        """Return the offers, best first: clouds, then depth pictures with a lens."""
        offers = [Offer('cloud', topic) for topic in self._clouds
                  if published.get(topic) == CLOUD_TYPE]
        depths = [topic for topic in self._depths if published.get(info_topic(topic)) == _INFO_TYPE]
        return offers + find_offers(DEPTH, depths, published)

    def line_of(self, session, offer, receive):
        """Return (class, arguments) of the subscription of an offer and its lens."""
        return self._with_lens(_Depths, session, offer,
                               super().line_of(session, offer, receive))

    def samples_of(self, session, offer, receive, grant, native_hz):
        """Return the same for single pictures."""
        return self._with_lens(_DepthSamples, session, offer, super().samples_of(
            session, offer, receive, grant, native_hz))

    def _with_lens(self, line_class, session, offer, line):
        if offer.transport == 'cloud':
            return line
        depth = next(topic for topic in self._depths if offer.topic.startswith(topic))
        return (line_class, info_topic(depth), session.receive_lens, *line[1:])
