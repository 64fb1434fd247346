# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""ROS infrastructure: the master, start and shutdown of a node, its log, trusted senders."""
