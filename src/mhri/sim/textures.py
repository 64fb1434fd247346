# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The textures of the simulated building: small pictures, computed once.

All are uint8 (h, w, 3) in the order red, green, blue. They include light and blur for a distance,
so that drawing a frame only looks up texels.
"""
import math

import numpy as np

from mhri.base.opencv import cv2

WALL_PERIOD_M = 1.2
WALL_SHADES = 3
WALL_LEVELS = 28
FLOOR_PERIOD_M = 0.8
_WALL_TEXELS_PER_M = 120.0
_WALL_TEXELS_HIGH = 600
_BLOCK_M = (0.4, 0.2)
_LEVEL_RATIO = 1.13
_NEAREST_LEVEL_M = 0.5
_TILE = 128
_SHADE_STEPS = 64
_CYLINDER_ROWS = 160


def light(distance_m):
    """Return the brightness of a surface at a distance, 1 at the camera, less farther away."""
    return 1.0 / (1.0 + 0.035 * distance_m)


def level_of(distance_m):
    """Return the level of a wall's texture for distances [m], an integer array."""
    steps = np.log(np.maximum(distance_m, _NEAREST_LEVEL_M) / _NEAREST_LEVEL_M)
    return np.minimum(np.rint(steps / math.log(_LEVEL_RATIO)), WALL_LEVELS - 1)


def _blurred(picture, sigma):
    """Return a blurred picture; a periodic one stays seamless from left to right."""
    if sigma < 0.3:
        return picture
    pad = int(3.0 * sigma) + 1
    wide = np.pad(picture, ((0, 0), (pad, pad), (0, 0)), 'wrap')
    return cv2.GaussianBlur(wide, (0, 0), sigma, borderType=cv2.BORDER_REPLICATE)[:, pad:-pad]


def _wall_tile(height_m, colour, texels_per_m, rows):
    """Return one period of a wall, float: blocks, a stripe and a skirting board."""
    columns = int(round(WALL_PERIOD_M * texels_per_m))
    up = (height_m - (np.arange(rows) / texels_per_m))[:, None]
    along = (np.arange(columns) / texels_per_m)[None]
    course = np.floor(up / _BLOCK_M[1])
    shifted = (along + 0.5 * _BLOCK_M[0] * (course % 2)) % WALL_PERIOD_M
    block = np.floor(shifted / _BLOCK_M[0])
    # Vary the brightness of the blocks a little, equally in every period.
    tone = 0.93 + 0.07 * np.modf(np.abs(np.sin(course * 12.9898 + block * 78.233)) * 43.7)[0]
    joint = (up % _BLOCK_M[1] < 0.012) | (shifted % _BLOCK_M[0] < 0.012)
    tile = np.where(joint, 0.78, tone)[..., None] * np.array(colour, float)
    for low, high, paint in ((0.90, 1.00, (86, 128, 150)), (0.0, 0.09, (98, 88, 80))):
        tile[((up >= low) & (up < high))[:, 0]] = paint
    return tile


def wall_texture(height_m, colour):
    """Return (texture, texels per metre upwards, width of a tile) of a wall.

    The tiles are side by side, :data:`WALL_LEVELS` distances for each of :data:`WALL_SHADES`
    directions of the wall; each is :data:`WALL_PERIOD_M` wide, plus one column of the next.
    """
    rows = int(round(min(_WALL_TEXELS_HIGH, height_m * _WALL_TEXELS_PER_M))) + 1
    texels_per_m = (rows - 1) / height_m
    tile = _wall_tile(height_m, colour, texels_per_m, rows)
    soft = []
    for distance in _NEAREST_LEVEL_M * _LEVEL_RATIO ** np.arange(WALL_LEVELS):
        blurred = _blurred(tile, 0.45 * distance * texels_per_m / 554.0)
        soft.append(np.pad(blurred, ((0, 0), (0, 1), (0, 0)), 'wrap') * light(distance))
    tiles = [shade * one for shade in np.linspace(0.86, 1.0, WALL_SHADES) for one in soft]
    # One additional column, since drawing never uses the last column of a texture.
    tiles.append(tiles[-1][:, -1:])
    return np.hstack(tiles).astype(np.uint8), texels_per_m, tile.shape[1]


def floor_texture(colour, distance_m, blur_m):
    """Return (texture, texels per metre) of the floor up to a distance.

    A chequerboard with squares of half a period, centred on the corner of a period, with the blur
    ``blur_m`` and the brightness of that distance; large enough for every heading and position
    within a period.
    """
    texels_per_m = min(180.0, 300.0 / (distance_m + 1.0))
    half = int((1.17 * distance_m + FLOOR_PERIOD_M) * texels_per_m) + 2
    place = np.arange(_TILE) / _TILE
    checker = np.where((place[:, None] < 0.5) ^ (place[None] < 0.5), 1.0, 0.84)
    joint = (place % 0.5) * FLOOR_PERIOD_M < 0.008
    checker[joint[:, None] | joint[None]] = 0.74
    # Limited to half a period, where the pattern has vanished.
    sigma = min(max(blur_m, 0.4 / texels_per_m) / FLOOR_PERIOD_M, 0.5) * _TILE
    # In the frequency domain, since a periodic pattern then has no borders.
    fade = np.exp(-2.0 * (math.pi * sigma * np.fft.fftfreq(_TILE)) ** 2)
    soft = np.fft.ifft2(np.fft.fft2(checker) * fade[:, None] * fade).real
    tile = (soft[..., None] * light(distance_m) * np.array(colour, float)).astype(np.uint8)
    texel = (np.arange(-half, half) / texels_per_m / FLOOR_PERIOD_M * _TILE).astype(int) % _TILE
    return tile[texel[:, None], texel[None]], texels_per_m


def cylinder_texture(colour):
    """Return the side of a cylinder: dark on the left to lit on the right, top to bottom."""
    lit = np.linspace(0.0, 1.0, _SHADE_STEPS)[None, :, None]
    side = (0.42 + 0.58 * lit) * np.array(colour, float) + 26.0 * lit ** 6
    side = np.repeat(side, _CYLINDER_ROWS, axis=0)
    up = 1.0 - np.arange(_CYLINDER_ROWS) / (_CYLINDER_ROWS - 1.0)
    side[(up > 0.80) & (up < 0.88)] *= 0.72
    side[up < 0.06] *= 0.6
    return np.clip(side, 0.0, 255.0).astype(np.uint8)
