# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""IMU, odometry, scans, clouds; the brake that looks at them."""
