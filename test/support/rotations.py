# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What drivers send as an orientation: one table for the host and for the guard on the robot."""
import math

#: {what: (quaternion, its heading [rad])}
ROTATIONS = {
    'unturned': ((0.0, 0.0, 0.0, 1.0), 0.0), 'negated': ((0.0, 0.0, 0.0, -1.0), 0.0),
    'half_a_turn': ((0.0, 0.0, 1.0, 0.0), math.pi),
    'half_a_turn_as_computed': ((0.0, 0.0, 1.0, 6.1e-17), math.pi),
    'typed_by_hand': ((0.0, 0.0, 0.7, 0.7), math.pi / 2.0),
    'float32': ((0.0, 0.0, 0.38268343, 0.9238795), math.pi / 4.0)}
#: {what: a quaternion of no rotation}
NONE = {
    'zeros': (0.0, 0.0, 0.0, 0.0), 'only_z': (0.0, 0.0, 0.3, 0.0),
    'an_angle_as_z': (0.0, 0.0, 0.97, 0.0), 'an_angle_beside_a_one': (0.0, 0.0, 1.5, 1.0),
    'degrees': (0.0, 0.0, 90.0, 0.0), 'only_w': (0.0, 0.0, 0.0, 0.5), 'three_times': (0, 0, 0, 3),
    'nan': (0.0, 0.0, math.nan, 1.0), 'inf': (math.inf, 0.0, 0.0, 1.0),
    'huge': (1e200, 0.0, 0.0, 1.0)}
