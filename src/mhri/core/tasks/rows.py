# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Every task that there is: a row each, in the order in which they are offered."""
from mhri.core.tasks import follow, formation, goto, hold, patrol, retrace, square
from mhri.core.tasks.base import by_key

TASKS = (goto.ROW, square.ROW, follow.ROW, formation.ROW, patrol.ROW, retrace.ROW, hold.ROW)
BY_KEY = by_key(TASKS)
