# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What a radio carries, and who gets how much of it."""
import math

import pytest

from mhri.base.views import LinkFigures
from mhri.link.budget import Budget
from mhri.link.carried import COMMAND, GUARD_ECHO, PICTURE, STATE, Stream
from mhri.link.frames import Frame, LinkStats
from mhri.link.rate_estimator import (
    AROUND_BYTES, CUT, DRAIN_S, FIRST_CUT, Meter, MIN_BYTES_PER_S, RateEstimator)
from mhri.link.shares import Flow, shares, SMALL_BYTES
from mhri.robots.figures import figures_words, RadioFigures, read_figures, thinned_words
from mhri.robots.link_quality import link_warning

CALM, FULL, LOSSY = LinkStats(5e4, 0.0, 0.0), LinkStats(5e4, 0.15, 0.0), LinkStats(5e4, 0.0, 0.2)
DEMAND = 8e5


# --- what comes in

def test_the_meter_counts_what_came_and_what_waited_without_a_common_clock():
    meter = Meter()
    for number in range(20):
        now = 10.0 + 0.02 * number
        meter.note('odom', Frame(1, number, now - 1000.0 - 0.1 * (number > 5), b''), 40, now)
    heard = meter.read(10.4)
    assert heard.bytes_per_s == pytest.approx(20 * (40 + AROUND_BYTES) / 0.5)
    assert heard.queue_s == pytest.approx(0.1) and heard.loss == 0.0
    assert meter.read(30.0) == LinkStats(0.0, 0.0, 0.0)


def test_the_meter_counts_each_stream_for_itself_and_another_run_anew():
    meter = Meter()
    for number in (1, 2, 5, 6):
        meter.note('odom', Frame(1, number, 0.0, b''), 40, 1.0)
    meter.note('imu', Frame(1, 700, 0.0, b''), 40, 1.0)
    assert meter.read(1.0).loss == pytest.approx(2 / 7)
    meter.note('odom', Frame(2, 900, 500.0, b''), 40, 1.1)
    assert meter.read(1.1).queue_s == 0.0


# --- what the radio carries

def bound(heard=FULL):
    """Return a estimator that has found a limit, and when."""
    estimator = RateEstimator()
    # What is lost and waits is enough once.
    for now in (1.2,) if heard.loss and heard.queue_s else (0.8, 1.0, 1.2):
        assert not estimator.bound
        estimator.on_stats(heard, DEMAND, now)
    assert estimator.bound and estimator.drains
    assert estimator.bytes_per_s == pytest.approx(FIRST_CUT * 5e4, rel=0.1)
    return estimator


def drained(heard=FULL):
    """Return a estimator whose radio has drained since; when."""
    estimator = bound(heard)
    empty = LinkStats(5e4, 0.0, heard.loss)
    estimator.on_stats(empty, DEMAND, 1.4)
    assert estimator.drains
    now = 1.2 + DRAIN_S
    estimator.on_stats(empty, DEMAND, now)
    assert not estimator.drains
    return estimator, now


@pytest.mark.parametrize('heard', [FULL, LOSSY])
def test_what_came_is_what_a_full_radio_bears(heard):
    assert drained(heard)[0].bytes_per_s == pytest.approx(CUT * 5e4, rel=0.1)


def test_half_of_everything_lost_is_no_computer_that_hung():
    estimator = RateEstimator()
    estimator.on_stats(LinkStats(1e4, 0.0, 0.6), DEMAND, 1.0)
    assert estimator.bound


@pytest.mark.parametrize('heard, later_s, change', [
    (CALM, 0.2, 1), (FULL, 0.2, -1), (LOSSY, 0.2, 1), (LinkStats(5e4, 0.05, 0.0), 0.2, 0),
    # What was lost before the cut says nothing.
    (LinkStats(5e4, 0.0, 0.6), 0.2, 1), (LinkStats(2e4, 0.0, 0.6), 3.5, -1),
    (LinkStats(0.0, 0.15, 0.0), 0.2, -1)])
def test_more_while_nothing_waits_and_less_while_much_does(heard, later_s, change):
    estimator, now = drained()
    before = estimator.bytes_per_s
    estimator.on_stats(heard, DEMAND, now + later_s)
    assert (estimator.bytes_per_s > before) - (estimator.bytes_per_s < before) == change
    assert estimator.bytes_per_s >= MIN_BYTES_PER_S


def test_what_bears_far_less_than_before_begins_anew():
    for loss, anew in ((0.6, True), (0.2, False)):
        estimator, now = drained()
        estimator.on_stats(LinkStats(1e4, 0.3, loss), DEMAND, now + 0.2)
        assert (estimator.drains, estimator.quiet) == (anew, anew)
        assert (estimator.bytes_per_s == MIN_BYTES_PER_S) is anew


# --- who gets how much

def flow(topic, urgency, hz, size, **options):
    """Return a flow of a stream that has come for a while until 10.0 s."""
    found = Flow(Stream(topic, urgency, **options))
    for number in range(int(5 * hz) + 1):
        found.came(10.0 - (int(5 * hz) - number) / hz)
        found.sized(size - AROUND_BYTES)
    return found


def lot():
    """Return what a robot with a camera sends."""
    return [flow(GUARD_ECHO, COMMAND, 30, 190), flow('odom', STATE, 50, 300),
            flow('imu', STATE, 100, 300, weight=0.7), flow('scan', STATE, 10, 2500, weight=0.2),
            flow('camera', PICTURE, 30, 25000, rate_hz=30.0)]


def used(flows, found):
    """Return what all of it sends [bytes/s]."""
    return sum(found[flow.stream.topic].bytes_per_s if flow.stream.urgency == PICTURE else
               min(flow.hz(10.0), found[flow.stream.topic].hz) * flow.size for flow in flows)


