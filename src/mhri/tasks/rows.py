# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""All tasks of mhri, in their order on the screen."""
from typing import Dict, Iterable, List, Tuple

from mhri.base.config import ConfigError
from mhri.base.names import name_problem
from mhri.tasks import follow, formation, goto, hold, patrol, replay, retrace, square
from mhri.tasks.base import by_key, Field, NUMBER, TaskKind

TASKS = (goto.ROW, square.ROW, follow.ROW, formation.ROW, patrol.ROW, replay.ROW, retrace.ROW,
         hold.ROW)
BY_KEY = by_key(TASKS)


def with_exports(exports: Iterable[Tuple[str, object]]
                 ) -> Tuple[Dict[str, TaskKind], List[ConfigError]]:
    """Return ({key: row}, errors) of mhri's tasks and of those exported by other packages.

    :param exports: (origin, row) of each; a bad one does not affect the others
    """
    rows, errors = dict(BY_KEY), []
    for origin, row in exports:
        problem = row_problem(row)
        if isinstance(row, TaskKind) and not problem and row.key not in rows:
            rows[row.key] = row
        else:
            problem = problem or 'there is a task {!r} already, choose another key'.format(
                getattr(row, 'key', ''))
            errors.append(ConfigError(origin, 'ROW', problem + '; fix it there and start mhri '
                                      'again'))
    return rows, errors


def row_problem(row: object) -> str:
    """Return why an object is not the row of a task, '' if it is."""
    if not isinstance(row, TaskKind):
        return 'expected a mhri.tasks.base.TaskKind, got {}'.format(type(row).__name__)
    if not isinstance(row.key, str) or name_problem(row.key):
        return 'its key is not a name: {!r:.60}'.format(row.key)
    if not all(isinstance(text, str) for text in (row.label, row.text)) or not callable(row.make):
        return 'its label and text have to be texts, its make a function'
    fields = row.fields
    if not isinstance(fields, tuple) or not all(isinstance(field, Field) for field in fields):
        return 'its fields have to be a tuple of mhri.tasks.base.Field'
    if ('timeout', NUMBER) not in [(field.name, field.kind) for field in fields]:
        return 'it has no field timeout: add mhri.tasks.goto.TIMEOUT_S'
    return ''
