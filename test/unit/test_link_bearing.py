# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What a radio bears, and who gets how much of it."""
import math
import os
import random
import sys

import pytest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..'))

from mhri.base.views import LinkFigures  # noqa: E402
from mhri.link.bearing import (  # noqa: E402
    AROUND_BYTES, Bearing, CUT, DRAIN_S, FIRST_CUT, LEAST_BYTES_PER_S, Meter, QUIET_S)
from mhri.link.budget import Budget  # noqa: E402
from mhri.link.carried import COMMAND, GUARD_ECHO, Pace, PICTURE, STATE, Stream  # noqa: E402
from mhri.link.frames import Frame, Heard  # noqa: E402
from mhri.link.shares import Flow, shares, SMALL_BYTES  # noqa: E402
from mhri.robots.figures import (  # noqa: E402
    figures_words, picture_words, RadioFigures, read_figures, thinned_words)
from mhri.robots.link_quality import link_warning  # noqa: E402
from support.radio import Channel, read_table, Table  # noqa: E402

CALM, FULL, LOSSY = Heard(5e4, 0.0, 0.0), Heard(5e4, 0.15, 0.0), Heard(5e4, 0.0, 0.2)
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
    assert meter.read(30.0) == Heard(0.0, 0.0, 0.0)


def test_the_meter_counts_each_stream_for_itself_and_another_run_anew():
    meter = Meter()
    for number in (1, 2, 5, 6):
        meter.note('odom', Frame(1, number, 0.0, b''), 40, 1.0)
    meter.note('imu', Frame(1, 700, 0.0, b''), 40, 1.0)
    assert meter.read(1.0).loss == pytest.approx(2 / 7)
    meter.note('odom', Frame(2, 900, 500.0, b''), 40, 1.1)
    assert meter.read(1.1).queue_s == 0.0


# --- what the radio bears

def bound(heard=FULL):
    """Return a bearing that has found a limit, and when."""
    bearing = Bearing()
    # What is lost and waits is enough once.
    for now in (1.2,) if heard.loss and heard.queue_s else (0.8, 1.0, 1.2):
        assert not bearing.bound
        bearing.on_heard(heard, DEMAND, now)
    assert bearing.bound and bearing.drains
    assert bearing.bytes_per_s == pytest.approx(FIRST_CUT * 5e4, rel=0.1)
    return bearing


def drained(heard=FULL):
    """Return a bearing whose radio has drained since; when."""
    bearing = bound(heard)
    empty = Heard(5e4, 0.0, heard.loss)
    bearing.on_heard(empty, DEMAND, 1.4)
    assert bearing.drains
    now = 1.2 + DRAIN_S
    bearing.on_heard(empty, DEMAND, now)
    assert not bearing.drains
    return bearing, now


def test_once_is_no_radio_that_is_full():
    bearing = Bearing()
    for now in range(20):
        bearing.on_heard(CALM if now % 2 else FULL, DEMAND, 0.2 * now)
    assert not bearing.bound


@pytest.mark.parametrize('heard', [FULL, LOSSY])
def test_what_came_is_what_a_full_radio_bears(heard):
    assert drained(heard)[0].bytes_per_s == pytest.approx(CUT * 5e4, rel=0.1)


def test_half_of_everything_lost_is_no_computer_that_hung():
    bearing = Bearing()
    bearing.on_heard(Heard(1e4, 0.0, 0.6), DEMAND, 1.0)
    assert bearing.bound


@pytest.mark.parametrize('heard, later_s, change', [
    (CALM, 0.2, 1), (FULL, 0.2, -1), (LOSSY, 0.2, 1), (Heard(5e4, 0.05, 0.0), 0.2, 0),
    # What was lost before the cut says nothing.
    (Heard(5e4, 0.0, 0.6), 0.2, 1), (Heard(2e4, 0.0, 0.6), 3.5, -1),
    (Heard(0.0, 0.15, 0.0), 0.2, -1)])