@pytest.mark.parametrize('bytes_per_s', [1e4, 2e4, 3e4, 1e5, 5e5])
def test_no_more_is_shared_out_than_there_is(bytes_per_s):
    flows = lot()
    found = shares(flows, bytes_per_s, 0.2, 10.0)
    assert 0.7 * bytes_per_s < used(flows, found) < 1.1 * bytes_per_s
    assert found['odom'].hz > found['imu'].hz > found['scan'].hz
    assert found[GUARD_ECHO].hz == 12.0


def test_a_picture_is_first_rarer_then_smaller():
    some = shares(lot(), 3e5, 0.0, 10.0)['camera']
    assert math.isinf(some.size) and 5.0 <= some.hz < 30.0 and some.group == 0
    few = shares(lot(), 3e4, 0.0, 10.0)['camera']
    assert few.size == SMALL_BYTES and 0.5 < few.hz <= 5.0
    assert [shares(lot(), 3e4, loss, 10.0)['camera'].group for loss in (0.05, 0.2)] == [6, 3]


def test_no_picture_goes_while_the_radio_is_full():
    found = shares(lot(), 1e4, 0.0, 10.0, quiet=True)
    assert found['camera'].hz == 0.0 and found['odom'].hz > shares(lot(), 1e4, 0.0, 10.0)['odom'].hz


def test_the_pose_has_its_part_whatever_is_left():
    flows = lot()
    flows[1] = flow('odom', STATE, 50, 300, min_hz=8.0)
    found = shares(flows, 8e3, 0.2, 10.0)
    assert found['odom'].hz == 8.0 and found['imu'].hz < 2.0


def test_a_flow_that_ended_takes_nothing():
    ended = flow('camera', PICTURE, 30, 25000)
    assert ended.hz(10.0) == pytest.approx(30.0, rel=0.1) and ended.hz(30.0) < 0.01


def test_the_size_of_what_is_packed_from_now_on_is_guessed_until_one_comes():
    state, picture = flow('odom', STATE, 50, 800), flow('camera', PICTURE, 30, 25000)
    for one in (state, picture):
        one.packed()
    assert state.size < 350 and picture.size == 25000
    state.sized(190)
    assert state.size == 190 + AROUND_BYTES


# --- what is told of it

@pytest.mark.parametrize('figures, words, says', [
    (RadioFigures(), '', []),
    (RadioFigures(0.4123, 0.2), 'round_trip:0.4123 loss:0.2', []),
    (RadioFigures(carries=112e3), 'bears:112000.0', ['0.9 Mbit/s']),
    (RadioFigures(0.4, 0.2, 112e3, 0.52), 'round_trip:0.4 loss:0.2 bears:112000.0 picture_hz:0.52',
     ['1 in 2 s', '0.9 Mbit/s']),
    (RadioFigures(carries=4000.0, picture_hz=0.02), 'bears:4000.0 picture_hz:0.02',
     ['0.1 Mbit/s']),
    (RadioFigures(carries=9e5, picture_hz=12.3), 'bears:900000.0 picture_hz:12.3',
     ['12 a second', '7.2 Mbit/s'])])
def test_figures_are_published_in_a_line_and_read_again(figures, words, says):
    assert figures_words(figures) == words
    assert repr(read_figures(words)) == repr(figures)
    shown = ''.join(thinned_words(figures))
    assert all(part in shown for part in says) and bool(shown) == bool(says)


@pytest.mark.parametrize('words', [
    'nonsense', 'round_trip', 'round_trip:', 'loss:-1', 'bears:nan', 'carries:inf', 'other:3',
    'x' * 9999])
def test_figures_that_cannot_be_count_for_nothing(words):
    assert repr(read_figures(words)) == repr(RadioFigures())


def test_a_thinned_picture_is_a_warning_of_the_row():
    found = link_warning(LinkFigures(0.4, None, 0.2, 'picture 1 in 2 s'))
    assert all(part in found for part in ('picture 1 in 2 s', '400 ms', '20 %'))


# --- several hosts of one robot

@pytest.mark.parametrize('rows, found', [
    # (host, what the radio carries by its reports, whether it reports), the share of the last
    ([('lab', math.inf, True)], math.inf), ([('lab', 50e3, True)], 50e3),
    ([('lab', math.inf, True), ('desk', math.inf, True)], math.inf),
    ([('lab', math.inf, True), ('desk', math.inf, False)], MIN_BYTES_PER_S),
    ([('desk', math.inf, False), ('lab', 50e3, True)], 50e3),
    ([('lab', 100e3, True), ('desk', math.inf, True)], 25e3),
    ([('lab', 100e3, True), ('desk', 9e3, True)], 9e3),
    ([('lab', 100e3, True), ('one', math.inf, True), ('desk', math.inf, True)], 12.5e3),
    ([('lab', 8e3, True), ('desk', math.inf, True)], MIN_BYTES_PER_S),
    ([('one', 50e3, True), ('desk', math.inf, True)], math.inf)])
def test_one_radio_for_all_hosts_the_one_in_control_first(rows, found):
    budget = Budget()
    said = [budget.share(host, 'lab', carries, reports, 10.0) for host, carries, reports in rows]
    assert said[-1] == found


def test_a_holder_that_has_gone_takes_nothing_with_it():
    budget = Budget()
    budget.share('lab', 'lab', 100e3, True, 10.0)
    assert budget.share('desk', 'lab', math.inf, True, 10.5) == 25e3
    assert budget.share('desk', 'lab', math.inf, True, 13.0) == math.inf
