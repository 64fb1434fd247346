# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Draws the colour and depth pictures of a simulated camera from the floor plan.

The camera is level, at the robot's centre, and faces ahead or where its head is turned. All
surfaces of the building are upright, so one ray per column of the picture is enough; each ray
vector advances 1 m along the optical axis, so its parameter is the z-depth. A tilt shifts the
picture up or down, as the lens of an architect's camera: uprights stay upright.
"""
from collections import namedtuple
import math

import numpy as np

from mhri.base.opencv import cv2
from mhri.sim import textures
from mhri.sim.lens import CAMERA_HEIGHT_M, CENTRE_X_PX, CENTRE_Y_PX, FOCAL_PX, HEIGHT, WIDTH

DEPTH_MAX_M = 10.0

_NEAR_M, _FAR_M = 0.02, 200.0
_FLOOR_TO_M = 20.0
_BAND_RATIO = 1.2
# Prevents rays from passing between two walls that share a corner.
_OVERLAP = 1e-9
_NOTHING_MM = 65535
# Walls are drawn in strips of this many columns, each with only the rows it needs.
_STRIP = 80
_CEILING = (236, 236, 232)
# Direction of the light on cylinders, (right, forward) as seen by the camera.
_LIGHT = (-0.55, -0.835)

View = namedtuple('View', 'x y yaw wall_m wall_share wall cylinders shift')
View.__doc__ = """The meeting of one frame's rays: pose; for each column the z-depth of the wall [m]
(inf: none), the way along it [m] and its number; the :class:`Cylinder` s, farthest first; by how
many rows the horizon is below the middle of the picture."""

Cylinder = namedtuple('Cylinder', 'begin end near_m far_m lit height_m colour')
Cylinder.__doc__ = """A cylinder in columns ``begin`` to ``end``: z-depth where the rays go in and
out [m] (near: inf where it is hidden), how lit it is there (0 to 1), height [m], colour."""


class Camera:
    """Draws frames of one plan; not thread-safe, since frames share their buffers.

    :param plan: :class:`mhri.sim.plan.Plan`
    :param max_shift: see :meth:`look` [rows]
    """

    def __init__(self, plan, max_shift=0):
        self._max_shift = max_shift
        self._wall_height_m = plan.wall_height_m
        # A camera above the walls would see behind them.
        self.height_m = min(CAMERA_HEIGHT_M, 0.75 * plan.wall_height_m)
        self._floor_colour = plan.floor_colour
        self._wall_colour = plan.wall_colour
        self._start, along = plan.walls[:, :2], plan.walls[:, 2:] - plan.walls[:, :2]
        self._along = along
        self._length = np.hypot(along[:, 0], along[:, 1])
        angle = np.arctan2(along[:, 1], along[:, 0])
        self._wall_shade = np.rint((textures.WALL_SHADES - 1) * np.abs(np.cos(angle)))
        landmarks = plan.landmarks
        self._landmarks = plan.discs()
        self._landmark_looks = [(item.height_m, item.colour) for item in landmarks]
        self._right = (np.arange(WIDTH) - CENTRE_X_PX) / FOCAL_PX
        # These and what follows from them have the rows of all shifts, see _rows().
        self._down = (np.arange(-max_shift, HEIGHT + max_shift) - CENTRE_Y_PX) / FOCAL_PX
        self._down32 = self._down.astype(np.float32)[:, None]
        above = self._wall_height_m - self.height_m
        self._plane_m = np.where(self._down > 0.0, self.height_m, above) / np.abs(self._down)
        self._plane_mm = _millimetres(self._plane_m)[:, None]
        self._looks = None
        self._cylinder_textures = {}

    def look(self, x, y, yaw, others, shift=0):
        """Return the :class:`View` from a pose [m, m, rad].

        :param others: the other robots, a structured array with ``x, y, radius, height`` [m] and
            ``colour``, as :meth:`mhri.sim.world.World.others` returns it
        :param shift: rows by which the horizon is below the middle of the picture
        """
        shift = max(-self._max_shift, min(self._max_shift, shift))
        cos, sin = math.cos(yaw), math.sin(yaw)
        turn = np.array([[sin, cos], [-cos, sin]])
        start, along = (self._start - (x, y)) @ turn, self._along @ turn
        wall_m, share, wall = self._walls(start, along)
        discs = self._landmarks
        looks = self._landmark_looks
        if len(others):
            discs = np.vstack((discs, np.column_stack((others['x'], others['y'],
                                                       others['radius']))))
            looks = looks + [(float(row['height']), tuple(map(int, row['colour'])))
                             for row in others]
        centres = (discs[:, :2] - (x, y)) @ turn
        cylinders = self._cylinders(centres, discs[:, 2], looks, wall_m)
        return View(x, y, yaw, wall_m, share * self._length[wall], wall, cylinders, shift)

    def _rows(self, view):
        """Return which of the rows of all shifts are in the picture."""
        top = self._max_shift - view.shift
        return slice(top, top + HEIGHT)

    def _walls(self, start, along):
        """Return (z-depth, fraction of its length, index) of each column's nearest wall."""
        # Walls behind the camera need no rays.
        ahead = np.flatnonzero(np.maximum(start[:, 1], start[:, 1] + along[:, 1]) > 0.0)
        if not len(ahead):
            return np.full(WIDTH, np.inf), np.zeros(WIDTH), np.zeros(WIDTH, int)
        px, pz, ex, ez = (column[ahead, None] for column in (
            start[:, 0], start[:, 1], along[:, 0], along[:, 1]))
        with np.errstate(divide='ignore', invalid='ignore'):
            share = (self._right * pz - px) / (ex - self._right * ez)
            depth = pz + share * ez
            good = (share >= -_OVERLAP) & (share <= 1.0 + _OVERLAP) & (depth > 0.0)
        depth = np.where(good, np.maximum(depth, _NEAR_M), np.inf)
        nearest = depth.argmin(axis=0)
        columns = np.arange(WIDTH)
        wall_m = depth[nearest, columns]
        share = np.where(np.isfinite(wall_m), share[nearest, columns], 0.0)
        return wall_m, share, ahead[nearest]

    def _cylinders(self, centres, radii, looks, wall_m):
        """Return the visible cylinders, farthest first."""
        power = (centres ** 2).sum(axis=1) - radii ** 2
        found = []
        # Sorted by the length of the tangent, disjoint cylinders occlude each other correctly.
        for index in np.argsort(-power):
            (right, ahead), radius = centres[index], radii[index]
            if power[index] <= 0.0 or ahead < -radius:
                continue
            a = 1.0 + self._right ** 2
            b = self._right * right + ahead
            root2 = b * b - a * power[index]
            columns = np.flatnonzero((root2 > 0.0) & (b > 0.0))
            if not len(columns):
                continue
            begin, end = columns[0], columns[-1] + 1
            root = np.sqrt(np.maximum(root2[begin:end], 0.0))
            near = (b[begin:end] - root) / a[begin:end]
            far = (b[begin:end] + root) / a[begin:end]
            seen = near < wall_m[begin:end]
            if not seen.any():
                continue
            lit = ((near * self._right[begin:end] - right) * _LIGHT[0]
                   + (near - ahead) * _LIGHT[1]) / radius
            near = np.where(seen, np.maximum(near, _NEAR_M), np.inf)
            found.append(Cylinder(begin, end, near, far, 0.5 + 0.5 * lit, *looks[index]))
        return found

    def depth(self, view):
        """Return the z-depth [mm] of each pixel, uint16 (480, 640), 0 beyond 10 m.

        Walls, floor, ceiling and cylinders are exact except for rounding.
        """
        picture = np.minimum(self._plane_mm[self._rows(view)], _millimetres(view.wall_m))
        for cylinder in view.cylinders:
            self._deepen(picture[:, cylinder.begin:cylinder.end], cylinder, view)
        picture[picture > DEPTH_MAX_M * 1000.0] = 0
        return picture

    def _deepen(self, picture, cylinder, view):
        """Draw a cylinder into its columns of a depth picture, except where it is occluded."""
        top_m = cylinder.height_m - self.height_m
        near, down = _millimetres(cylinder.near_m), self._down[self._rows(view)]
        with np.errstate(divide='ignore'):
            edge_m = -top_m / down
        if top_m >= 0.0:
            # Above the horizon the side ends where the ray rises to the top.
            first = self._first_row(top_m, cylinder.near_m, view)
            edge = np.where(down[first:] < 0.0, edge_m[first:], np.inf)[:, None]
            side = np.where(edge >= cylinder.near_m, near, np.uint16(_NOTHING_MM))
        else:
            # The camera is above it: the top from its far to its near edge, then the side.
            first = self._first_row(top_m, cylinder.far_m, view)
            edge = edge_m[first:, None]
            side = np.maximum(_millimetres(edge), near)
            side[edge > cylinder.far_m] = _NOTHING_MM
        part = picture[first:]
        np.minimum(part, side, out=part)

    @staticmethod
    def _first_row(top_m, distances, view):
        """Return the first row with points at a height above the camera."""
        nearest = distances.min() if top_m >= 0.0 else distances.max()
        return int(np.clip(CENTRE_Y_PX + view.shift - FOCAL_PX * top_m / nearest, 0, HEIGHT - 1))

    def rgb(self, view, light=1.0):
        """Return the colours of each pixel, uint8 (480, 640, 3), red, green, blue.

        :param light: how bright it is, 0 to 1
        """
        if self._looks is None:
            self._looks = _Looks(self)
        looks = self._looks
        picture = looks.background[self._rows(view)].copy()
        self._paint_floor(picture, view, looks)
        tile = (textures.WALL_LEVELS * self._wall_shade[view.wall]
                + textures.level_of(np.minimum(view.wall_m, _FAR_M)))
        across = (tile * (looks.tile_width + 1)
                  + view.wall_share % textures.WALL_PERIOD_M
                  * (looks.tile_width / textures.WALL_PERIOD_M))
        for begin in range(0, WIDTH, _STRIP):
            strip = slice(begin, begin + _STRIP)
            self._paint(picture[:, strip], looks.wall, looks.wall_texels_per_m, across[strip],
                        view.wall_m[strip], self._wall_height_m, view)
        for cylinder in view.cylinders:
            self._paint_cylinder(picture[:, cylinder.begin:cylinder.end], cylinder, view)
        return picture if light >= 1.0 else cv2.convertScaleAbs(picture, picture, light)

    def _paint_floor(self, picture, view, looks):
        """Draw the floor as far as the farthest wall."""
        farthest = view.wall_m.max()
        # The rows with floor that are in the picture, counted from the first that can have any.
        shift = self._rows(view).start - (len(self._down) - len(looks.band_row_m))
        first = max(int(np.searchsorted(-looks.band_row_m, -farthest)), shift)
        last = min(len(looks.band_row_m), HEIGHT + shift)
        rows = slice(first, last)
        cos, sin = math.cos(view.yaw), math.sin(view.yaw)
        maps = []
        for place, heading in ((view.x, cos + self._right * sin),
                               (view.y, sin - self._right * cos)):
            texels = looks.band_scale[rows] * heading.astype(np.float32)
            texels += (looks.band_middle[rows]
                       + np.float32(place % textures.FLOOR_PERIOD_M) * looks.band_texels[rows])
            maps.append(texels)
        for begin, end, texture in looks.bands:
            begin, end = max(begin, first), min(end, last)
            if begin < end:
                cv2.remap(texture, maps[0][begin - first:end - first],
                          maps[1][begin - first:end - first], cv2.INTER_LINEAR,
                          dst=picture[begin - shift:end - shift], borderMode=cv2.BORDER_REPLICATE)

    def _paint(self, picture, texture, texels_per_m, across, distances, height_m, view):
        """Draw an upright surface within the limits of its texture.

        :param across: column of the texture for each column of the picture
        :param distances: z-depth of each column [m], inf without a surface
        """
        top_m = height_m - self.height_m
        first = self._first_row(top_m, np.minimum(distances, _FAR_M), view)
        foot = FOCAL_PX * self.height_m / distances.min()
        last = int(np.clip(CENTRE_Y_PX + view.shift + foot + 2.0, 0, HEIGHT))
        if last <= first:
            return
        # Texels outside the texture leave the picture unchanged, which clips the surface.
        across = np.where(np.isfinite(distances), across, -10.0).astype(np.float32)
        reach = (np.minimum(distances, _FAR_M) * texels_per_m).astype(np.float32)
        down = self._down32[self._rows(view)][first:last] * reach
        down += np.float32(top_m * texels_per_m)
        cv2.remap(texture, np.broadcast_to(across, down.shape).copy(), down, cv2.INTER_LINEAR,
                  dst=picture[first:last], borderMode=cv2.BORDER_TRANSPARENT)

    def _paint_cylinder(self, picture, cylinder, view):
        """Draw the side of a cylinder, and its top if the camera is above it."""
        texture = self._cylinder_textures.get(cylinder.colour)
        if texture is None:
            texture = textures.cylinder_texture(cylinder.colour)
            self._cylinder_textures[cylinder.colour] = texture
        rows, columns = texture.shape[:2]
        self._paint(picture, texture, (rows - 1) / cylinder.height_m,
                    np.clip(cylinder.lit, 0.0, 1.0) * (columns - 1.1), cylinder.near_m,
                    cylinder.height_m, view)
        top_m = cylinder.height_m - self.height_m
        if top_m < 0.0:
            first = self._first_row(top_m, cylinder.far_m, view)
            edge = -top_m / self._down[self._rows(view)][first:, None]
            is_top = (edge > cylinder.near_m) & (edge <= cylinder.far_m)
            picture[first:][is_top] = texture[rows // 2, -1] // 4 * 3 + 56


class _Looks:
    """The textures of a camera's plan, created with the first requested picture.

    The floor is cut into bands of rows, each with a texture for its distance; the arrays named
    ``band_*`` have one row for each picture row that can show floor.
    """

    def __init__(self, camera):
        self.wall, self.wall_texels_per_m, self.tile_width = textures.wall_texture(
            camera._wall_height_m, camera._wall_colour)
        distances = np.minimum(camera._plane_m, _FAR_M)
        colour = np.where((camera._down > 0.0)[:, None], np.array(camera._floor_colour) * 0.92,
                          _CEILING)
        rows = colour * textures.light(distances)[:, None]
        self.background = np.repeat(rows.astype(np.uint8)[:, None], WIDTH, axis=1)
        first = int(np.flatnonzero((camera._down > 0.0) & (camera._plane_m < _FLOOR_TO_M))[0])
        self.band_row_m = camera._plane_m[first:]
        self.band_texels = np.empty((len(self.band_row_m), 1), np.float32)
        self.band_middle = np.empty_like(self.band_texels)
        self.bands = []
        begin = 0
        while begin < len(self.band_row_m):
            farthest = self.band_row_m[begin]
            end = int(np.searchsorted(-self.band_row_m, -farthest / _BAND_RATIO)) + 1
            end = min(end, len(self.band_row_m))
            texture, texels_per_m = textures.floor_texture(
                camera._floor_colour, farthest,
                0.4 * farthest ** 2 / (FOCAL_PX * camera.height_m))
            self.bands.append((begin, end, texture))
            self.band_texels[begin:end] = texels_per_m
            self.band_middle[begin:end] = texture.shape[0] // 2
            begin = end
        self.band_scale = self.band_texels * self.band_row_m.astype(np.float32)[:, None]


def _millimetres(metres):
    """Return metres as uint16 millimetres, clipped to the maximum."""
    return np.rint(np.minimum(metres * 1000.0, _NOTHING_MM)).astype(np.uint16)
