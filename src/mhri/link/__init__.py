# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The link to a robot with a ROS master of its own: streams, packing and the age of messages."""
