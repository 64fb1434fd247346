# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The rules, as plain values and small classes; no ROS, no Qt, no clock, no I/O."""
