# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The result of a drill, read from the file in its session, and its figures as a table."""
from typing import Any, Dict, List, Mapping, Sequence, Tuple

from mhri.base.config import parse_yaml

FORMAT = 1
FILE = 'drill.yaml'
# (key of a result, label, unit) of the figures for comparing runs.
FIGURES = (
    ('time_s', 'time', 's'), ('found', 'targets found', ''), ('contacts', 'contacts', ''),
    ('distance_m', 'distance', 'm'), ('driven_s', 'time driven', 's'),
    ('neglected_s', 'time neglected', 's'), ('attention', 'attention', ''),
    ('fan_out', 'fan-out', ''), ('neglect_tolerance_s', 'neglect tolerance', 's'),
    ('reaction_s', 'mean reaction', 's'), ('stops', 'stops', ''))


def read_result(text: str, origin: str) -> Dict[str, Any]:
    """Return the result in a ``drill.yaml``.

    :raises ConfigError: the text is not a result, or of another format version
    """
    top = parse_yaml(text, origin)
    if top.index('format') != FORMAT:
        raise top.error('format', 'expected {}: written by another version of mhri'.format(FORMAT))
    result: Dict[str, Any] = {'title': top.text('title'), 'drill': top.text('drill'),
                              'operator': top.text('operator'), 'ended': top.text('ended'),
                              'begun': top.number('begun', 0.0, 1e11),
                              'targets': top.index('targets')}
    for key, _, _ in FIGURES:
        result[key] = top.number(key, 0.0, 1e9, None)
    return result


def shown(key: str, result: Mapping[str, Any], unit: str = '') -> str:
    """Return a figure of a result with its unit, "-" if unknown."""
    value = result[key]
    if value is None:
        return '-'
    if key == 'found':
        return '{:.0f} of {}'.format(value, result['targets'])
    digits = 2 if key in ('attention', 'fan_out', 'reaction_s') else 0 if not unit else 1
    return '{:.{}f} {}'.format(value, digits, unit).rstrip()


def rows_of(results: Sequence[Mapping[str, Any]]) -> List[Tuple[str, ...]]:
    """Return the table of one or more runs: rows of (label, figure of each run)."""
    return [(label, *(shown(key, result, unit) for result in results))
            for key, label, unit in FIGURES]
