# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Turns messages into values and back; everything that talks to ROS; no Qt."""
