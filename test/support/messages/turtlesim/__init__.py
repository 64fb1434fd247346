# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Stands in for turtlesim's messages, which Debian does not package."""
