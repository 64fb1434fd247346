# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Parameters of the screen: camera budget, disk reserves and more."""
from dataclasses import dataclass
from typing import Any, Dict, List, Tuple

from mhri.base.config import ConfigError, Section
from mhri.recording.recording import MB, RecordingLimits

NAMESPACE = '/mhri/panel'


@dataclass(frozen=True)
class PanelSettings:
    """The parameters in :data:`NAMESPACE`, each with its default.

    ``thumbnail_hz`` and ``thumbnail_width_px`` are the rate [Hz] and maximum width [px] of
    pictures in small tiles; ``record_warn_free_mb`` and ``record_stop_free_mb`` are the free space
    [MB] at which a recording warns, and at which it stops and closes its file. ``slow_with_link``
    slows all selected robots down with the slowest of their links. ``camera_budget_mbit_s`` is the
    bandwidth for all pictures together [Mbit/s], 0 for no limit (:mod:`mhri.camera.budget`).
    """

    thumbnail_hz: float = 5.0
    thumbnail_width_px: int = 640
    record_warn_free_mb: float = 1000.0
    record_stop_free_mb: float = 256.0
    slow_with_link: bool = False
    camera_budget_mbit_s: float = 0.0

    def recording_limits(self) -> RecordingLimits:
        """Return the :class:`RecordingLimits` of these settings."""
        return RecordingLimits(warn_free_bytes=round(self.record_warn_free_mb * MB),
                               stop_free_bytes=round(self.record_stop_free_mb * MB))


# {key: (minimum, maximum)}.
_RANGES = {'thumbnail_hz': (0.1, 60.0), 'thumbnail_width_px': (32.0, 4096.0),
           'record_warn_free_mb': (1.0, 1e9), 'record_stop_free_mb': (1.0, 1e9),
           'camera_budget_mbit_s': (0.0, 1e5)}

_FLAGS = ('slow_with_link',)


def _read(section: Section, key: str) -> Any:
    """Return one setting, or its default if missing.

    :raises ConfigError: the value is invalid
    """
    default = getattr(PanelSettings, key)
    if key in _FLAGS:
        return section.flag(key, default)
    return type(default)(section.number(key, *_RANGES[key], default))


def parse_settings(parameters: Any,
                   before: PanelSettings = PanelSettings()
                   ) -> Tuple[PanelSettings, List[ConfigError]]:
    """Return (PanelSettings, [ConfigError]); invalid parameters keep their previous values.

    :param parameters: dict of the parameters in the namespace, or None
    :param before: the current settings
    """
    errors = []
    try:
        section = Section({} if parameters is None else parameters, NAMESPACE)
    except ConfigError as error:
        return before, [error]
    values: Dict[str, Any] = {}
    for key in (*_RANGES, *_FLAGS):
        try:
            values[key] = _read(section, key)
        except ConfigError as error:
            errors.append(error)
            values[key] = getattr(before, key)
    if values['record_warn_free_mb'] < values['record_stop_free_mb']:
        errors.append(section.error('record_warn_free_mb', 'must not be less than '
                                    'record_stop_free_mb: the warning would come too late'))
        values.update(record_warn_free_mb=before.record_warn_free_mb,
                      record_stop_free_mb=before.record_stop_free_mb)
    try:
        section.close()
    except ConfigError as error:
        errors.append(error)
    return PanelSettings(**values), errors
