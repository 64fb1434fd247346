# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The simulated camera as a pinhole: picture size and position."""
import math

WIDTH, HEIGHT = 640, 480
HORIZONTAL_FOV_RAD = math.radians(60.0)
FOCAL_PX = 0.5 * WIDTH / math.tan(0.5 * HORIZONTAL_FOV_RAD)
# The middle of the picture, between pixels; centres of pixels are at integers.
CENTRE_X_PX, CENTRE_Y_PX = 0.5 * (WIDTH - 1), 0.5 * (HEIGHT - 1)
CAMERA_HEIGHT_M = 0.3
