# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The profile that a Joy message names for its device."""
import os

from mhri.base.config import ConfigError
from mhri.base.names import is_base_name
from mhri.devices.pedals import NAMED
from mhri.devices.profile import JoyRefused, parse_profile
from mhri.devices.ros.pad_profiles import own_folder
from mhri.devices.ros.pedal_profiles import PedalProfiles
from mhri.graph.ros.resources import read_text, resource_path

PREFIX = 'profile:'


class DeviceProfiles:
    """Reads the profiles that devices name in ``header.frame_id`` as ``profile:<name>``.

    A profile is read at the first message of its device, and again after a message of another
    device or a call of :meth:`forget`. Shipped profiles are in ``resource/pads``, all others in the
    operator's own folder. ``profile:pedal:<name>`` is that of a foot pedal.

    :param dead_man: whether their dead-man buttons must be held
    """

    def __init__(self, dead_man=True):
        self._dead_man = dead_man
        self._newest = {}

    def of(self, source, frame_id):
        """Return the :class:`Profile` of a message, None for the source's own.

        :param source: name of the source
        :param frame_id: of the Joy; the source's own is used unless it is ``profile:<name>``
        :raises JoyRefused: the profile is missing or unusable
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
        """Read every profile again at its next use."""
        self._newest = {}


def _read(name):
    """Return a profile, or the reason for its absence (cached, so that repeated use is cheap)."""
    if name.startswith(NAMED):
        pedals = PedalProfiles()().get(name[len(NAMED):])
        return pedals.as_profile() if pedals else JoyRefused(
            'unknown_profile', 'the device names the profile {!r}, which is missing here'.format(
                name))
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
