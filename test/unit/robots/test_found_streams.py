# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Sensors with other names than in the type of their robot."""
from dataclasses import replace

import pytest

from mhri.base.robot_types import Limits, RobotType
from mhri.robots.found_streams import choice_words, found_words, FoundStreams, own_topics

ODOM, IMAGE, SCAN = 'nav_msgs/Odometry', 'sensor_msgs/Image', 'sensor_msgs/LaserScan'
COMPRESSED = 'sensor_msgs/CompressedImage'
KIND = RobotType(
    'lab', 'Lab', 'turtlebot', Limits(1.0, 1.0), command=('cmd_vel',), odometry=('odom',),
    rgb=('camera/image_raw',), depth=('camera/depth',), scan=('scan',), imu=('imu',))


def pictures(*topics, of=IMAGE):
    return dict.fromkeys(topics, of)


# name: (published, {sensor: the found topic}, {sensor: the topics to choose from})
CASES = {
    'nothing': ({}, {}, {}),
    'as in the type': ({'odom': ODOM, 'camera/image_raw': IMAGE}, {}, {}),
    'the only odometry': ({'odometry/filtered': ODOM}, {'odometry': 'odometry/filtered'}, {}),
    'beside that of the type': ({'odom': ODOM, 'odometry/filtered': ODOM}, {}, {}),
    'two': ({'a/odom': ODOM, 'b/odom': ODOM}, {}, {'odometry': ['a/odom', 'b/odom']}),
    'of another message type': ({'odometry/filtered': 'geometry_msgs/PoseStamped'}, {}, {}),
    'its name with another message type': (
        {'odom': 'x/Odom', 'wheels': ODOM}, {'odometry': 'wheels'}, {}),
    'a camera of the issue': (pictures('front_realsense/color/image_raw'),
                              {'rgb': 'front_realsense/color/image_raw'}, {}),
    'compressed only': (pictures('usb/image_raw/compressed', of=COMPRESSED),
                        {'rgb': 'usb/image_raw'}, {}),
    'its own, compressed only': (dict(pictures('usb/image_raw'), **pictures(
        'camera/image_raw/compressed', of=COMPRESSED)), {}, {}),
    'a stereo camera in infrared beside it': (
        pictures('rs/color/image_raw', 'rs/infra1/image_rect_raw', 'rs/infra2/image_rect_raw'),
        {'rgb': 'rs/color/image_raw'}, {}),
    'infrared alone': (pictures('lepton/ir/image_raw'), {'rgb': 'lepton/ir/image_raw'}, {}),
    'all pictures of one camera': (
        pictures('cam/image_rect_color', 'cam/image_raw', 'cam/image_mono'),
        {'rgb': 'cam/image_raw'}, {}),
    'one namespace, no usual name': (pictures('cv/mask', 'cv/edges'), {},
                                     {'rgb': ['cv/edges', 'cv/mask']}),
    'of an impossible name': ({'a"; rm': ODOM, 'x' * 251: ODOM}, {}, {}),
    'two cameras': (pictures('front/image_raw', 'rear/image_raw'), {},
                    {'rgb': ['front/image_raw', 'rear/image_raw']}),
    'depth is no colour': (pictures('rs/depth/image_rect_raw'),
                           {'depth': 'rs/depth/image_rect_raw'}, {}),
    'its own depth is no colour': (pictures('camera/depth'), {}, {}),
    'a laser': ({'front/scan': SCAN}, {'scan': 'front/scan'}, {}),
}


@pytest.mark.parametrize('case', sorted(CASES))
@pytest.mark.parametrize('at_root', [False, True])
def test_what_is_found(case, at_root):
    """Below the robot, and at the root, where all names are absolute."""
    published, found, choices = CASES[case]
    kind, slash = (KIND.at_root(), '/') if at_root else (KIND, '')
    streams = FoundStreams()
    changed = streams.update(kind, {slash + topic: of for topic, of in published.items()}, {})
    assert changed.found == tuple(sorted(found))
    assert changed == replace(kind, found=changed.found, **{
        key: getattr(kind, key) + (slash + topic,) for key, topic in found.items()})
    assert streams.choices == {key: [slash + topic for topic in topics]
                               for key, topics in choices.items()}


