# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Accessories on the screen: lamps, grippers, heads, and whatever else a robot has."""
