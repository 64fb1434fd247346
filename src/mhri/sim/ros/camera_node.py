# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The simulated robot's camera on ROS, with the first RGB and depth topic of its template.

- ``<rgb>`` ``sensor_msgs/Image`` rgb8 and ``<rgb>/compressed`` ``sensor_msgs/CompressedImage``
  jpeg, 640x480, 30 Hz
- ``<depth>`` ``sensor_msgs/Image`` 16UC1 [mm], 0 nothing within 10 m, and
  ``<depth>/compressedDepth`` ``sensor_msgs/CompressedImage`` png or rvl, 640x480, 15 Hz, pixel by
  pixel that of the RGB picture
- ``<cloud>`` ``sensor_msgs/PointCloud2``, 640x480, 5 Hz: depth and colour as points
- ``camera_info`` beside each ``sensor_msgs/CameraInfo``, at the rate of the picture

All in the frame ``<robot>/camera_rgb_optical_frame``, which a head turns; its tilt moves the centre
of the picture (``camera_info``). Pictures are only drawn and encoded for subscribers. OpenCV takes
half of the start, and is only loaded for a camera with topics.
"""
import threading

import rospy
from sensor_msgs.msg import CameraInfo, CompressedImage, Image, PointCloud2, PointField

from mhri.sim.cloud import cloud_of, LAYOUT
from mhri.sim.lens import CENTRE_X_PX, CENTRE_Y_PX, FOCAL_PX, HEIGHT, WIDTH
from mhri.sim.ros.fault_node import Healthy
from mhri.sim.ticks import Due, Ticks
from mhri.sim.tools import MAX_TILT_RAD, rows_of_tilt

RGB_HZ = 30
DEPTH_EVERY = 2
# At every sixth RGB picture, since a cloud is ten megabytes.
CLOUD_EVERY = 6
# Maximum time of a frame, except on an overloaded machine.
FRAME_S = 0.5
JPEG_QUALITY = 80
DEPTH_FORMATS = ('png', 'rvl')


class _Stream:
    """The topics of one kind of picture: raw, compressed, and camera info."""

    def __init__(self, topic, transport, encoding, frame_id, compress, failing):
        self._failing = failing
        self._compress = compress
        self._raw = rospy.Publisher(topic, Image, queue_size=1)
        self._compressed = rospy.Publisher(topic + '/' + transport, CompressedImage, queue_size=1)
        self._info = rospy.Publisher(topic.rpartition('/')[0] + '/camera_info', CameraInfo,
                                     queue_size=1)
        self._image = Image(width=WIDTH, height=HEIGHT, encoding=encoding, is_bigendian=0)
        self._info_msg = camera_info()
        self._frame_id = frame_id

    def wanted(self):
        """Return whether a picture has subscribers."""
        return self._raw.get_num_connections() + self._compressed.get_num_connections() > 0

    def publish_info(self, stamp, shift):
        """Publish the camera info.

        :param shift: rows by which the horizon is below the middle of the picture
        """
        if self._info.get_num_connections():
            self._info_msg.K[5] = self._info_msg.P[6] = CENTRE_Y_PX + shift
            self._failing.send(self._info, self._stamped(self._info_msg, stamp), 'camera')

    def publish(self, pixels, stamp):
        """Publish a picture on every topic with a subscriber."""
        if self._raw.get_num_connections():
            self._image.step = pixels.strides[0]
            self._image.data = pixels.tobytes()
            self._failing.send(self._raw, self._stamped(self._image, stamp), 'camera')
        if self._compressed.get_num_connections():
            fmt, data = self._compress(pixels)
            message = CompressedImage(format=fmt, data=data)
            self._failing.send(self._compressed, self._stamped(message, stamp), 'camera')

    def _stamped(self, message, stamp):
        message.header.stamp = stamp
        message.header.frame_id = self._frame_id
        return message


class _Cloud:
    """The topic of the cloud, organised like depth_image_proc's from a Kinect's pictures."""

    def __init__(self, topic, frame_id, failing):
        self._failing = failing
        self._publisher = rospy.Publisher(topic, PointCloud2, queue_size=1)
        self._message = PointCloud2(
            height=HEIGHT, width=WIDTH, is_bigendian=False, is_dense=False,
            point_step=LAYOUT.itemsize, row_step=LAYOUT.itemsize * WIDTH,
            fields=[PointField(name, LAYOUT.fields[name][1], PointField.FLOAT32, 1)
                    for name in ('x', 'y', 'z', 'rgb')])
        self._message.header.frame_id = frame_id

    def wanted(self):
        """Return whether it has subscribers."""
        return self._publisher.get_num_connections() > 0

    def publish(self, depth, rgb, stamp):
        """Publish the cloud of a depth picture [mm] and the colours of its pixels."""
        self._message.header.stamp = stamp
        self._message.data = cloud_of(depth, rgb).tobytes()
        self._failing.send(self._publisher, self._message, 'camera')


def compress(rgb):
    """Return (format, data) of a picture (h, w, 3) uint8, red, green, blue."""
    from mhri.camera.jpeg import encode_jpeg
    return 'rgb8; jpeg compressed bgr8', encode_jpeg(rgb, JPEG_QUALITY)


def compress_depth(depth, kind):
    """Return (format, data) of a depth picture (h, w) uint16 [mm], as 'png' or 'rvl'."""
    from mhri.camera.depth_codec import encode_depth
    return encode_depth(depth, kind)


def camera_of(plan, max_shift=0):
    """Return the :class:`mhri.sim.camera.Camera` of a building."""
    from mhri.base.opencv import cv2
    from mhri.sim.camera import Camera
    # OpenCV's own threads would spin on every core and delay the next step of the physics.
    cv2.setNumThreads(1)
    return Camera(plan, max_shift)


def camera_info():
    """Return the ``CameraInfo`` of the simulated camera: a pinhole, without distortion."""
    return CameraInfo(
        width=WIDTH, height=HEIGHT, distortion_model='plumb_bob', D=[0.0] * 5,
        K=[FOCAL_PX, 0.0, CENTRE_X_PX, 0.0, FOCAL_PX, CENTRE_Y_PX, 0.0, 0.0, 1.0],
        R=[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0],
        P=[FOCAL_PX, 0.0, CENTRE_X_PX, 0.0, 0.0, FOCAL_PX, CENTRE_Y_PX, 0.0, 0.0, 0.0, 1.0, 0.0])


class SimCamera:
    """Publishes the pictures of one robot's camera, on its own thread.

    :param name: the robot; also the prefix of its frame
    :param template: :class:`RobotType`; kinds without a topic are not published
    :param plan: :class:`mhri.sim.plan.Plan`
    :param pose_source: function () -> (x, y, yaw) of the robot [m, m, rad], called on the thread
    :param others_source: function () -> the other robots, as :meth:`mhri.sim.world.World.others`
    :param depth_format: 'png' or 'rvl', of ``compressedDepth``
    :param failing: :class:`mhri.sim.ros.fault_node.Failing`; None: without faults
    :param tools: :class:`mhri.sim.ros.tools_node.SimTools`; None: without lamp and head
    :raises ValueError: unknown depth format
    """

    def __init__(self, name, template, plan, pose_source, others_source, depth_format='png',
                 failing=None, tools=None):
        if depth_format not in DEPTH_FORMATS:
            raise ValueError('depth_format: expected one of {}, got {!r}'.format(
                ', '.join(DEPTH_FORMATS), depth_format))
        self._plan, self._camera, self._tools = plan, None, tools
        self._failing = failing = failing or Healthy()
        self._pose_source = pose_source
        self._others_source = others_source
        self._done = threading.Event()
        self._thread = None
        prefix, frame_id = '/' + name + '/', name + '/camera_rgb_optical_frame'
        self._rgb = _Stream(prefix + template.rgb[0], 'compressed', 'rgb8', frame_id,
                            compress, failing) if template.rgb else None
        self._depth = _Stream(
            prefix + template.depth[0], 'compressedDepth', '16UC1', frame_id,
            lambda depth: compress_depth(depth, depth_format), failing) if template.depth else None
        self._cloud = _Cloud(prefix + template.cloud[0], frame_id,
                             failing) if template.cloud else None

    def start(self):
        """Start publishing until the node ends, or until :meth:`stop`."""
        if self._rgb or self._depth or self._cloud:
            # Load OpenCV now, not at the first subscriber: no other thread may run meanwhile.
            self._camera = camera_of(self._plan, rows_of_tilt(MAX_TILT_RAD)
                                     if self._tools is not None and self._tools.turns else 0)
            rospy.on_shutdown(self.stop)
            self._thread = threading.Thread(target=self._run, name='camera', daemon=True)
            self._thread.start()

    def stop(self):
        """Stop, and wait for the current frame; the topics may be closed afterwards."""
        self._done.set()
        if self._thread not in (None, threading.current_thread()):
            self._thread.join(FRAME_S)

    def _run(self):
        """Publish at absolute times; skip frames that would be late."""
        ticks, tick = Ticks(1.0 / RGB_HZ, sleep=self._done.wait), 0
        depth, cloud = Due(DEPTH_EVERY), Due(CLOUD_EVERY)
        try:
            while not self._done.is_set():
                self._frame(depth.at(tick), cloud.at(tick))
                tick, _, _ = ticks.wait()
        except rospy.ROSException:
            # The topics may close during a slow frame, a little before rospy reports its shutdown.
            if not (self._done.is_set() or rospy.is_shutdown()):
                raise

    def _frame(self, with_depth, with_cloud):
        """Draw and publish the due and subscribed pictures, all of the same instant."""
        due = [stream for stream, is_due in ((self._rgb, True), (self._depth, with_depth))
               if stream and is_due]
        wanted = [stream for stream in due if stream.wanted()]
        stamp, tools = self._failing.stamp(), self._tools
        pan_rad, shift, light = (tools.pan_rad, tools.shift, tools.light) if tools is not None \
            else (0.0, 0, 1.0)
        for stream in due:
            stream.publish_info(stamp, shift)
        with_cloud = with_cloud and self._cloud is not None and self._cloud.wanted()
        if not wanted and not with_cloud:
            return
        x, y, yaw = self._pose_source()
        view = self._camera.look(x, y, yaw + pan_rad, self._others_source(), shift)
        for stream in wanted:
            stream.publish(self._camera.rgb(view, light) if stream is self._rgb
                           else self._camera.depth(view), stamp)
        if with_cloud:
            self._cloud.publish(self._camera.depth(view), self._camera.rgb(view, light), stamp)
