# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The proof of a stop: every transition, and no proof that is none."""
import pytest

from mhri.base.limits import Velocity, ZERO
from mhri.base.reasons import NO_WITNESS
from mhri.base.robot_types import SILENT_AFTER_S
from mhri.base.views import PROOF_NOT_CONFIRMED, PROOF_STOPPED, PROOF_WAITING
from mhri.robots.link import Motion, STANDSTILL_MPS, STANDSTILL_RAD_S
from mhri.robots.stop_proof import OdometryWitness, PoseWatch, ROW_S, StopProof, TIMEOUT_S

GRID_M = 5_900_000.0  # as in a national grid
UNTURNED = Motion(0.0, 0.0, 0.0, 0.0, None)
REST, MOVES, NAN = Motion(0.0, 0.0), Motion(0.3, 0.0), Motion(float('nan'), 0.0)


def follow(*readings, began=0.0, round_trip_s=0.02):
    """Return a proof that has taken in readings: (time, motion) or (time, motion, late [s])."""
    proof = StopProof(began, round_trip_s)
    for now, motion, *late_s in readings:
        proof.on_motion(motion, now, *late_s)
        proof.view(now)
    return proof


def every(seconds, until, motion, begin=0.0):
    """Return readings at a steady rate."""
    count = int(round((until - begin) / seconds))
    return [(begin + seconds * number, motion) for number in range(1, count + 1)]


STOPS = every(0.02, 0.2, MOVES) + every(0.02, 0.34, REST, 0.2)
CASES = {
    'nothing_yet': ([], 0.5, PROOF_WAITING, 'stopping'),
    'still_moving': (every(0.02, 1.0, MOVES), 1.0, PROOF_WAITING, 'stopping'),
    'stopped': (STOPS, 0.34, PROOF_STOPPED, 'stopped in 220 ms'),
    'three_readings_in_a_moment_are_no_proof': (
        [(0.1, REST), (0.101, REST), (0.102, REST)], 0.13, PROOF_WAITING, 'stopping'),
    'without_an_orientation': (every(0.02, 0.34, UNTURNED), 0.34, PROOF_STOPPED,
                               'stopped in 20 ms'),
    'without_an_orientation_it_moves': (
        [(0.02 * number, Motion(0.0, 0.0, 0.004 * number, 0.0, None)) for number in range(1, 30)],
        0.58, PROOF_WAITING, 'stopping'),
    'in_a_national_grid': (every(0.02, 0.34, Motion(0.0, 0.0, GRID_M)), 0.34, PROOF_STOPPED,
                           'stopped in 20 ms'),
    'two_readings_are_no_proof': ([(0.1, REST), (0.3, REST)], 0.33, PROOF_WAITING, 'stopping'),
    'a_move_between_begins_anew': (
        [(0.1, REST), (0.12, REST), (0.14, MOVES), (0.16, REST), (0.18, REST)], 0.19,
        PROOF_WAITING, 'stopping'),
    'nan_is_not_rest': (every(0.02, 0.5, NAN), 0.5, PROOF_WAITING, 'stopping'),
    'never_heard': ([], SILENT_AFTER_S + 0.001, PROOF_NOT_CONFIRMED,
                    'NOT CONFIRMED: no odometry arrives'),
    'moves_on': (every(0.02, TIMEOUT_S + 0.04, MOVES), TIMEOUT_S + 0.04, PROOF_NOT_CONFIRMED,
                 'NOT CONFIRMED: moves at 0.30 m/s, 0.00 rad/s'),
    'moves_again': (STOPS + [(0.4, MOVES)], 0.4, PROOF_NOT_CONFIRMED,
                    'NOT CONFIRMED: moves at 0.30 m/s, 0.00 rad/s'),
    'falls_silent': (STOPS, 0.34 + SILENT_AFTER_S + 0.001, PROOF_NOT_CONFIRMED,
                     'NOT CONFIRMED: no odometry arrives'),
    'late_but_in_the_end': (
        every(0.02, 2.1, MOVES) + every(0.02, 2.3, REST, 2.1), 2.3, PROOF_STOPPED,
        'stopped in 2120 ms'),
}


