# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The profile that a Joy message names for its device."""
import os

from mhri.base.config import ConfigError
from mhri.base.names import is_base_name
from mhri.devices.profile import JoyRefused, parse_profile
from mhri.devices.ros.pad_profiles import own_folder
from mhri.graph.ros.resources import read_text, resource_path

PREFIX = 'profile:'


class DeviceProfiles:
    """Reads the profiles that devices name in ``header.frame_id`` as ``profile:<name>``.

    It reads a profile when it first hears the device, and again after another device was heard or
    :meth:`forget` was called. Shipped names come from ``resource/pads``, all others from the
    operator's own folder.

    :param dead_man: whether their dead-man buttons must be held
    """

    def __init__(self, dead_man=True):
        self._dead_man = dead_man
        self._newest = {}

    def of(self, source, frame_id):
        """Return the :class:`Profile` of a message, None for the source's own.

        :param source: name of the source
        :param frame_id: of the Joy; anything but ``profile:<name>`` asks for the source's own
        :raises JoyRefused: there is no such profile, or it is unusable
        """
        if not frame_id.startswith(PREFIX):
            return None
        name, profile = self._newest.get(source, ('', None))
        if name != frame_id:
            profile = _read(frame_id[len(PREFIX):])
            if not (self._dead_man or isinstance(profile, JoyRefused)):
                profile = profile.without_dead_man()
            self._newest[source] = (frame_id, profile)
        if isinstance(profile, JoyRefused):
            raise profile
        return profile

    def forget(self):
        """Read every profile anew when next asked for it."""
        self._newest = {}


def _read(name):
    """Return a profile, or why there is none (kept, so that asking again costs nothing)."""
    if not is_base_name(name):
        return JoyRefused('unknown_profile', '{!r} is not the name of a profile'.format(name))
    path = resource_path('pads', name + '.yaml')
    if not os.path.exists(path):
        path = os.path.join(own_folder(), name + '.yaml')
    try:
        return parse_profile(read_text(path), path)
    except (OSError, ConfigError) as error:
        return JoyRefused('unknown_profile', 'the device names profile {}, which is unusable '
                          'here: {}'.format(name, error))
