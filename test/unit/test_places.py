# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Where robots are placed: what it rests on, what takes it away; tf; what is drawn and kept."""
import math

import pytest

from mhri.base.mocap import Pose
from mhri.base.tf_tree import frame_name, TfTree
from mhri.map.drawn import Drawn, kept_of, MOST_CORNERS, MOST_MARKS, read_kept
from mhri.map.places import (
    composed, Corrections, GONE_S, HAND, inverse, MOTION_CAPTURE, NOT_PLACED, Odometry, OLD_S,
    Place, RESTART_S, RobotPlace, SETTLES_S, TF, tf_problem)

HERE, THERE = Pose(1.0, 2.0, 0.5), Pose(-3.0, 0.5, 3.0)


def near(pose, other):
    return pose == pytest.approx((other.x_m, other.y_m, other.heading_rad)) if isinstance(
        pose, tuple) else (pose.x_m, pose.y_m, pose.heading_rad) == pytest.approx(
            (other.x_m, other.y_m, other.heading_rad), abs=1e-9)


@pytest.mark.parametrize('pose', [HERE, THERE, Pose(0.0, 0.0, -3.1)])
def test_a_pose_and_its_inverse_make_nothing(pose):
    assert near(composed(pose, inverse(pose)), Pose(0.0, 0.0, 0.0))
    assert near(composed(inverse(pose), composed(pose, THERE)), THERE)


def robot(*heard, at_s=0.0):
    """Return a :class:`RobotPlace` whose odometry says HERE, that has heard these."""
    place = RobotPlace()
    place.drive(Odometry(HERE, at_s, 7))
    for what in heard:
        {TF: lambda: place.see_tf(THERE, at_s), 'static': lambda: place.see_tf(THERE),
         MOTION_CAPTURE: lambda: place.capture(THERE, at_s),
         HAND: lambda: place.put(THERE, at_s)}[what]()
    return place


@pytest.mark.parametrize('heard, after_s, by', [
    ((), 0.0, NOT_PLACED),
    ((TF,), 0.1, TF), ((TF,), 3.0, TF), ((TF,), GONE_S + 0.1, NOT_PLACED),
    (('static',), 1e6, TF),
    ((MOTION_CAPTURE,), 0.1, MOTION_CAPTURE), ((MOTION_CAPTURE,), GONE_S + 0.1, NOT_PLACED),
    ((HAND,), 1e6, HAND),
    ((HAND, TF), 0.1, TF), ((HAND, TF), GONE_S + 0.1, HAND),
    ((HAND, TF, MOTION_CAPTURE), 0.1, MOTION_CAPTURE), ((TF, MOTION_CAPTURE), 1.0, MOTION_CAPTURE),
    (('static', MOTION_CAPTURE), GONE_S + 0.1, TF)])
def test_what_a_place_rests_on(heard, after_s, by):
    place = robot(*heard).place(after_s)
    assert place.by == by
    assert (place.odometry is None) == (by == NOT_PLACED)
    assert by.replace('_', ' ') in place.text
    if by == NOT_PLACED:
        assert place.text == 'it is not placed: place it by hand on the map'


@pytest.mark.parametrize('heard, after_s, fresh', [
    ((TF,), OLD_S, True), ((TF,), OLD_S + 0.01, False), (('static',), 100.0, True),
    ((HAND,), 100.0, True), ((MOTION_CAPTURE,), OLD_S + 0.01, False), ((), 0.0, False)])
def test_an_old_place_is_no_place(heard, after_s, fresh):
    assert robot(*heard).place(after_s).is_fresh == fresh


@pytest.mark.parametrize('by', [MOTION_CAPTURE, HAND])
def test_a_robot_is_where_it_was_seen_or_put_and_goes_on_by_odometry(by):
    place = robot(by).place(0.0)
    assert near(place.pose(HERE), THERE)
    ahead = composed(HERE, Pose(1.0, 0.0, 0.0))
    assert near(place.pose(ahead), composed(THERE, Pose(1.0, 0.0, 0.0)))
    assert Place().pose(HERE) is None


