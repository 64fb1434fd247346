# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What is measured of a link, against links that are made up here."""
import random

import pytest

from mhri.base.views import LinkFigures, RobotView
from mhri.driving.group_speed import pace_words
from mhri.robots.link_quality import MIN_SHARE, link_share, link_warning, LinkQuality, MAX_LOST


def fed(offset_s=0.0, one_way_s=0.01, jitter_s=0.0, seconds=8.0, skip=lambda number: False):
    """Return the figures of a link with these properties, and when they were read."""
    quality, rng, now = LinkQuality(), random.Random(1), 1000.0
    for number in range(int(50 * seconds)):
        now += 0.02
        if number % 50 == 0:
            quality.on_round_trip(2.0 * one_way_s + rng.random() * jitter_s)
        if not skip(number):
            quality.on_message(7 + number, one_way_s + rng.random() * jitter_s - offset_s, now)
    return quality.read(now)


@pytest.mark.parametrize('one_way_s', [0.001, 0.05, 0.25, 0.5])
@pytest.mark.parametrize('offset_s', [0.0, 0.3, -0.3, 1359.0])
def test_skew_is_not_taken_for_lag(one_way_s, offset_s):
    figures = fed(offset_s, one_way_s)
    assert figures.round_trip_s == pytest.approx(2 * one_way_s)
    assert figures.offset_s == pytest.approx(offset_s, abs=1e-6)
    assert figures.loss == 0.0


@pytest.mark.parametrize('share', [0.1, 0.5])
def test_losses_are_counted(share):
    rng = random.Random(2)
    figures = fed(skip=lambda number: rng.random() < share)
    assert figures.loss == pytest.approx(share, rel=0.25)


@pytest.mark.parametrize('numbers', [
    [5, 6, 7, 0, 1, 2],                                      # restarted
    [5, 6, 8 + MAX_LOST, 9 + MAX_LOST],            # another publisher
    [5, 90000, 6, 90001, 7, 90002],                          # two at once
])
def test_another_publisher_is_no_loss(numbers):
    quality = LinkQuality()
    for step, number in enumerate(numbers):
        quality.on_message(number, 0.01, 0.02 * step)
    assert quality.read(1.0).loss == 0.0


def test_what_is_not_known_is_not_made_up():
    quality = LinkQuality()
    assert quality.read(0.0) == LinkFigures()
    quality.on_message(1, 0.01, 1.0)
    assert quality.read(1.0) == LinkFigures(None, None, 0.0)
    quality = LinkQuality()
    quality.on_round_trip(0.02)
    quality.on_message(1, None, 1.0)
    assert quality.read(1.0) == LinkFigures(0.02, None, 0.0)


def test_old_figures_are_forgotten():
    quality = LinkQuality()
    quality.on_round_trip(0.02)
    quality.on_message(1, 0.01, 1.0)
    quality.on_message(5, 0.01, 1.1)
    assert quality.read(2.0).loss == pytest.approx(0.6)
    assert quality.read(7.0).loss is None
    assert quality.read(12.0).offset_s is None
    quality.on_round_trip(None)
    assert quality.read(12.0).round_trip_s == 0.02, 'one answer may be missed'
    quality.on_round_trip(None)
    assert quality.read(12.0).round_trip_s is None


@pytest.mark.parametrize('figures, words', [
    (LinkFigures(), []), (LinkFigures(0.1, 0.05, 0.01), []),
    (LinkFigures(0.38), ['slow link: 380 ms']),
    (LinkFigures(0.1, -2.0), ['2.0 s behind', 'chrony']),
    (LinkFigures(0.1, 0.4), ['0.4 s ahead']), (LinkFigures(None, None, 0.2), ['20 %']),
    (LinkFigures(1.0, 1.0, 0.5), ['1000 ms', '50 %', 'ahead']),
])
def test_warnings_say_what_and_how_much(figures, words):
    text = link_warning(figures)
    assert all(word in text for word in words) and bool(text) == bool(words)


def test_the_share_falls_with_the_round_trip_in_tenths():
    assert link_share(None) == link_share(0.0) == link_share(0.15) == 1.0
    assert link_share(0.3) == 0.5
    assert link_share(60.0) == MIN_SHARE
    shares = [link_share(0.01 * step) for step in range(100)]
    assert shares == sorted(shares, reverse=True)
    assert all(round(10 * share, 6) == int(round(10 * share)) for share in shares)


def robot(name, selected=True, round_trip_s=None, limits=(0.5, 1.0)):
    return RobotView(name, selected=selected, figures=LinkFigures(round_trip_s),
                     max_linear_mps=limits[0], max_angular_rad_s=limits[1])


@pytest.mark.parametrize('robots, together, share, words', [
    ([robot('a'), robot('b', limits=(0.2, 2.0))], True, 1.0, '0.20 m/s, 1.00 rad/s'),
    ([robot('a'), robot('b', False, limits=(0.2, 2.0))], True, 1.0, '0.50 m/s'),
    ([robot('a', True, 0.3), robot('b', True, 0.1)], False, 0.5, '300 ms'),
    ([robot('a', True)], True, 0.5, '50 %')])
def test_the_pace_says_why(robots, together, share, words):
    assert words in pace_words(robots, together, share)
