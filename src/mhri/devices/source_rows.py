# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The sources of the drop-down, read from a parameter that any program may set."""
from typing import Any, Dict, Iterable, List, Tuple

from mhri.base.names import is_global_name
from mhri.base.text import tidy_text
from mhri.base.views import DeviceView

MAX_SOURCES = 30
ABSENT = '{} (not connected)'
_Rows = Tuple[Tuple[str, str], ...]


def _rows(parameter: Any) -> List[Dict[str, Any]]:
    """Return the rows that have a name and a label."""
    rows = parameter if isinstance(parameter, list) else []
    return [row for row in rows[:MAX_SOURCES] if isinstance(row, dict) and row.get('name')
            and isinstance(row['name'], str) and isinstance(row.get('label'), str)]


def source_rows(parameter: Any) -> _Rows:
    """Return pairs (name, label) of the valid rows, () if the parameter is not a list.

    :param parameter: ``/mux/sources``: a list of dicts with ``name`` and ``label``
    """
    return tuple((tidy_text(row['name']), tidy_text(row['label'])) for row in _rows(parameter))


def suspend_services(parameter: Any) -> Dict[str, str]:
    """Return {name of a source: service that suspends its node}, for sources with one.

    :param parameter: as for :func:`source_rows`
    """
    return {tidy_text(row['name']): row['suspend_service'] for row in _rows(parameter)
            if isinstance(row.get('suspend_service'), str)
            and is_global_name(row['suspend_service'])}


def labelled_by_device(rows: _Rows, devices: Iterable[DeviceView]) -> _Rows:
    """Return the rows labelled with the name of their device, or marked as not connected."""
    labels = {device.source: device for device in devices}
    return tuple((name, _label(label, labels.get(name, DeviceView(name)))) for name, label in rows)


def _label(label: str, device: DeviceView) -> str:
    return ABSENT.format(label) if device.absent else device.name or label
