# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Reads the files of pads and of the mux for the doctor."""
from mhri.base.config import ConfigError
from mhri.devices.ros.pad_profiles import read_profiles
from mhri.driving.ros.mux_file import read_mux_config, shipped_path


def look_at_files(parameters):
    """Return ``pad_errors`` and ``mux_error`` of :class:`mhri.doctor.facts.Facts` (blocking).

    :param parameters: parameters of the master as a nested dict, {} without a master
    """
    return {'pad_errors': tuple(str(error) for error in read_profiles()[1]),
            'mux_error': _mux_error(parameters)}


def _mux_error(parameters):
    """Return why the mux's file is unusable, '' if it is usable."""
    mux = parameters.get('mux')
    path = mux.get('config') if isinstance(mux, dict) else None
    path = path if path and isinstance(path, str) else shipped_path()
    try:
        read_mux_config(path)
    except ConfigError as error:
        return str(error)
    except OSError as error:
        return '{}: {}'.format(path, error.strerror)
    return ''
