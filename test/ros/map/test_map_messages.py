# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The map and tf as ROS writes them: files of map_server, messages, and bytes of tf."""
import io
import math
import struct

import cv2
from geometry_msgs.msg import TransformStamped
from nav_msgs.msg import OccupancyGrid
import numpy as np
import pytest
import rospy
from tf2_msgs.msg import TFMessage

from mhri.base.config import ConfigError
from mhri.map.grid import GridError
from mhri.map.ros.map_source import grid_message, grid_of_message, load_map, MapSource
from mhri.robots.ros.tf_feed import TfFeed, transforms

YAML = 'image: {}\nresolution: 0.05\norigin: [-1, -2, 0.5]\nnegate: 0\n' \
    'occupied_thresh: 0.65\nfree_thresh: 0.196\n'


@pytest.fixture(autouse=True)
def stamped(monkeypatch):
    monkeypatch.setattr(rospy.Time, 'now', lambda: rospy.Time(5))


@pytest.fixture
def deliver(monkeypatch):
    """Return a function that hands bytes to the subscriber of a topic."""
    callbacks = {}

    def subscribe(topic, kind, callback, *more, **options):
        callbacks[topic] = lambda data: callback(kind().deserialize(data), *more)
    monkeypatch.setattr(rospy, 'Subscriber', subscribe)
    return lambda topic, data: callbacks[topic](data)


def on_the_wire(message):
    buffer = io.BytesIO()
    message.serialize(buffer)
    return buffer.getvalue()


@pytest.mark.parametrize('name', ['hall.pgm', 'hall.png'])
def test_a_file_of_map_server_becomes_a_message_and_a_grid_again(tmp_path, deliver, name):
    cv2.imwrite(str(tmp_path / name), np.array([[0, 255, 205], [255, 255, 0]], dtype=np.uint8))
    path = tmp_path / 'hall.yaml'
    path.write_text(YAML.format(name))
    grid = load_map(str(path))
    assert grid.cells.tolist() == [[0, 0, 100], [100, 0, -1]]
    buffer = io.BytesIO()
    grid_message(grid).serialize_numpy(buffer, np)
    message = OccupancyGrid().deserialize(buffer.getvalue())
    assert list(message.data) == [0, 0, 100, 100, 0, -1]
    assert (message.header.frame_id, message.info.width, message.info.height) == ('map', 3, 2)
    source = MapSource()
    source.start()
    assert not source.is_there and source.grid() is None
    deliver('/map', buffer.getvalue())
    assert source.is_there
    again = source.grid()
    assert again.cells.tolist() == grid.cells.tolist()
    assert again.origin.heading_rad == pytest.approx(0.5)


@pytest.mark.parametrize('name', ['none.pgm', '.', '/dev/zero', 'hall.yaml'])
def test_a_picture_that_is_none_is_refused_by_name(tmp_path, name):
    path = tmp_path / 'hall.yaml'
    path.write_text(YAML.format(name))
    with pytest.raises(ConfigError) as refused:
        load_map(str(path))
    assert 'hall.yaml: image' in str(refused.value)


@pytest.mark.parametrize('head', [
    b'P5 30000 30000 255\n', b'\x89PNG\r\n\x1a\n\0\0\0\rIHDR' + 2 * (30000).to_bytes(4, 'big')])
def test_a_picture_that_is_too_large_is_refused_before_it_is_unpacked(tmp_path, monkeypatch, head):
    (tmp_path / 'vast.pgm').write_bytes(head)
    monkeypatch.setattr(cv2, 'imread', lambda *_: pytest.fail('it is unpacked'))
    path = tmp_path / 'hall.yaml'
    path.write_text(YAML.format('vast.pgm'))
    with pytest.raises(ConfigError) as refused:
        load_map(str(path))
    assert '30000 x 30000' in str(refused.value)


@pytest.mark.parametrize('change', [
    dict(width=7), dict(width=2 ** 31, height=2 ** 31), dict(resolution=0.0),
    dict(resolution=math.nan)])
def test_an_impossible_map_is_refused(deliver, change):
    message = OccupancyGrid(data=[0, 100])
    message.info.width, message.info.height, message.info.resolution = 2, 1, 0.1
    for key, value in change.items():
        setattr(message.info, key, value)
    source = MapSource()
    source.start()
    deliver('/map', on_the_wire(message))
    with pytest.raises(GridError):
        source.grid()


def test_bytes_that_are_no_map_are_refused(deliver):
    source = MapSource()
    source.start()
    deliver('/map', b'\xff' * 40)
    with pytest.raises(GridError):
        source.grid()


def tf(*frames):
    found = TFMessage()
    for number, (parent, child) in enumerate(frames, 1):
        edge = TransformStamped(child_frame_id=child)
        edge.header.frame_id = parent
        edge.transform.translation.x, edge.transform.rotation.w = float(number), 1.0
        found.transforms.append(edge)
    return found


def test_the_bytes_of_tf_are_read_as_they_are():
    found = list(transforms(on_the_wire(tf(('/map', 'bot1/odom'), ('bot1/odom', 'ü')))))
    assert found == [('map', 'bot1/odom', (1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0)),
                     ('bot1/odom', 'ü', (2.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0))]
    assert list(transforms(on_the_wire(TFMessage()))) == []


def test_tf_is_as_old_as_its_receipt_and_static_tf_has_no_age(deliver):
    feed, now = TfFeed(lambda: now[0]), [3.0]
    feed.open()
    deliver('/tf', on_the_wire(tf(('map', 'odom'))))
    deliver('/tf_static', on_the_wire(tf(('map', 'hall'))))
    assert feed.find('map', 'odom')[1] == 3.0
    assert feed.find('map', 'hall')[1] is None
    assert feed.knows('hall') and not feed.knows('moon')


@pytest.mark.parametrize('buff', [
    b'', b'\1\0\0', b'\5\0\0\0', struct.pack('<I', 2 ** 32 - 1) + b'\xff' * 200,
    on_the_wire(tf(('map', 'odom')))[:-3],
    on_the_wire(tf(('map', 'odom'))).replace(b'odom', b'\xff\xff\xff\xff')])
def test_bytes_that_are_no_tf_change_nothing(deliver, buff):
    feed = TfFeed(lambda: 0.0)
    feed.open()
    deliver('/tf', buff)
    assert not feed.knows('map')


@pytest.mark.parametrize('z, heading', [(0.0, 0.0), (1.0, math.pi), (0.5, None)])
def test_a_map_without_an_orientation_is_unturned_and_an_impossible_one_is_none(z, heading):
    message = OccupancyGrid(data=np.zeros(4, np.int8))
    message.info.resolution, message.info.width, message.info.height = 0.05, 2, 2
    message.info.origin.orientation.z = z
    if heading is None:
        with pytest.raises(GridError):
            grid_of_message(message)
    else:
        assert grid_of_message(message).origin.heading_rad == pytest.approx(heading)