HALT = 4.0  # when a robot that was held up on the way is heard again
UNSEEN = {
    'at_rest_when_heard_again': (
        every(0.02, 0.1, MOVES) + every(0.02, HALT + 0.2, REST, HALT),
        'standstill seen after 4.0 s'),
    'moved_when_heard_again': (
        every(0.02, 0.1, MOVES) + every(0.02, HALT + 0.1, MOVES, HALT)
        + every(0.02, HALT + 0.3, REST, HALT + 0.1), 'standstill seen after 4.1 s'),
    'proved_before_it_fell_silent': (STOPS + every(0.02, HALT + 0.2, REST, HALT),
                                     'stopped in 220 ms'),
}


@pytest.mark.parametrize('case', sorted(UNSEEN))
def test_the_time_to_the_proof_is_not_called_that_to_the_stop(case):
    """A robot that was not heard in between may have stood still for long."""
    readings, text = UNSEEN[case]
    view = follow(*readings).view(readings[-1][0])
    assert (view.state, view.text) == (PROOF_STOPPED, text)


@pytest.mark.parametrize('case', sorted(CASES))
def test_transition(case):
    """State and words after a row of readings."""
    readings, now, state, text = CASES[case]
    view = follow(*readings).view(now)
    assert (view.state, view.text) == (state, text)


def test_a_proof_that_silence_took_back_keeps_its_time():
    proof = follow(*STOPS)
    assert proof.view(3.0).state == PROOF_NOT_CONFIRMED
    for now, motion in every(0.02, 3.5, REST, 3.0):
        proof.on_motion(motion, now)
    assert proof.view(3.5).state == PROOF_STOPPED and proof.stopped_ms == pytest.approx(220.0)


def test_stopped_ms_is_none_before_the_proof():
    """And never negative, were the first reading older than the stop."""
    assert follow((0.1, REST)).stopped_ms is None
    assert follow((0.0, REST), (0.05, REST), (0.1, REST), round_trip_s=0.0).stopped_ms == 0.0
    assert follow((5.0, REST), (5.05, REST), (5.11, REST), began=5.0,
                  round_trip_s=0.0).stopped_ms == 0.0


def test_silence_begins_the_row_anew():
    """Two readings before a silence and one after it are no proof."""
    proof = follow((0.1, REST), (0.12, REST))
    proof.view(5.0)
    proof.on_motion(REST, 5.1)
    assert proof.view(5.1).state == PROOF_NOT_CONFIRMED
    proof.on_motion(REST, 5.15)
    proof.on_motion(REST, 5.2)
    assert proof.view(5.2).state == PROOF_STOPPED


def test_a_reading_that_was_long_on_its_way_does_not_fill_a_row_that_has_ended():
    proof = follow((0.1, REST), (0.12, REST))
    assert proof.view(5.0).state == PROOF_NOT_CONFIRMED
    proof.on_motion(REST, 5.1, 4.88)
    assert proof.state == PROOF_NOT_CONFIRMED


def test_silence_begins_the_row_anew_even_when_nobody_looked():
    """The proof must not depend on how often the panel draws."""
    proof = StopProof(0.0)
    for now in (0.1, 0.12, 30.0):
        proof.on_motion(REST, now)
    assert proof.view(30.0).state != PROOF_STOPPED


def test_a_robot_that_moved_again_is_not_called_stopped_in_the_time_of_the_first_row():
    """\"Stopped in 220 ms\" was refuted at 5 s."""
    proof = follow(*(STOPS + every(0.5, 5.0, MOVES, 0.3) + every(0.02, 5.3, REST, 5.0)))
    assert proof.state == PROOF_STOPPED and proof.stopped_ms > 5000.0


def pose(x_m=0.0, heading_rad=0.0, **speeds):
    """Return a reading at a place, with velocities of zero where none is given."""
    return Motion(speeds.get('linear', 0.0), speeds.get('angular', 0.0), x_m, 0.0, heading_rad,
                  speeds.get('lateral', 0.0))


def rolls(speed, turn=0.0, rate_hz=50, until=5.0):
    """Return readings whose velocities say rest while the pose moves [m/s, rad/s]."""
    return [(number / rate_hz, pose(speed * number / rate_hz, turn * number / rate_hz))
            for number in range(1, int(until * rate_hz))]


