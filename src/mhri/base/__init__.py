# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The ground: geometry, names, numbers, robot types, bounds, views, words, how a file is read."""
