# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Stands in for the messages of the Kobuki base, which Debian does not package."""
