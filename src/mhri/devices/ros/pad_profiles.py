# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Reads all pad profiles, the operator's own before the shipped ones, and writes the former."""
import os
from pathlib import Path

import rospkg

from mhri.base.config import ConfigError
from mhri.base.io.files import whole
from mhri.devices.pads import load_profiles
from mhri.devices.profile import parse_profile
from mhri.graph.ros.resources import read_all, resource_path


def own_folder():
    """Return the folder of the operator's own profiles, ``$ROS_HOME/mhri/pads``."""
    return os.path.join(rospkg.get_ros_home(), 'mhri', 'pads')


def shipped_names():
    """Return the names of the shipped profiles; an operator's own must have another name."""
    return {path.stem for path in Path(resource_path('pads')).glob('*.yaml')}


def read_profiles():
    """Return ([:class:`mhri.devices.profile.Profile`], [problems of other files]).

    The profiles are in the order of preference.
    """
    own, unread = read_all(own_folder())
    shipped, missing = read_all(resource_path('pads'))
    names = shipped_names()
    taken = [path for path, _ in own if Path(path).stem in names]
    profiles, errors = load_profiles([row for row in own if row[0] not in taken] + shipped)
    return profiles, unread + missing + errors + [
        ConfigError(path, 'name', 'is that of a shipped profile; rename the file')
        for path in taken]


def write_profile(path, text, replace):
    """Write a profile completely or not at all, after checking that it can be parsed.

    The folder is created if missing.

    :param replace: whether to replace an existing file
    :raises FileExistsError: the file exists and must not be replaced
    :raises OSError: the file cannot be written
    :raises ConfigError: the text is not a profile
    """
    parse_profile(text, path)
    with whole(path) as part:
        with open(part, 'w', encoding='utf-8') as stream:
            stream.write(text)
        with open(part, encoding='utf-8') as stream:
            parse_profile(stream.read(), path)
        # Checked only now: another profile may have been written since the operator was asked.
        if not replace:
            os.link(part, path)


def pad_profiles():
    """Return the profiles of :func:`read_profiles`; log unusable files at most once a minute."""
    # Slow to import: the doctor reads profiles without it.
    import rospy
    profiles, problems = read_profiles()
    for problem in problems:
        rospy.logwarn_throttle(60.0, 'a pad profile is left out: {}'.format(problem))
    return profiles
