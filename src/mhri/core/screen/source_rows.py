# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The sources of the drop-down, as a parameter has them that any program may set."""
from typing import Any, Tuple

from mhri.core.screen.text import tidy_text

MOST_SOURCES = 30


def source_rows(parameter: Any) -> Tuple[Tuple[str, str], ...]:
    """Return pairs (name, label); a row that is none is left out, and so is all that is no list.

    :param parameter: ``/mux/sources``: a list of dicts with ``name`` and ``label``
    """
    rows = parameter if isinstance(parameter, list) else []
    pairs = [(row.get('name'), row.get('label')) for row in rows if isinstance(row, dict)]
    return tuple((tidy_text(name), tidy_text(label)) for name, label in pairs[:MOST_SOURCES]
                 if isinstance(name, str) and isinstance(label, str) and name)
