# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Tasks that robots perform by themselves, one file each, and their obstacle avoidance."""