def test_more_while_nothing_waits_and_less_while_much_does(heard, later_s, change):
    bearing, now = drained()
    before = bearing.bytes_per_s
    bearing.on_heard(heard, DEMAND, now + later_s)
    assert (bearing.bytes_per_s > before) - (bearing.bytes_per_s < before) == change
    assert bearing.bytes_per_s >= LEAST_BYTES_PER_S


def test_all_is_sent_again_where_there_is_little_to_send():
    bearing, now = drained()
    bearing.on_heard(CALM, 1e4, now + 1.0)
    assert not bearing.bound
    lossy, now = drained()
    lossy.on_heard(LOSSY, 1e4, now + 1.0)
    assert lossy.bound


def test_what_is_not_used_is_no_reason_for_more():
    bearing, now = drained()
    for number in range(500):
        bearing.on_heard(LOSSY, DEMAND, now + 0.2 * number)
    assert bearing.bytes_per_s < 2.6 * 5e4


@pytest.mark.parametrize('count', [0, 1, 2])
def test_one_cut_is_given_time_while_what_waits_gets_less(count):
    bearing, now = drained()
    bearing.on_heard(FULL, DEMAND, now + 0.2)
    before = bearing.bytes_per_s
    for number in range(count):
        bearing.on_heard(Heard(5e4, 0.14 - 0.01 * number, 0.0), DEMAND, now + 1.3 + 0.2 * number)
        assert bearing.bytes_per_s == before


def test_what_bears_far_less_than_before_begins_anew():
    for loss, anew in ((0.6, True), (0.2, False)):
        bearing, now = drained()
        bearing.on_heard(Heard(1e4, 0.3, loss), DEMAND, now + 0.2)
        assert (bearing.drains, bearing.quiet) == (anew, anew)
        assert (bearing.bytes_per_s == LEAST_BYTES_PER_S) is anew


def test_pictures_begin_again_while_the_radio_drains():
    bearing = bound()
    assert bearing.quiet
    bearing.on_heard(FULL, DEMAND, 1.2 + QUIET_S)
    assert bearing.drains and not bearing.quiet


def test_a_deep_queue_drains_for_longer():
    bearing = bound()
    for number in range(40):
        # It fills still, and then gets empty.
        queue_s = 0.15 + 0.2 * number if number < 5 else 1.3 - 0.05 * number
        assert number >= 28 or bearing.drains, number
        bearing.on_heard(Heard(5e4, max(0.0, queue_s), 0.0), DEMAND, 1.4 + 0.2 * number)
    assert not bearing.drains


def test_who_has_much_gives_way_first():
    waits = Heard(5e4, 0.075, 0.0)
    for rate, less in ((8e4, True), (1.5e4, False)):
        bearing, now = drained()
        bearing.bytes_per_s = rate
        bearing.on_heard(waits, DEMAND, now + 0.2)
        assert (bearing.bytes_per_s < rate) is less


def test_a_way_that_became_longer_is_not_a_full_one():
    longer = Heard(5e4, 0.2, 0.0)
    for bearing, now in ((bound(), 1.4), drained()):
        becomes_longer(bearing, longer, now)


def becomes_longer(bearing, longer, since):
    """See that it does not give way for ever."""
    rates = []
    for number in range(50):
        bearing.on_heard(longer, DEMAND, since + 0.2 * number)
        rates.append(bearing.bytes_per_s)
    assert rates[-1] > 2.0 * min(rates)


