# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""``turtlesim/Pose`` as turtlesim defines it (http://docs.ros.org/api/turtlesim)."""
from genpy.dynamic import generate_dynamic

Pose = generate_dynamic('turtlesim/Pose', 'float32 x\nfloat32 y\nfloat32 theta\n\n'
                        'float32 linear_velocity\nfloat32 angular_velocity\n')['turtlesim/Pose']
