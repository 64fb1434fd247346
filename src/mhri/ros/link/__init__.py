# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The link between a robot's own master and the host's: its two sides, and what carries them."""