def simulate(row, count, offered, seconds):
    """Let senders follow what a radio bears; return (delays [s] and rates of the last half).

    Each has messages of 600 bytes for ``offered`` bytes/s; answers take the way back and a beat.
    """
    radio = Channel(Table(read_table([dict(row, at_s=0)]), 0.0), random.Random(1))
    ends = [(Bearing(), Meter()) for _ in range(count)]
    numbers, due, answers, delays, rates = [0] * count, [0.0] * count, [], [], []

    class Packet(bytes):
        """A message of one of them."""

    for step in range(int(seconds * 500)):
        now = step / 500.0
        for end, (bearing, _) in enumerate(ends):
            # Not all at the same moment.
            due[end] = max(due[end], now - 0.05, 0.01 * end)
            while due[end] <= now:
                packet = Packet(600)
                packet.said = end, numbers[end], now
                numbers[end] += 1
                radio.put(now, packet)
                due[end] += 600 / min(offered, bearing.bytes_per_s)
        for packet in radio.take(now):
            end, number, sent_at = packet.said
            ends[end][1].note('x', Frame(1, number, sent_at + 77.0, b''), 540, now)
            if now > seconds / 2:
                delays.append(now - sent_at)
        if step % 100 == 0:
            answers += [(now + radio_delay_s(row), end, meter.read(now))
                        for end, (_, meter) in enumerate(ends)]
            if now > seconds / 2:
                rates.append(sum(min(offered, bearing.bytes_per_s) for bearing, _ in ends))
        while answers and answers[0][0] <= now:
            _, end, heard = answers.pop(0)
            ends[end][0].on_heard(heard, offered, now)
    return sorted(delays), sum(rates) / len(rates)


def test_a_radio_that_has_become_good_is_used_soon():
    lossy = Heard(5e4, 0.15, 0.2)
    for heard, bears in ((CALM, True), (LOSSY, False)):
        bearing, now = drained(lossy)
        for number in range(60):
            came = Heard(min(bearing.bytes_per_s, DEMAND), heard.queue_s, heard.loss)
            bearing.on_heard(came, DEMAND, now + 0.2 * number)
        assert (not bearing.bound) is bears


def radio_delay_s(row):
    return row.get('delay_ms', 0) / 1000.0


@pytest.mark.parametrize('row, count, bears', [
    ({'delay_ms': 200, 'loss_percent': 20, 'rate_mbit': 1}, 1, 125e3),
    ({'delay_ms': 200, 'loss_percent': 20, 'rate_mbit': 1}, 4, 125e3),
    ({'delay_ms': 200, 'loss_percent': 5, 'rate_mbit': 2}, 2, 250e3),
    ({'delay_ms': 20, 'loss_percent': 0, 'rate_mbit': 1}, 1, 125e3)])
