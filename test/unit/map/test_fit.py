# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Scans of the simulated building fitted to its map, and to what another robot sees."""
import math
from pathlib import Path
import random

import numpy as np
import pytest

from mhri.base.geometry import Pose
from mhri.map.fit import fit, FitError
from mhri.map.grid import Grid
from mhri.sim.floor_map import grid_of_plan
from mhri.sim.plan import parse_plan
from mhri.sim.sensors import Laser

from support.task_world import room

REPO = Path(__file__).resolve().parents[3]
PLAN = parse_plan((REPO / 'resource' / 'sim' / 'plan.yaml').read_text(), 'plan.yaml')
GRID = grid_of_plan(PLAN)
STARTS = 20


def scan(pose, seed, walls=PLAN.walls, discs=PLAN.discs(), far_m=8.0):
    """Return what a laser at a pose meets, in its frame."""
    laser = Laser(walls, 0.12, far_m, np.random.default_rng(seed))
    ranges = laser.scan(pose.x_m, pose.y_m, pose.heading_rad, discs)
    met = (ranges >= 0.12) & (ranges <= far_m)
    angles = laser.increment_rad * np.flatnonzero(met)
    return ranges[met][:, None] * np.column_stack((np.cos(angles), np.sin(angles)))


def someplace(chance):
    """Return a pose in the building with room around it."""
    while True:
        x, y = chance.uniform(0.3, 11.7), chance.uniform(0.3, 8.7)
        if PLAN.distance(x, y) > 0.25:
            return Pose(x, y, chance.uniform(-3.1, 3.1))


def roughly(pose, chance):
    """Return a pose within half a metre and 20 degrees."""
    far_m, turn = 0.5 * math.sqrt(chance.random()), chance.uniform(-math.pi, math.pi)
    return Pose(pose.x_m + far_m * math.cos(turn), pose.y_m + far_m * math.sin(turn),
                pose.heading_rad + math.radians(chance.uniform(-20.0, 20.0)))


def errors_of(fits):
    """Return (errors [m], errors [degrees]) of (found, true) poses."""
    return (np.array([math.hypot(found.x_m - true.x_m, found.y_m - true.y_m)
                      for found, true in fits]),
            np.array([abs(math.degrees(math.remainder(found.heading_rad - true.heading_rad,
                                                      2.0 * math.pi))) for found, true in fits]))


def tried(far_m, beside=False):
    """Fit from :data:`STARTS` random starts; return ([(found, true)], how many were refused)."""
    fits, refused = [], 0
    for seed in range(STARTS):
        chance = random.Random(seed)
        true = someplace(chance)
        where = {'grid': GRID}
        discs = PLAN.discs()
        if beside:
            other = roughly(true, chance)
            other = Pose(other.x_m, other.y_m, chance.uniform(-3.1, 3.1))
            if PLAN.distance(other.x_m, other.y_m) < 0.2:
                continue
            where = {'around': (scan(other, seed + 1000, far_m=far_m), other)}
        try:
            fits.append((fit(scan(true, seed, discs=discs, far_m=far_m), roughly(true, chance),
                             **where).pose, true))
        except FitError:
            refused += 1
    return fits, refused


@pytest.mark.parametrize('far_m, beside, most_refused', [
    (8.0, False, 2), (3.5, False, 10), (8.0, True, 4)])
def test_random_starts_end_within_5_cm_and_2_degrees_or_are_refused(far_m, beside, most_refused):
    fits, refused = tried(far_m, beside)
    off_m, off_deg = errors_of(fits)
    words = 'laser of {} m, {}: {} fits, {} refused; median {:.3f} m {:.2f} deg, most {:.3f} m ' \
        '{:.2f} deg'
    print(words.format(far_m, 'another robot' if beside else 'map', len(fits), refused,
                       np.median(off_m), np.median(off_deg), off_m.max(), off_deg.max()))
    assert off_m.max() <= 0.05 and off_deg.max() <= 2.0
    assert refused <= most_refused


@pytest.mark.parametrize('name, walls, discs, words', [
    ('corridor', np.array([[-20.0, -0.8, 20.0, -0.8], [-20.0, 0.8, 20.0, 0.8]]), (), 'several'),
    ('one wall', np.array([[-20.0, 1.0, 20.0, 1.0]]), (), 'several'),
    ('nothing', np.array([[90.0, 0.0, 90.0, 1.0]]), (), 'sees too little'),
    ('another building', room(2.0, 9.0), ((0.5, 1.0, 0.3), (-0.6, -1.0, 0.3)), 'nearer to')])
def test_what_does_not_fit_is_refused(name, walls, discs, words):
    points = scan(Pose(0.0, 0.0, 0.3), 1, walls, np.array(discs).reshape(-1, 3))
    if words == 'several':
        around = {'around': (scan(Pose(0.2, 0.0, 0.0), 2, walls, np.zeros((0, 3))),
                             Pose(0.2, 0.0, 0.0))}
    else:
        around = {'grid': GRID}
    with pytest.raises(FitError) as refused:
        fit(points, Pose(3.0, 2.0, 0.3) if 'grid' in around else Pose(0.1, 0.0, 0.3), **around)
    assert words in str(refused.value)


def test_an_empty_map_fits_nobody():
    grid = Grid(0.05, Pose(0.0, 0.0, 0.0), np.zeros((10, 10), dtype=np.int8))
    with pytest.raises(FitError):
        fit(scan(Pose(3.0, 2.0, 0.0), 1), Pose(3.0, 2.0, 0.0), grid)


def test_points_that_are_no_numbers_are_left_out():
    true = Pose(3.0, 2.0, 0.4)
    points = np.vstack((scan(true, 1), [(math.nan, 0.0), (math.inf, 1.0)]))
    found = fit(points, Pose(3.2, 1.9, 0.5), GRID)
    assert math.hypot(found.pose.x_m - 3.0, found.pose.y_m - 2.0) < 0.05
    assert found.met > 0.9
