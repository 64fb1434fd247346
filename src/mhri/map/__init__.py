# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The map: its grid, where robots are placed in its frame, marks and fence."""
