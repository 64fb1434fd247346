# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Reads all pedal profiles: the operator's own take precedence over the shipped ones."""
import glob
import os

import rospkg
import rospy

from mhri.devices.pedals import load_pedal_profiles
from mhri.graph.ros.resources import read_all, resource_path


class PedalProfiles:
    """Reads ``$ROS_HOME/mhri/pedals/*.yaml`` and ``resource/pedals/*.yaml``.

    Files are read again only after a change, since it is called once a second in the search for a
    pedal.
    """

    def __init__(self):
        self._seen = None
        self._profiles = {}

    def __call__(self):
        """Return {name: :class:`mhri.devices.pedals.PedalProfile`}.

        Unusable files are left out, and logged once.
        """
        folders = os.path.join(rospkg.get_ros_home(), 'mhri', 'pedals'), resource_path('pedals')
        seen = [(path, _changed_at(path)) for folder in folders
                for path in sorted(glob.glob(os.path.join(folder, '*.yaml')))]
        if seen != self._seen:
            self._seen = seen
            self._profiles = _load(*folders)
        return self._profiles


def _changed_at(path):
    """Return the time of a file's last change, None if it is gone."""
    try:
        return os.stat(path).st_mtime_ns
    except OSError:
        return None


def _load(*folders):
    """Return {name: profile} of the usable files; earlier folders take precedence."""
    files, errors = read_all(*folders)
    profiles, wrong = load_pedal_profiles(files)
    for error in errors + wrong:
        rospy.logwarn('a pedal profile is left out: %s', error)
    return profiles