# Steps of (published, the odometry then).
WHEELS, FILTERED, OTHER = {'odom': ODOM}, {'odometry/filtered': ODOM}, {'x': ODOM}
SEQUENCES = {
    'its own comes later': [
        (FILTERED, ('odom', 'odometry/filtered')), ({**WHEELS, **FILTERED}, ('odom',))],
    'its own vanishes': [({**WHEELS, **FILTERED}, ('odom',)), (FILTERED, ('odom',))],
    'another one comes later': [
        (FILTERED, ('odom', 'odometry/filtered')),
        ({**FILTERED, **OTHER}, ('odom', 'odometry/filtered'))],
    'it vanishes, and another one comes': [
        (FILTERED, ('odom', 'odometry/filtered')), (OTHER, ('odom', 'odometry/filtered'))],
    'not asked': [(FILTERED, ('odom', 'odometry/filtered')), (None, ('odom', 'odometry/filtered'))],
    'one of two vanishes': [({**FILTERED, **OTHER}, ('odom',)), (OTHER, ('odom', 'x'))],
}


@pytest.mark.parametrize('case', sorted(SEQUENCES))
def test_a_moving_robot_keeps_its_odometry(case):
    streams = FoundStreams()
    for published, odometry in SEQUENCES[case]:
        assert streams.update(KIND, published, {}).odometry == odometry


def test_only_what_is_looked_for_is_found():
    """A camera that appears must not stop a robot."""
    streams = FoundStreams(('odometry', 'scan'))
    assert streams.update(KIND, pictures('front/image_raw'), {}) == KIND and not streams.choices
    streams.update(KIND, {'odom': ODOM, 'scan': SCAN}, {})
    assert streams.complete


def test_another_type_begins_anew():
    streams = FoundStreams()
    streams.update(KIND, FILTERED, {})
    other = replace(KIND, odometry=('odometry/filtered',))
    assert streams.update(other, FILTERED, {}) == other


@pytest.mark.parametrize('kind, named', [
    (replace(KIND, odometry=()), {}), (replace(KIND, instance='turtle1'), {}),
    (replace(KIND, odometry=('/elsewhere/odom',)), {}), (KIND, {'odometry': ['x']})])
def test_what_is_never_replaced(kind, named):
    """It has none, one node has several robots, it is outside of the robot, it was named."""
    streams = FoundStreams()
    assert streams.update(kind, FILTERED, {'mhri': named}) == kind
    assert streams.choices == ({'odometry': ['odometry/filtered']} if named else {})


def test_the_depth_camera_that_the_brake_sees_with():
    """Its mount is in the type; that of another one is not."""
    kind = replace(KIND, scan=())
    assert FoundStreams().update(kind, pictures('rs/depth/image_raw'), {}) == kind


def test_a_found_laser_is_not_assumed_to_face_forward():
    kind = FoundStreams().update(replace(KIND, lasers=((0.1, 0.0, 0.0),)),
                                 {'rear/scan': SCAN}, {})
    assert kind.laser_place(0) == (0.1, 0.0, 0.0) and kind.laser_place(1) is None


def test_a_complete_robot_is_not_asked_again():
    streams = FoundStreams()
    kind = replace(KIND, rgb=(), depth=(), scan=(), imu=())
    assert not streams.complete
    streams.update(kind, FILTERED, {})
    assert not streams.complete
    streams.update(kind, WHEELS, {})
    assert streams.complete


def test_own_topics():
    published = {'/a/odom': ODOM, '/ab/odom': ODOM, '/odom': ODOM, '/camera/image': IMAGE}
    assert own_topics('a', published) == {'odom': ODOM}
    assert own_topics('robot', published, {'a', 'ab'}) == {'/odom': ODOM, '/camera/image': IMAGE}


def test_the_words_name_the_line_that_sets_it():
    kind = FoundStreams().update(KIND, FILTERED, {})
    line = 'rosparam set /bot1/mhri/odometry "[odometry/filtered]"'
    assert found_words('bot1', 'odometry', kind)[1] == line
    assert choice_words('bot1', 'odometry', ['odometry/filtered', 'x'])[1] == line
