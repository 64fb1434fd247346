# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Point clouds: every layout is read right, and none that lies is read at all."""
import math
import struct

import numpy as np
import pytest

from mhri.sensors.point_cloud import (
    CloudError, Field, from_depth, Lens, MAX_POINTS, parse_cloud, RawCloud, read_cloud)
from support.clouds import cloud_message, laid_out, XYZ

POINTS = np.array([(1, 2, 3), (-4, 5, -6), (7, 8, 9), (10, -11, 12), (1, 0, 0), (0, 1, 0)], 'f4')
COLUMNS = {'x': POINTS[:, 0], 'y': POINTS[:, 1], 'z': POINTS[:, 2],
           'intensity': np.arange(6) * 10, 'ring': np.arange(6), '_': np.zeros(6),
           'rgb': np.array([0x010203, 0xff0000, 0x00ff00, 0x0000ff, 0x808080, 0xfffefd], 'u4'),
           'rgba': np.array([0x44010203, 0xffff0000, 0x00ff00, 0x0000ff, 0x808080, 0xfffefd], 'u4'),
           'r': np.array([1, 255, 0, 0, 128, 255]), 'g': np.array([2, 0, 255, 0, 128, 254]),
           'b': np.array([3, 0, 0, 255, 128, 253])}
RGB = 0xff000000 | COLUMNS['rgb'].astype('u4')
WHOLE = (('x', 'i4'), ('y', 'i4'), ('z', 'i4'))
LAYOUTS = {
    'xyz': XYZ,
    'float64': (('x', 'f8'), ('y', 'f8'), ('z', 'f8')),
    'int32': WHOLE,
    'int16': (('x', 'i2'), ('y', 'i2'), ('z', 'i2')),
    'int8': (('x', 'i1'), ('y', 'i1'), ('z', 'i1')),
    'mixed, backwards': (('z', 'f8'), ('intensity', 'u2'), ('y', 'i1'), ('x', 'f4')),
    'xyzi': XYZ + (('intensity', 'f4'),),
    'velodyne': XYZ + (('intensity', 'f4'), ('ring', 'u2')),
    'intensity in bytes': (('intensity', 'u1'),) + XYZ,
    'xyzrgb': XYZ + (('_', 'f4'), ('rgb', 'u4')),
    'xyzrgba': XYZ + (('rgba', 'u4'),),
    'rgb first': (('rgb', 'u4'),) + XYZ,
    'three colours': XYZ + (('r', 'u1'), ('g', 'u1'), ('b', 'u1')),
}


def raw_cloud(layout, bigendian=False, frame_id='laser'):
    fields, *sizes, data = layout
    return RawCloud(tuple(Field(*field) for field in fields), *sizes, bigendian, data, frame_id)


def xyz(points=POINTS, **more):
    return raw_cloud(laid_out(dict(zip('xyz', np.asarray(points).T)), **more))


@pytest.mark.parametrize('gap, row_gap, width', [
    (0, 0, None), (3, 0, None), (0, 0, 3), (1, 7, 2), (16, 5, 6)])
@pytest.mark.parametrize('bigendian', [False, True])
@pytest.mark.parametrize('name', LAYOUTS)
def test_every_layout(name, bigendian, gap, row_gap, width):
    kinds = LAYOUTS[name]
    layout = laid_out(COLUMNS, kinds, gap, row_gap, width, bigendian)
    cloud = parse_cloud(read_cloud(cloud_message(*layout, bigendian)), 4.5)
    assert cloud.points.dtype == np.float32 and np.array_equal(cloud.points, POINTS)
    assert (cloud.sent, cloud.kept_of, cloud.received_s) == (6, 1, 4.5)
    names = [name for name, _ in kinds]
    if {'rgb', 'rgba', 'r'} & set(names):
        assert cloud.colours.dtype == np.uint32 and np.array_equal(cloud.colours, RGB)
    else:
        assert cloud.colours is None
    if 'intensity' in names:
        assert np.array_equal(cloud.intensity, COLUMNS['intensity'])
    else:
        assert cloud.intensity is None


