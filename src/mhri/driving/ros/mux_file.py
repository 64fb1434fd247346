# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Reads the file of the sources, ``mux.yaml``, with the pad profiles it refers to."""
import os

from mhri.driving.sources import parse_mux_config
from mhri.graph.ros.resources import read_text, resource_path


def shipped_path():
    """Return the path of the file that comes with mhri."""
    return resource_path('mux.yaml')


def read_mux_config(path):
    """Return the :class:`mhri.driving.sources.MuxConfig` of a file.

    A profile's name in it means ``resource/pads/<name>.yaml``; anything with a slash or ``.yaml``
    is a path, relative to the folder of the file.

    :raises ConfigError: a key cannot be used; the text names it and the file
    :raises OSError: the file or a profile cannot be read
    """
    def profile(name):
        """Return (origin, text) of a profile."""
        found = resource_path('pads', name + '.yaml')
        if os.sep in name or name.endswith('.yaml'):
            found = os.path.join(os.path.dirname(os.path.abspath(path)), name)
        return found, read_text(found)

    return parse_mux_config(read_text(path), path, profile)