NEVER = {
    'creeps_in_a_national_grid': (
        [(now, pose(GRID_M + motion.x_m)) for now, motion in rolls(0.03)], 'its pose moves at'),
    'slides': (every(0.02, 5.0, pose(lateral=0.5)), 'moves at 0.50 m/s, 0.00 rad/s'),
    'slides_back': (every(0.02, 5.0, pose(lateral=-0.02)), 'moves at 0.02 m/s'),
    'slow_both_ways': (every(0.02, 5.0, pose(linear=0.009, lateral=0.009)), 'moves at 0.01 m/s'),
    'pose_moves': (rolls(0.5), 'its pose moves at 0.50 m/s'),
    'pose_creeps': (rolls(0.03), 'its pose moves at'),
    'pose_moves_at_5_hz': (rolls(0.5, rate_hz=5), 'its pose moves at 0.50 m/s'),
    'pose_turns': (rolls(0.0, 0.5), 'its pose moves at 0.00 m/s, 0.50 rad/s'),
    'pose_turns_about': (rolls(0.0, -3.0), 'its pose moves at 0.00 m/s, 3.00 rad/s'),
    'no_number_sideways': (every(0.02, 5.0, pose(lateral=float('nan'))), 'not possible'),
    'no_number_of_the_place': (every(0.02, 5.0, pose(float('inf'))), 'not possible'),
    'no_number_of_the_heading': (every(0.02, 5.0, pose(0.0, float('nan'))), 'not possible'),
    'beyond_the_earth': (every(0.02, 5.0, pose(1e30)), 'not possible'),
    'faster_than_light': (every(0.02, 5.0, pose(linear=1e308)), 'not possible'),
    'older_than_the_stop': ([(now, REST, now + 0.1) for now, _ in every(0.02, 5.0, REST)],
                            'what it says is 5.0 s old'),
    'of_no_known_age': ([(now, REST, None) for now, _ in every(0.02, 5.0, REST)],
                        'the clock of its stamps was set back'),
    'of_no_known_age_each_third_time': (
        [(0.1 * number, REST, 0.0 if number % 3 else None) for number in range(50)], '3 readings'),
}


@pytest.mark.parametrize('case', sorted(NEVER))
def test_never_proved(case):
    """Not at any moment, and the words say why."""
    readings, words = NEVER[case]
    proof = StopProof(0.0, 0.02)
    for now, motion, *late_s in readings:
        proof.on_motion(motion, now, *late_s)
        assert proof.view(now).state != PROOF_STOPPED, now
    assert words in proof.view(readings[-1][0]).text


@pytest.mark.parametrize('round_trip_s, late_s, stopped_s', [
    (0.0, 0.0, 0.02), (0.3, 0.0, 0.3), (0.02, 0.6, 0.02), (0.3, 0.6, 0.3),
    (None, 0.0, 0.25)])
def test_nothing_counts_that_was_measured_before_the_stop_was_there(
        round_trip_s, late_s, stopped_s):
    """A resting robot on a slow link: its readings from before prove nothing."""
    proof = StopProof(0.0, round_trip_s)
    for now, motion in every(0.02, 3.0, REST):
        proof.on_motion(motion, now, late_s)
        if proof.view(now).state == PROOF_STOPPED:
            break
    assert now >= stopped_s + late_s + ROW_S - 1e-9
    assert proof.stopped_ms == pytest.approx(1e3 * stopped_s, abs=21.0)


@pytest.mark.parametrize('rate_hz', [1, 5, 50])
def test_a_jittering_pose_at_rest_is_rest(rate_hz):
    """Half a millimetre, a milliradian; and heading that runs on by 0.1 degrees a second."""
    proof = StopProof(0.0, 0.02, silent_after_s=2.5)
    for number in range(1, 20 * rate_hz):
        now, sign = number / rate_hz, number % 2 - 0.5
        proof.on_motion(pose(0.0005 * sign, 0.001 * sign + 0.0017 * now), now)
        state = proof.view(now).state
        assert state == PROOF_STOPPED or now <= 3.0
    assert state == PROOF_STOPPED


