# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Beneath ROS: the master, start and end of a node, its log, whose messages count."""
