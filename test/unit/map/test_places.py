# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Where robots are placed: what it rests on, what takes it away; tf; what is drawn and kept."""
import math

import pytest

from mhri.base.geometry import composed, Pose
from mhri.base.tf_tree import TfTree
from mhri.map.drawn import Drawn, kept_of, MAX_CORNERS, read_kept
from mhri.map.places import (
    Corrections, GONE_S, HAND, MOTION_CAPTURE, NOT_PLACED, Odometry, OLD_S, Place, RESTART_S,
    RobotPlace, SETTLES_S, TF, tf_problem)

HERE, THERE = Pose(1.0, 2.0, 0.5), Pose(-3.0, 0.5, 3.0)


def near(pose, other):
    return pose == pytest.approx((other.x_m, other.y_m, other.heading_rad)) if isinstance(
        pose, tuple) else (pose.x_m, pose.y_m, pose.heading_rad) == pytest.approx(
            (other.x_m, other.y_m, other.heading_rad), abs=1e-9)


def robot(*updates, at_s=0.0):
    """Return a :class:`RobotPlace` whose odometry says HERE, with these updates."""
    place = RobotPlace()
    place.drive(Odometry(HERE, at_s, 7))
    for what in updates:
        {TF: lambda: place.update_tf(THERE, at_s), 'static': lambda: place.update_tf(THERE),
         MOTION_CAPTURE: lambda: place.capture(THERE, at_s),
         HAND: lambda: place.put(THERE, at_s)}[what]()
    return place


@pytest.mark.parametrize('updates, after_s, by', [
    ((), 0.0, NOT_PLACED),
    ((TF,), 0.1, TF), ((TF,), 3.0, TF), ((TF,), GONE_S + 0.1, NOT_PLACED),
    (('static',), 1e6, TF),
    ((MOTION_CAPTURE,), 0.1, MOTION_CAPTURE), ((MOTION_CAPTURE,), GONE_S + 0.1, NOT_PLACED),
    ((HAND,), 1e6, HAND),
    ((HAND, TF), 0.1, TF), ((HAND, TF), GONE_S + 0.1, HAND),
    ((HAND, TF, MOTION_CAPTURE), 0.1, MOTION_CAPTURE), ((TF, MOTION_CAPTURE), 1.0, MOTION_CAPTURE),
    (('static', MOTION_CAPTURE), GONE_S + 0.1, TF)])
def test_what_a_place_rests_on(updates, after_s, by):
    place = robot(*updates).place(after_s)
    assert place.by == by
    assert (place.odometry is None) == (by == NOT_PLACED)


@pytest.mark.parametrize('updates, after_s, fresh', [
    ((TF,), OLD_S, True), ((TF,), OLD_S + 0.01, False), (('static',), 100.0, True),
    ((HAND,), 100.0, True), ((MOTION_CAPTURE,), OLD_S + 0.01, False), ((), 0.0, False)])
def test_an_old_place_is_no_place(updates, after_s, fresh):
    assert robot(*updates).place(after_s).is_fresh == fresh


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
    ('put', 'leaps', 'lost', 'odometry'), ('put', 'turns at once', 'lost', 'odometry'),
    ('put', 'is silent', 'lost', '6 s'), ('put', 'begins anew', 'lost', 'odometry'),
    ('put', 'take back', 'not put', ''), ('put', 'resume', 'put', ''),
    ('lost', 'goes on', 'lost', ''), ('lost', 'put', 'put', ''),
    ('lost', 'take back', 'not put', ''), ('lost', 'resume', 'lost', '')]


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
    assert (found.text == robot().place(0.0).text) == (then == 'not put')


@pytest.mark.parametrize('updates, now_s, words', [
    ((TF,), 0.1, 'tf'), ((MOTION_CAPTURE,), 0.1, 'motion capture'), ((), 6.0, 'odometry')])
def test_placing_by_hand_is_refused_with_the_reason(updates, now_s, words):
    place = robot(*updates)
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