def test_a_radio_is_used_and_its_queue_stays_short(row, count, bears):
    delays, rate = simulate(row, count, DEMAND / 2, 40.0)
    waited = [delay_s - radio_delay_s(row) for delay_s in delays]
    assert waited[len(waited) // 2] < 0.05 and waited[int(0.9 * len(waited))] < 0.2
    assert 0.5 * bears < rate < 1.2 * bears


def test_a_radio_that_bears_everything_gets_everything():
    delays, rate = simulate({'delay_ms': 5, 'rate_mbit': 10, 'loss_percent': 1}, 1, 1e5, 10.0)
    assert rate == 1e5 and delays[-1] < 0.05


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
    flows[1] = flow('odom', STATE, 50, 300, least_hz=8.0)
    found = shares(flows, 8e3, 0.2, 10.0)
    assert found['odom'].hz == 8.0 and found['imu'].hz < 2.0


def test_states_get_all_where_nobody_looks():
    flows = lot()[:-1]
    assert shares(flows, 3e4, 0.0, 10.0)['odom'].hz > shares(lot(), 3e4, 0.0, 10.0)['odom'].hz


def test_several_cameras_share_the_place():
    flows = lot() + [flow('second', PICTURE, 30, 25000, rate_hz=30.0)]
    found = shares(flows, 1e5, 0.0, 10.0)
    assert found['camera'].bytes_per_s == pytest.approx(0.5 * found['camera'].pace)


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


def test_a_pace_changes():
    pace = Pace(0.0)
    assert all(pace.lets(1.0) for _ in range(5))
    pace.change(10.0)
    assert abs(sum(pace.lets(2.0 + 0.01 * number) for number in range(100)) - 10) <= 2


# --- what is told of it

@pytest.mark.parametrize('figures, words, says', [
    (RadioFigures(), '', []),
    (RadioFigures(0.4123, 0.2), 'round_trip:0.4123 loss:0.2', []),
    (RadioFigures(bears=112e3), 'bears:112000.0', ['the radio bears 0.9 Mbit/s only']),
    (RadioFigures(0.4, 0.2, 112e3, 0.52), 'round_trip:0.4 loss:0.2 bears:112000.0 picture_hz:0.52',
     ['picture 1 in 2 s: the radio bears 0.9 Mbit/s']),
    (RadioFigures(bears=4000.0, picture_hz=0.02), 'bears:4000.0 picture_hz:0.02',
     ['no picture: the radio bears 0.1 Mbit/s']),
    (RadioFigures(bears=9e5, picture_hz=12.3), 'bears:900000.0 picture_hz:12.3',
     ['picture 12 a second: the radio bears 7.2 Mbit/s'])])
def test_figures_are_told_in_words_and_read_again(figures, words, says):
    assert figures_words(figures) == words
    assert repr(read_figures(words)) == repr(figures)
    assert thinned_words(figures) == says


@pytest.mark.parametrize('words', [
    'nonsense', 'round_trip', 'round_trip:', 'loss:-1', 'bears:nan', 'bears:inf', 'other:3',
    'x' * 9999])
def test_figures_that_cannot_be_count_for_nothing(words):
    assert repr(read_figures(words)) == repr(RadioFigures())


@pytest.mark.parametrize('rate_hz, words', [
    (0.0, 'no picture'), (0.2, 'picture 1 in 5 s'), (0.9, 'picture 1 in 2 s'),
    (1.0, 'picture 1 a second'), (4.6, 'picture 5 a second')])
def test_how_often_a_picture_comes(rate_hz, words):
    assert picture_words(rate_hz) == words


def test_a_thinned_picture_is_a_warning_of_the_row():
    found = link_warning(LinkFigures(0.4, None, 0.2, 'picture 1 in 2 s'))
    assert found.startswith('picture 1 in 2 s; slow link: 400 ms') and '20 %' in found


# --- several hosts of one robot

@pytest.mark.parametrize('rows, found', [
    # (host, what the radio bears by its reports, whether it reports), the share of the last
    ([('lab', math.inf, True)], math.inf), ([('lab', 50e3, True)], 50e3),
    ([('lab', math.inf, True), ('desk', math.inf, True)], math.inf),
    ([('lab', math.inf, True), ('desk', math.inf, False)], LEAST_BYTES_PER_S),
    ([('desk', math.inf, False), ('lab', 50e3, True)], 50e3),
    ([('lab', 100e3, True), ('desk', math.inf, True)], 25e3),
    ([('lab', 100e3, True), ('desk', 9e3, True)], 9e3),
    ([('lab', 100e3, True), ('one', math.inf, True), ('desk', math.inf, True)], 12.5e3),
    ([('lab', 8e3, True), ('desk', math.inf, True)], LEAST_BYTES_PER_S),
    ([('one', 50e3, True), ('desk', math.inf, True)], math.inf)])
def test_one_radio_for_all_hosts_the_one_in_control_first(rows, found):
    budget = Budget()
    said = [budget.share(host, 'lab', bears, reports, 10.0) for host, bears, reports in rows]
    assert said[-1] == found


def test_a_holder_that_has_gone_takes_nothing_with_it():
    budget = Budget()
    budget.share('lab', 'lab', 100e3, True, 10.0)
    assert budget.share('desk', 'lab', math.inf, True, 10.5) == 25e3
    assert budget.share('desk', 'lab', math.inf, True, 13.0) == math.inf
