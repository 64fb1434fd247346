# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What joins its ROS side and its widgets: its parts of the screen."""
