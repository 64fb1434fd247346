# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The link to a robot on a master of its own: what is carried, how it is packed, how old it is."""