def test_a_type_with_slow_odometry_is_not_called_silent():
    """1 Hz: proved by the third reading, silent after its own time."""
    proof = StopProof(0.0, 0.02, silent_after_s=2.5)
    for now in (1.0, 2.0, 3.0):
        proof.on_motion(REST, now)
        # That it is late to stop does not end the row.
        assert (proof.view(now + 0.1).state == PROOF_STOPPED) == (now == 3.0)
    assert proof.view(5.4).state == PROOF_STOPPED and proof.stopped_ms == 1000.0
    assert proof.view(5.6).state == PROOF_NOT_CONFIRMED


def test_words_do_not_claim_that_a_resting_robot_moves():
    """Heard again, but not yet three times."""
    proof = StopProof(0.0)
    proof.view(1.5)
    proof.on_motion(REST, 1.6)
    assert 'moves at 0.00' not in proof.view(1.6).text and '3 readings' in proof.view(1.6).text


# (s, m, rad) of readings, and the speed [m/s, rad/s] by the last of them.
POSES = {
    'one': ([(0.0, 5.0, 1.0)], (0.0, 0.0)),
    'rest': ([(0.0, 0.0, 0.0), (0.5, 0.001, 0.003)], (0.0, 0.0)),
    'drives': ([(0.0, 0.0, 0.0), (0.5, 0.25, 0.0)], (0.5, 0.0)),
    'turns': ([(0.0, 0.0, 0.0), (0.5, 0.0, -0.25)], (0.0, 0.5)),
    'turns past half a turn': ([(0.0, 0.0, 3.0), (0.5, 0.0, 3.5 - 2 * 3.141592653589793)],
                               (0.0, 1.0)),
    'from where it moved last': ([(0.0, 0.0, 0.0), (0.5, 1.0, 0.0), (1.0, 1.25, 0.0)], (0.5, 0.0)),
    'at one time': ([(1.0, 0.0, 0.0), (1.0, 0.02, 0.04)], (2.0, 4.0)),
    'jitter at one time': ([(1.0, 0.0, 0.0), (1.0, 0.0009, 0.003)], (0.0, 0.0)),
    'more than jitter at one time': ([(1.0, 0.0, 0.0), (1.0, 0.0012, 0.0)], (0.12, 0.0)),
    'a turn at one time': ([(1.0, 0.0, 0.0), (1.0, 0.0, 0.004)], (0.0, 0.4)),
    'a time that goes back': ([(1.0, 0.0, 0.0), (0.5, 0.02, 0.0)], (2.0, 0.0)),
    'within a window': ([(0.0, 0.0, 0.0), (0.875, 0.001, 0.0), (1.125, 0.006, 0.0)], (0.0, 0.0)),
    'from one window to the next': ([(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (1.125, 0.006, 0.0)],
                                    (0.048, 0.0)),
}


@pytest.mark.parametrize('case', sorted(POSES))
def test_the_speed_of_a_pose(case):
    readings, speed = POSES[case]
    watch = PoseWatch()
    for now, x_m, heading_rad in readings:
        # To the side as well: it moves away from (7, 7).
        found = watch.speed(Motion(0.0, 0.0, 7.0 + 0.6 * x_m, 7.0 - 0.8 * x_m, heading_rad), now)
    assert found == pytest.approx(speed)


def test_a_pose_at_rest_may_jitter_so_much_and_no_more():
    for x_m, heading_rad, rests in ((0.001, 0.003, True), (0.0011, 0.0, False)):
        watch = PoseWatch()
        watch.speed(Motion(0.0, 0.0), 1.0)
        assert (watch.speed(Motion(0.0, 0.0, x_m, 0.0, heading_rad), 1.0) == (0.0, 0.0)) == rests


def test_silence_begins_after_its_time_and_not_with_it():
    """And so does the end of the time that a robot has to stop."""
    for age_s, state in ((1.0, PROOF_STOPPED), (1.001, PROOF_NOT_CONFIRMED)):
        proof = StopProof(0.0, 0.0, silent_after_s=1.0)
        for now in (0.0, 0.5, 1.0):
            proof.on_motion(REST, now)
        assert proof.view(1.0 + age_s).state == state
        # A reading after just that silence goes on with the row; a later one begins it anew.
        proof = StopProof(0.0, 0.0, silent_after_s=1.0)
        for now in (0.0, 0.5, 0.5 + age_s):
            proof.on_motion(REST, now)
        assert (proof.state == PROOF_STOPPED) == (age_s == 1.0)
    for now, state in ((2.0, PROOF_WAITING), (2.001, PROOF_NOT_CONFIRMED)):
        proof = StopProof(0.0, 0.0, silent_after_s=9.0)
        assert proof.view(now).state == state


GO, TURN, HOLD, CREEP = Velocity(0.3), Velocity(0.0, 0.5), ZERO, Velocity(0.03, 0.1)
ASIDE, SLIDES = Velocity(0.0, 0.0, -0.3), Motion(0.0, 0.0, lateral_mps=-0.3)
SPINS = Motion(0.0, 0.5)
# (velocity that the robot is told, motion of each reading, [s] between them, [s] it lasts), ...
DRIVES = {
    'frozen': ([(GO, REST, 0.02, 4.0)], False),
    'frozen_in_a_turn': ([(TURN, REST, 0.1, 4.0)], False),
    'frozen_and_slow': ([(GO, REST, 1.0, 6.0)], False),
    'frozen_after_it_followed': ([(GO, MOVES, 0.1, 4.0), (GO, REST, 0.1, 2.0)], False),
    'frozen_sideways': ([(ASIDE, REST, 0.1, 4.0)], False),
    'follows_sideways': ([(ASIDE, SLIDES, 0.1, 4.0)], True),
    'frozen_but_for_a_gyro': ([(Velocity(0.3, 0.2), SPINS, 0.1, 4.0)], False),
    'frozen_while_the_stick_goes_to_and_fro': (
        [(GO, REST, 0.1, 0.9), (Velocity(-0.3), REST, 0.1, 0.9)], False),
    'frozen_at_once_after_it_followed': ([(GO, MOVES, 0.1, 4.0), (GO, REST, 0.1, 0.3)], False),
    'follows': ([(GO, MOVES, 0.1, 4.0), (HOLD, REST, 0.1, 4.0)], True),
    'motors_that_take_their_time': ([(GO, REST, 0.1, 0.8), (GO, MOVES, 0.1, 1.0)], True),
    'sets_off_late_after_a_push_that_moved_it': (
        [(GO, MOVES, 0.1, 4.0), (HOLD, REST, 0.1, 1.0), (GO, REST, 0.1, 0.8)], True),
    'moved_at_the_beginning_of_each_push': (
        [(GO, MOVES, 0.1, 0.5), (GO, REST, 0.1, 0.4), (HOLD, REST, 0.1, 1.0)] * 4, True),
    'told_nothing': ([(HOLD, REST, 0.1, 10.0)], True),
    'told_less_than_friction': ([(CREEP, REST, 0.1, 10.0)], True),
    'at_the_limit_of_rest': ([(GO, Motion(STANDSTILL_MPS, 0.0), 0.1, 4.0)], False),
    'at_the_limit_of_no_turn': ([(TURN, Motion(0.0, STANDSTILL_RAD_S), 0.1, 4.0)], False),
    'told_the_least_speed_that_counts': ([(Velocity(0.05), REST, 0.1, 4.0)], False),
    'told_the_least_turn_that_counts': ([(Velocity(0.0, 0.2), REST, 0.1, 4.0)], False),
    'a_tap': ([(GO, REST, 0.1, 0.4), (HOLD, REST, 0.1, 1.0)] * 2, True),
    'frozen_in_taps': ([(GO, REST, 0.1, 0.4), (HOLD, REST, 0.1, 9.0)] * 5, False),
    'frozen_in_short_taps': ([(GO, REST, 0.1, 0.2), (HOLD, REST, 0.1, 1.0)] * 9, False),
    'frozen_in_pushes': ([(GO, REST, 0.02, 0.8), (HOLD, REST, 0.02, 1.0)] * 3, False),
    'frozen_in_pushes_and_turns': (
        [(GO, REST, 0.1, 0.8), (TURN, REST, 0.1, 0.4), (HOLD, REST, 0.1, 1.0)] * 3, False),
    'moves_after_each_tap': (
        [(GO, REST, 0.1, 0.4), (HOLD, MOVES, 0.1, 0.4), (HOLD, REST, 0.1, 1.0)] * 9, True),
    'turns_where_it_does_not_go': (
        [(GO, REST, 0.1, 0.8), (TURN, SPINS, 0.1, 0.4)] * 2 + [(GO, REST, 0.1, 0.8)], False),
    'slow_odometry_that_follows': ([(GO, MOVES, 1.0, 6.0)], True),
    'an_old_reading_and_then_motion': ([(GO, REST, 1.0, 2.0), (GO, MOVES, 1.0, 2.0)], True),
    'nothing_that_can_be': ([(GO, NAN, 0.1, 4.0)], True),
    'follows_again': ([(GO, REST, 0.1, 4.0), (GO, MOVES, 0.1, 0.2)], True),
    'pushed_by_hand_is_not_following': ([(GO, REST, 0.1, 4.0), (HOLD, MOVES, 0.1, 1.0)], False)}


def driven(parts, moves=lambda motion, now: motion, follows=True):
    """Return a witness after a drive."""
    witness, now = OdometryWitness(follows), 0.0
    for told, motion, every_s, lasts_s in parts:
        for _ in range(int(round(lasts_s / every_s))):
            witness.on_command(told, now)
            now += every_s
            witness.on_motion(moves(motion, now), now, 0.02)
    return witness


@pytest.mark.parametrize('name', sorted(DRIVES))
def test_whether_odometry_follows_what_the_robot_is_told(name):
    parts, follows = DRIVES[name]
    assert driven(parts).follows == follows


@pytest.mark.parametrize('name', sorted(DRIVES))
def test_odometry_that_was_found_follows_once_it_was_seen_to(name):
    """Neither standstill nor motion without a command shows that."""
    parts, follows = DRIVES[name]
    moved = any(told not in (HOLD, CREEP) and motion in (MOVES, SLIDES, SPINS)
                for told, motion, *_ in parts)
    assert driven(parts, follows=False).follows == (follows and moved)


def test_a_pose_that_moves_follows_whatever_the_speed_beside_it_says():
    assert driven([(GO, REST, 0.1, 4.0)], lambda _, now: Motion(0.0, 0.0, 0.3 * now)).follows
    assert driven([(TURN, REST, 0.1, 4.0)],
                  lambda _, now: Motion(0.0, 0.0, 0.0, 0.0, 0.5 * now)).follows


@pytest.mark.parametrize('round_trip_s, times, follows', [
    (0.5, (0.5, 1.1, 1.2, 1.3, 1.4), True), (0.02, (0.5, 1.1, 1.2, 1.3, 1.4), False),
    (float('nan'), (1.1, 1.2, 1.25, 1.3, 1.35), True), (0.25, (1.1, 1.2, 1.25, 1.3, 1.35), True),
    (float('nan'), (1.26, 1.27, 1.28), False), (float('nan'), (1.25, 1.26, 1.27), True)])
def test_a_long_way_to_the_robot_is_allowed_for(round_trip_s, times, follows):
    """One that is not known counts as 0.25 s."""
    witness = OdometryWitness()
    assert not witness.asks(0.0)
    witness.on_command(GO, 0.0)
    assert witness.asks(0.0)
    for now in times:
        witness.on_motion(REST, now, round_trip_s)
    assert witness.follows == follows


def test_odometry_that_does_not_follow_proves_nothing():
    proof = follow()
    proof.follows = False
    for now, motion in every(0.02, 3.0, REST):
        proof.on_motion(motion, now)
        assert proof.view(now).state == PROOF_NOT_CONFIRMED
    assert proof.stopped_ms is None and NO_WITNESS in proof.view(3.0).text


def test_a_doubt_that_comes_later_takes_the_proof_back_and_one_that_ends_gives_it():
    proof = follow(*every(0.02, 1.0, REST))
    assert proof.view(1.0).state == PROOF_STOPPED
    proof.follows = False
    assert proof.view(1.0).state == PROOF_NOT_CONFIRMED and proof.stopped_ms is None
    proof.on_motion(REST, 1.0)
    proof.follows = True
    for _ in range(2):
        proof.on_motion(REST, 1.0)
        assert proof.view(1.0).state == PROOF_NOT_CONFIRMED, 'a row begins anew'
    for now, motion in every(0.02, 1.5, REST, 1.0):
        proof.on_motion(motion, now)
    assert proof.view(1.5).state == PROOF_STOPPED