# (state, event) of what the hand has placed -> (state, words).
DRIVES = {'goes on': Odometry(Pose(1.3, 2.0, 0.7), 1.0, 8),
          'leaps': Odometry(Pose(4.0, 2.0, 0.5), 0.1, 8),
          'turns at once': Odometry(Pose(1.0, 2.0, 2.5), 0.1, 8),
          'is silent': Odometry(HERE, 6.0, 8),
          'begins anew': Odometry(HERE, 0.1, 1)}
TABLE = [
    ('not put', 'goes on', 'not put', ''), ('not put', 'leaps', 'not put', ''),
    ('not put', 'put', 'put', ''), ('not put', 'take back', 'not put', ''),
    ('not put', 'resume', 'not put', ''),
    ('put', 'goes on', 'put', ''), ('put', 'put', 'put', ''),
    ('put', 'leaps', 'lost', 'its odometry jumped: place it again'),
    ('put', 'turns at once', 'lost', 'its odometry jumped: place it again'),
    ('put', 'is silent', 'lost', 'its odometry was silent for 6 s: place it again'),
    ('put', 'begins anew', 'lost', 'its odometry began anew: place it again'),
    ('put', 'take back', 'not put', ''), ('put', 'resume', 'put', ''),
    ('lost', 'goes on', 'lost', 'it was placed by hand, but'), ('lost', 'put', 'put', ''),
    ('lost', 'take back', 'not put', ''), ('lost', 'resume', 'lost', 'place it again')]


@pytest.mark.parametrize('state, event, then, words', TABLE)
def test_what_the_hand_has_placed(state, event, then, words):
    place = robot() if state == 'not put' else robot(HAND)
    if state == 'lost':
        place.drive(Odometry(Pose(50.0, 0.0, 0.0), 0.0, 7))
        place.drive(Odometry(HERE, 0.0, 7))
    if event in DRIVES:
        place.drive(DRIVES[event])
    else:
        {'put': lambda: place.put(HERE, 0.0), 'take back': place.take_back,
         'resume': lambda: place.resume(HERE, HERE, 0.0)}[event]()
    found = place.place(0.0)
    assert found.by == (HAND if then == 'put' else NOT_PLACED)
    assert words in found.text
    assert ('again' in found.text) == (then == 'lost')


@pytest.mark.parametrize('heard, now_s, words', [
    ((TF,), 0.1, 'placed by tf already: correct its localisation'),
    ((MOTION_CAPTURE,), 0.1, 'placed by motion capture already'),
    ((), 6.0, 'its odometry is not heard')])
def test_what_cannot_be_placed_by_hand_is_said(heard, now_s, words):
    place = robot(*heard)
    assert words in place.put(HERE, now_s)
    assert place.hand is None


@pytest.mark.parametrize('odometry, after_s, by', [
    (Pose(1.5, 2.0, 0.5), 2.0, HAND), (Pose(1.5, 2.0, 0.5), RESTART_S - 1.0, HAND),
    (HERE, RESTART_S + 1.0, NOT_PLACED), (Pose(9.0, 2.0, 0.5), 2.0, NOT_PLACED)])
def test_it_is_placed_after_a_restart_of_the_program_as_before(odometry, after_s, by):
    place = RobotPlace()
    place.resume(THERE, HERE, 0.0)
    place.drive(Odometry(odometry, after_s, 1))
    assert place.place(after_s).by == by


def test_motion_capture_counts_from_the_first_odometry_on():
    place = RobotPlace()
    place.capture(HERE, 0.0)
    assert place.place(0.0).text == 'it is not placed: its odometry is not heard'


