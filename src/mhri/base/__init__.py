# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Foundations: geometry, names, numbers, robot types, bounds, views, texts, file access."""
