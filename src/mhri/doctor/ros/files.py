# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The doctor reads the files of pads and of the mux, while nodes have time to answer."""
import threading
import time

from mhri.base.config import ConfigError
from mhri.devices.ros.pad_profiles import read_profiles
from mhri.driving.sources import parse_mux_config
from mhri.graph.ros.resources import profile_reader, read_text, resource_path


class FilesLook:
    """Reads the files; returns at once.

    :param parameters: those of the master as a nested dict, {} if there is none
    """

    def __init__(self, parameters):
        self._found = {}
        self._thread = threading.Thread(target=self._read, args=(parameters,), daemon=True)
        self._thread.start()

    def _read(self, parameters):
        self._found = {'pad_errors': tuple(str(error) for error in read_profiles()[1]),
                       'mux_error': _mux_error(parameters)}

    def result(self, deadline):
        """Return ``pad_errors`` and ``mux_error`` of :class:`mhri.doctor.facts.Facts`.

        :param deadline: until when to wait for a slow disk [s, monotonic]: {} then
        """
        self._thread.join(max(0.0, deadline - time.monotonic()))
        return self._found


def _mux_error(parameters):
    """Return why the file that the mux reads cannot be used, '' if it can."""
    mux = parameters.get('mux')
    path = mux.get('config') if isinstance(mux, dict) else None
    path = path if path and isinstance(path, str) else resource_path('mux.yaml')
    try:
        parse_mux_config(read_text(path), path, profile_reader(path))
    except ConfigError as error:
        return str(error)
    except OSError as error:
        return '{}: {}'.format(path, error.strerror)
    return ''