def test_colour_in_a_float_is_its_bytes():
    """As PCL writes it, most of which are tiny numbers or NaN."""
    packed = np.array([0x010203, 0xffc00001, 0x7f800000], 'u4')
    columns = dict(zip('xyz', POINTS[:3].T), rgb=packed.view('f4'))
    cloud = parse_cloud(raw_cloud(laid_out(columns, XYZ + (('rgb', 'f4'),))))
    assert cloud.colours.tolist() == [0xff010203, 0xffc00001, 0xff800000]


@pytest.mark.parametrize('place', [
    (math.nan, 0, 0), (0, math.inf, 0), (0, 0, -math.inf), (0, 0, 0), (3e38, 0, 0), (0, 20000, 0)])
def test_what_is_no_measurement_is_left_out(place):
    columns = dict(zip('xyz', np.vstack((POINTS[:1], [place], POINTS[1:2])).T), rgb=RGB[:3],
                   intensity=[1, 2, 3])
    cloud = parse_cloud(raw_cloud(laid_out(
        columns, XYZ + (('rgb', 'u4'), ('intensity', 'f4')), width=3)))
    assert np.array_equal(cloud.points, POINTS[:2]) and cloud.sent == 3
    assert cloud.colours.tolist() == [RGB[0], RGB[2]] and cloud.intensity.tolist() == [1, 3]


@pytest.mark.parametrize('frame_id, optical', [
    ('camera_depth_optical_frame', True), ('bot1/camera_rgb_optical_frame', True),
    ('velodyne', False), ('', False), ('optical_frame_of_nothing', False)])
def test_optical_frames_are_known_by_their_name(frame_id, optical):
    assert parse_cloud(xyz()._replace(frame_id=frame_id)).optical == optical


@pytest.mark.parametrize('width, height', [
    (1, 3_000_000), (3_000_000, 1), (1_500_000, 2), (700, 4400)])
def test_of_any_shape_about_the_most_is_kept(width, height):
    data = np.ones((width * height, 3), 'f4').tobytes()
    fields = tuple(Field(name, 4 * index, 7) for index, name in enumerate('xyz'))
    cloud = parse_cloud(RawCloud(fields, width, height, 12, 12 * width, False, data))
    assert 0.2 * MAX_POINTS < len(cloud.points) <= 1.01 * MAX_POINTS
    assert cloud.sent == width * height


@pytest.mark.parametrize('width, height', [(0, 0), (0, 1), (5, 0)])
def test_no_points_are_a_cloud_without_any(width, height):
    for fields in (xyz().fields, ()):
        cloud = parse_cloud(RawCloud(fields, width, height, 0, 0, False, b''))
        assert cloud.points.shape == (0, 3) and cloud.sent == 0


def with_field(**changes):
    first, *others = xyz().fields
    return {'fields': (first._replace(**changes), *others)}


@pytest.mark.parametrize('changes, said', [
    ({'data': b''}, 'truncated, 0 of 72 bytes'),
    ({'data': b'\0' * 71}, 'truncated, 71 of 72 bytes'),
    ({'width': 7}, 'truncated, 72 of 84 bytes'),
    ({'width': 2 ** 32 - 1, 'height': 2 ** 32 - 1}, '4,294,967,295 x 4,294,967,295 points'),
    ({'height': 2 ** 32 - 1}, 'truncated'),
    ({'height': 2, 'row_step': 2 ** 32 - 1}, 'truncated'),
    ({'height': 2, 'width': 3, 'row_step': 35}, '12 bytes for a point and 35 for a row'),
    ({'width': -6}, 'a size below zero'), ({'row_step': -1}, 'a size below zero'),
    ({'point_step': 0}, '0 bytes for a point'),
    ({'point_step': 2 ** 32 - 1}, 'truncated'),
    ({'point_step': 11}, "field 'z' ends at byte 12 of a point of 11"),
    ({'fields': ()}, 'no fields x, y and z among none'),
    ({'fields': xyz().fields[:2]}, "no fields x, y and z among 'x', 'y'"),
    (with_field(offset=9), "field 'x' ends at byte 13 of a point of 12"),
    (with_field(offset=2 ** 32 - 1), "field 'x' ends at byte 4,294,967,299 of a point"),
    (with_field(offset=-4), "field 'x' ends at byte 0"),
    (with_field(datatype=0), "field 'x' has the unknown type 0"),
    (with_field(datatype=8, offset=5), "field 'x' ends at byte 13"),
    (with_field(values=2), "field 'x' has 2 values"),
    ({'fields': xyz().fields + (Field('rgb', 9, 7),)}, "field 'rgb' ends at byte 13"),
    ({'fields': xyz().fields + (Field('rgb', 0, 7, 3),)}, "field 'rgb' has 3 values"),
    ({'fields': xyz().fields + (Field('intensity', 0, 77),)},
     "field 'intensity' has the unknown type 77")])
