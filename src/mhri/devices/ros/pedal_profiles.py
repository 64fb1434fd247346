# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The files of all pedal profiles: the operator's own before the shipped ones."""
import glob
import os

import rospkg
import rospy

from mhri.base.config import ConfigError
from mhri.devices.pedals import load_pedal_profiles
from mhri.graph.ros.resources import read_text, resource_path


class PedalProfiles:
    """Reads ``$ROS_HOME/mhri/pedals/*.yaml`` and ``resource/pedals/*.yaml``.

    It reads them anew only when one has changed, since it is called once a second to look for a
    pedal.
    """

    def __init__(self):
        self._seen = None
        self._profiles = {}

    def __call__(self):
        """Return {name: :class:`mhri.devices.pedals.PedalProfile`}.

        Leave out an unusable file, and name it in the log once.
        """
        seen = [(path, _changed_at(path)) for path in _paths()]
        if seen != self._seen:
            self._seen = seen
            self._profiles = _load([path for path, _ in seen])
        return self._profiles


def _paths():
    """Return the paths of all profiles, the more important first."""
    folders = (os.path.join(rospkg.get_ros_home(), 'mhri', 'pedals'), resource_path('pedals'))
    return [path for folder in folders for path in sorted(glob.glob(
        os.path.join(folder, '*.yaml')))]


def _changed_at(path):
    """Return when a file last changed, None if it is gone."""
    try:
        return os.stat(path).st_mtime_ns
    except OSError:
        return None


def _load(paths):
    """Return {name: profile} of the usable files."""
    files, errors = [], []
    for path in paths:
        try:
            files.append((path, read_text(path)))
        except (OSError, ConfigError) as error:
            errors.append(error)
    profiles, wrong = load_pedal_profiles(files)
    for error in errors + wrong:
        rospy.logwarn('a pedal profile is left out: %s', error)
    return profiles