@pytest.mark.parametrize('frame, frames, words', [
    ('bot1/odom', ['bot1/odom', 'bot2/odom'], ''), ('odom', ['odom'], ''),
    ('odom', ['odom', 'odom'], 'odom'), ('', ['', ''], 'frame'), ('map', ['map'], 'map')])
def test_robots_that_share_a_frame_are_not_placed_by_tf(frame, frames, words):
    problem = tf_problem('map', frame, frames)
    assert words in problem and bool(problem) == bool(words)
    place = robot(TF)
    place.forget_tf(problem)
    assert problem in place.place(0.0).text


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
        found.add(parent, child, values, at_s)
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


SQUARE = ((0.0, 0.0), (4.0, 0.0), (4.0, 3.0))


@pytest.mark.parametrize('corners, words', [
    (SQUARE, ''), ((), ''), (SQUARE[:2], '2'), (SQUARE * 67, str(MAX_CORNERS + 1)),
    (SQUARE + ((math.nan, 0.0),), 'corner 4'), (SQUARE + ((1e9, 0.0),), 'corner 4'),
    (((0.0, 0.0), (1.0, 1.0), (2.0, 2.0)), ' ')])
def test_a_fence_is_drawn_or_refused(corners, words):
    drawn = Drawn()
    drawn.set_fence(SQUARE)
    assert (words in drawn.set_fence(corners)) if words else drawn.set_fence(corners) == ''
    assert drawn.fence == (SQUARE if words else tuple(corners))


@pytest.mark.parametrize('name, pose, words', [
    ('dock', HERE, ''), ('', HERE, 'name'), ('a b', HERE, 'space'), ('x' * 65, HERE, '64'),
    ('dock', Pose(math.nan, 0.0, 0.0), ' '), ('dock', Pose(0.0, 0.0, 1e9), ' '),
    ('dock', None, 'dock')])
def test_a_mark_is_put_or_refused(name, pose, words):
    drawn = Drawn()
    problem = drawn.set_mark(name, pose)
    assert words in problem if words else problem == ''
    assert drawn.marks == ({} if words else {name: pose})


def test_what_is_kept_is_read_back():
    drawn = Drawn()
    drawn.set_mark('dock', HERE)
    drawn.set_fence(SQUARE)
    again, hand, errors = read_kept(kept_of(drawn, {'bot1': (HERE, THERE, 12.5)}), 'kept')
    assert (again.marks, again.fence, hand, errors) == (
        {'dock': HERE}, SQUARE, {'bot1': (HERE, THERE, 12.5)}, [])


@pytest.mark.parametrize('value, key', [
    (7, ''), ({'moon': 1}, 'moon'), ({'marks': {'dock': [1, 2]}}, 'marks.dock'),
    ({'marks': {'a b': [1, 2, 3]}}, 'marks.a b'), ({'fence': [[1, 2]]}, 'fence'),
    ({'marks': {'dock': [1, 2, float('nan')]}}, 'marks.dock'), ({'fence': 3}, 'fence'),
    ({'fence': [[1, 2, 3]]}, 'fence'), ({'hand': {'bot1': 3}}, 'hand.bot1'),
    ({'hand': {'bot1': {'origin': [1, 2, 3], 'odometry': [1], 'at': 1.0}}}, 'hand.bot1.origin'),
    ({'hand': {'a b': {'origin': [1, 2, 3], 'odometry': [1, 2, 3], 'at': 1}}}, 'hand.a b'),
    ({'hand': {'b': {'origin': [1, 2, 3], 'odometry': [1, 2, 3], 'at': '1'}}}, 'hand.b.at')])
def test_unusable_kept_values_are_left_out_and_named(value, key):
    drawn, hand, errors = read_kept(value, 'kept')
    assert not drawn.marks and not drawn.fence and not hand
    assert 'kept: ' + key in ' '.join(map(str, errors))