@pytest.mark.parametrize('frame, frames, words', [
    ('bot1/odom', ['bot1/odom', 'bot2/odom'], ''), ('odom', ['odom'], ''),
    ('odom', ['odom', 'odom'], 'several robots call the frame of their odometry odom'),
    ('', ['', ''], 'names no frame'), ('map', ['map'], 'says that it is the map')])
def test_robots_that_share_a_frame_are_not_placed_by_tf(frame, frames, words):
    assert words in tf_problem('map', frame, frames)
    place = robot(TF)
    place.forget_tf(tf_problem('map', frame, frames))
    assert place.place(0.0).text == 'it is not placed: {}place it by hand on the map'.format(
        tf_problem('map', frame, frames) + ': ' if words else '')


@pytest.mark.parametrize('moved_m, settles', [(0.5, False), (1.5, True)])
def test_a_place_that_is_corrected_by_far_settles(moved_m, settles):
    corrections, place = Corrections(), robot('static').place(0.0)
    corrected = Place(TF, '', 0.0, Pose(place.odometry.x_m + moved_m, place.odometry.y_m,
                                        place.odometry.heading_rad))
    assert corrections.settling(place, HERE, 0.0) == ''
    assert bool(corrections.settling(corrected, HERE, 0.1)) == settles
    assert bool(corrections.settling(corrected, HERE, 1.0)) == settles
    assert corrections.settling(corrected, HERE, 0.2 + SETTLES_S) == ''


def numbers(x=0.0, y=0.0, yaw=0.0):
    return (x, y, 0.0, 0.0, 0.0, math.sin(0.5 * yaw), math.cos(0.5 * yaw))


def tree(*edges):
    found = TfTree()
    for parent, child, values, at_s in edges:
        found.see(parent, child, values, at_s)
    return found


def test_tf_is_composed_along_its_tree_and_is_as_old_as_its_oldest_part():
    found = tree(('map', 'hall', numbers(1.0, 0.0, math.pi / 2), None),
                 ('hall', 'bot1/odom', numbers(2.0, 0.0, math.pi / 2), 5.0),
                 ('bot1/odom', 'bot1/base_link', numbers(9.0), 1.0))
    pose, at_s = found.find('map', 'bot1/odom')
    assert near(pose, Pose(1.0, 2.0, math.pi)) or near(pose, Pose(1.0, 2.0, -math.pi))
    assert at_s == 5.0
    assert found.find('map', 'hall')[1] is None


def test_tf_is_found_from_the_side_and_backwards():
    found = tree(('earth', 'map', numbers(1.0, 1.0), 3.0),
                 ('earth', 'odom', numbers(4.0, 1.0), 2.0))
    pose, at_s = found.find('map', 'odom')
    assert near(pose, Pose(3.0, 0.0, 0.0)) and at_s == 2.0
    pose, _ = tree(('odom', 'map', numbers(2.0, 0.0), 1.0)).find('map', 'odom')
    assert near(pose, Pose(-2.0, 0.0, 0.0))


@pytest.mark.parametrize('edges', [
    [], [('odom', 'base', numbers(), 0.0)],
    [('map', 'a', numbers(), 0.0), ('b', 'odom', numbers(), 0.0)],
    [('a', 'odom', numbers(), 0.0), ('odom', 'a', numbers(), 0.0), ('a', 'map', numbers(), 0.0)],
    [('map', 'odom', numbers(math.nan), 0.0)], [('map', 'odom', numbers(1e30), 0.0)],
    [('map', 'odom', (0.0,) * 7, 0.0)], [('map', 'odom', (0.0,) * 3 + (math.inf,) * 4, 0.0)]])
def test_trees_that_are_not_connected_loops_and_nonsense_place_nobody(edges):
    assert tree(*edges).find('map', 'odom') is None


def test_frames_have_no_slash_in_front():
    assert frame_name('/bot1/odom') == 'bot1/odom'


SQUARE = ((0.0, 0.0), (4.0, 0.0), (4.0, 3.0))


