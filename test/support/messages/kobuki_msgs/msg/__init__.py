# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""``kobuki_msgs/MotorPower`` as Kobuki defines it (http://docs.ros.org/api/kobuki_msgs)."""
from genpy.dynamic import generate_dynamic

MotorPower = generate_dynamic('kobuki_msgs/MotorPower', 'uint8 OFF = 0\nuint8 ON  = 1\n'
                              'uint8 state\n')['kobuki_msgs/MotorPower']
