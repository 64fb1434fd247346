# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Pictures of one viewer: the newest, each robot at its rate, no more than it draws."""
from mhri.web.pacing import LOOKED_AT_HZ, MAX_UNACKED, MAX_UNACKED_BYTES, Pacing, RATE_HZ
from support.clock import Clock


def shown_in(seconds, draws, looked_at=False, size=1000, camera_hz=30):
    """Return the pacing and the numbers sent while a camera runs."""
    clock = Clock()
    pacing, sent = Pacing(clock), []
    for number in range(seconds * camera_hz):
        pacing.offer('/bot1/camera', number, size, looked_at)
        found = pacing.take()
        if found is not None:
            sent.append(found)
            if draws:
                assert pacing.ack(found)
        clock.now += 1.0 / camera_hz
    return pacing, sent


def test_each_robot_has_its_rate_and_the_one_looked_at_more():
    for looked_at, rate_hz in ((False, RATE_HZ), (True, LOOKED_AT_HZ)):
        pacing, sent = shown_in(10, True, looked_at)
        assert 0.8 * rate_hz <= len(sent) / 10 <= 1.2 * rate_hz
        assert 0.8 * rate_hz <= pacing.rate_hz() <= 1.2 * rate_hz
        assert not pacing.thinned()


def test_a_page_that_draws_nothing_gets_no_more_and_then_the_newest():
    pacing, sent = shown_in(10, False)
    assert len(sent) == MAX_UNACKED and pacing.thinned()
    assert pacing.ack(sent[0]) and not pacing.ack(sent[0]) and not pacing.ack(12345)
    assert pacing.take() == 10 * 30 - 1


def test_large_pictures_of_many_robots_do_not_pile_up():
    pacing = Pacing(Clock())
    for number in range(12):
        pacing.offer('/bot{}'.format(number), number, MAX_UNACKED_BYTES // 3, False)
    sent = [pacing.take() for _ in range(12)]
    assert sent == [0, 1, 2] + [None] * 9
    assert pacing.ack(0) and pacing.take() == 3
    pacing.clear()
    assert pacing.ack(1) and pacing.take() is None


def test_one_too_large_for_the_bound_is_sent_alone():
    pacing = Pacing(Clock())
    pacing.offer('/bot1', 1, 10 * MAX_UNACKED_BYTES, False)
    assert pacing.take() == 1