@pytest.mark.parametrize('corners, words', [
    (SQUARE, ''), ((), ''), (SQUARE[:2], '3 to 200 corners, not 2'),
    (SQUARE * 67, 'not {}'.format(MOST_CORNERS + 1)),
    (SQUARE + ((math.nan, 0.0),), 'corner 4: no such place'),
    (SQUARE + ((1e9, 0.0),), 'corner 4: no such place'),
    (((0.0, 0.0), (1.0, 1.0), (2.0, 2.0)), 'has to enclose something')])
def test_a_fence_is_drawn_or_refused(corners, words):
    drawn = Drawn()
    drawn.set_fence(SQUARE)
    assert (words in drawn.set_fence(corners)) if words else drawn.set_fence(corners) == ''
    assert drawn.fence == (SQUARE if words else tuple(corners))


@pytest.mark.parametrize('name, pose, words', [
    ('dock', HERE, ''), ('', HERE, 'a mark needs a name'), ('a b', HERE, 'a space is not allowed'),
    ('x' * 65, HERE, 'at most 64'), ('dock', Pose(math.nan, 0.0, 0.0), 'no such place'),
    ('dock', Pose(0.0, 0.0, 1e9), 'no such place'), ('dock', None, "no mark 'dock'")])
def test_a_mark_is_put_or_refused(name, pose, words):
    drawn = Drawn()
    problem = drawn.set_mark(name, pose)
    assert words in problem if words else problem == ''
    assert drawn.marks == ({} if words else {name: pose})


def test_there_are_only_so_many_marks():
    drawn = Drawn()
    for number in range(MOST_MARKS):
        assert not drawn.set_mark('mark{}'.format(number), HERE)
    assert 'take one away first' in drawn.set_mark('more', HERE)
    assert not drawn.set_mark('mark1', THERE) and not drawn.set_mark('mark1', None)
    assert not drawn.set_mark('more', HERE)


def test_what_is_kept_is_read_back():
    drawn = Drawn()
    drawn.set_mark('dock', HERE)
    drawn.set_fence(SQUARE)
    again, hand, errors = read_kept(kept_of(drawn, {'bot1': (HERE, THERE, 12.5)}), 'kept')
    assert (again.marks, again.fence, hand, errors) == (
        {'dock': HERE}, SQUARE, {'bot1': (HERE, THERE, 12.5)}, [])


@pytest.mark.parametrize('value, words', [
    (7, 'kept: expected a mapping'), ({'moon': 1}, 'kept: moon: unknown key'),
    ({'marks': {'dock': [1, 2]}}, 'kept: marks.dock: expected [x, y, heading]'),
    ({'marks': {'a b': [1, 2, 3]}}, 'kept: marks.a b: '),
    ({'marks': {'dock': [1, 2, float('nan')]}}, 'kept: marks.dock'),
    ({'fence': [[1, 2]]}, 'kept: fence: a fence has 3'), ({'fence': 3}, 'kept: fence: expected'),
    ({'fence': [[1, 2, 3]]}, 'kept: fence: expected'),
    ({'hand': {'bot1': 3}}, 'kept: hand.bot1: expected a mapping'),
    ({'hand': {'bot1': {'origin': [1, 2, 3], 'odometry': [1], 'at': 1.0}}}, 'hand.bot1.origin'),
    ({'hand': {'a b': {'origin': [1, 2, 3], 'odometry': [1, 2, 3], 'at': 1}}}, 'no robot has this'),
    ({'hand': {'b': {'origin': [1, 2, 3], 'odometry': [1, 2, 3], 'at': '1'}}}, 'hand.b.at')])
def test_what_was_kept_and_cannot_be_used_is_left_out_by_name(value, words):
    drawn, hand, errors = read_kept(value, 'kept')
    assert not drawn.marks and not drawn.fence and not hand
    assert words in ' '.join(map(str, errors))