def test_a_message_that_lies_is_refused(changes, said):
    with pytest.raises(CloudError) as caught:
        parse_cloud(xyz()._replace(**changes))
    assert said in str(caught.value) and 'PointCloud2' in str(caught.value)


def test_what_is_not_used_may_be_anything():
    odd = (Field('normal', 10 ** 9, 99, 33), Field('', 0, 0, 0), Field('x', 0, 200, 5))
    assert np.array_equal(parse_cloud(xyz()._replace(fields=xyz().fields + odd)).points, POINTS)


def test_every_truncation_of_the_wire_is_refused():
    whole = cloud_message(*laid_out(COLUMNS, LAYOUTS['xyzrgb']))
    for length in range(len(whole) - 1):
        with pytest.raises(CloudError):
            parse_cloud(read_cloud(whole[:length]))
    parse_cloud(read_cloud(whole[:-1]))  # is_dense is not asked for


def test_claims_of_the_wire_cost_nothing():
    head = struct.pack('<III', 1, 2, 3)
    for data, said in ((head + struct.pack('<I', 2 ** 32 - 1), 'truncated'),
                       (head + struct.pack('<IIII', 0, 1, 1, 2 ** 32 - 1), '4,294,967,295 fields')):
        with pytest.raises(CloudError, match=said):
            read_cloud(data)


def test_random_damage_is_refused_or_read():
    random = np.random.default_rng(11)
    whole = np.frombuffer(cloud_message(*laid_out(COLUMNS, LAYOUTS['velodyne'], width=3)), 'u1')
    read = 0
    for _ in range(3000):
        damaged = whole.copy()
        places = random.integers(0, len(whole), random.integers(1, 6))
        damaged[places] = random.integers(0, 256, len(places))
        try:
            cloud = parse_cloud(read_cloud(damaged.tobytes()))
        except CloudError:
            continue
        read += 1
        assert np.isfinite(cloud.points).all() and len(cloud.points) <= 6
    assert 0 < read < 3000


LENS = Lens(2.0, 4.0, 1.0, 0.5, 3, 2)


def test_depth_through_a_lens():
    depth = np.array([[1.0, math.nan, 2.0], [4.0, 4.0, math.nan]], 'f4')
    cloud = from_depth(depth, LENS, 3.0)
    assert cloud.points.tolist() == [[-0.5, -0.125, 1], [1, -0.25, 2], [-2, 0.5, 4], [0, 0.5, 4]]
    assert cloud.optical and (cloud.sent, cloud.received_s) == (6, 3.0)
    assert cloud.colours is None and cloud.intensity is None


def test_depth_of_another_size_than_the_lens():
    """A picture that was halved looks at the same things."""
    near = from_depth(np.full((4, 6), 2.0, 'f4'), Lens(8.0, 8.0, 2.5, 1.5, 6, 4))
    half = from_depth(np.full((2, 3), 2.0, 'f4'), Lens(8.0, 8.0, 2.5, 1.5, 6, 4))
    assert np.allclose(half.points[0, :2], near.points.reshape(4, 6, 3)[:2, :2].mean((0, 1))[:2])


@pytest.mark.parametrize('lens', [
    LENS._replace(fx=0.0), LENS._replace(fy=-1.0), LENS._replace(fx=math.nan),
    LENS._replace(cx=math.inf), LENS._replace(cy=1e9), Lens(0, 0, 0, 0, 640, 480)])
def test_a_lens_that_cannot_be_is_refused(lens):
    with pytest.raises(CloudError, match='calibrated'):
        from_depth(np.ones((2, 3), 'f4'), lens)
