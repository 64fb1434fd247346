# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What robots do by themselves: a task in a file each, what keeps them from obstacles."""
