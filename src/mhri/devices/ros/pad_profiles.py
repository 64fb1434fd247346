# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The files of all pad profiles: the operator's own before the shipped ones."""
import glob
import os

import rospkg

from mhri.base.config import ConfigError
from mhri.devices.pads import load_profiles
from mhri.graph.ros.resources import read_text, resource_path


def own_folder():
    """Return the folder of the operator's own profiles, ``$ROS_HOME/mhri/pads``."""
    return os.path.join(rospkg.get_ros_home(), 'mhri', 'pads')


def shipped_names():
    """Return the names of the shipped profiles; an operator's own must have another name."""
    return {os.path.splitext(os.path.basename(path))[0]
            for path in glob.glob(resource_path('pads', '*.yaml'))}


def read_profiles():
    """Return ([:class:`mhri.devices.profile.Profile`], [what is wrong with other files]).

    The first ones are preferred.
    """
    shipped = shipped_names()
    files, problems = [], []
    for path in (sorted(glob.glob(os.path.join(own_folder(), '*.yaml')))
                 + sorted(glob.glob(resource_path('pads', '*.yaml')))):
        name = os.path.splitext(os.path.basename(path))[0]
        if name in shipped and path.startswith(own_folder()):
            problems.append('{}: {} is the name of a shipped profile; rename the file'.format(
                path, name))
            continue
        try:
            files.append((name, path, read_text(path)))
        except (OSError, ConfigError) as error:
            problems.append(error)
    profiles, errors = load_profiles(files)
    return profiles, problems + errors


def pad_profiles():
    """Return every profile as :func:`read_profiles`; name others in the log once a minute."""
    # Slow to import: the doctor reads profiles without it.
    import rospy
    profiles, problems = read_profiles()
    for problem in problems:
        rospy.logwarn_throttle(60.0, 'a pad profile is left out: {}'.format(problem))
    return profiles
