# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Sources: the rows of ``mux.yaml``, one for each way to drive."""
from dataclasses import dataclass
from typing import Optional, Tuple

from mhri.core.config import parse_yaml
from mhri.core.robots.names import is_base_name, is_global_name
from mhri.core.driving.profile import Profile, parse_profile


@dataclass(frozen=True)
class Source:
    """One way to drive: where its Joy comes from and how it is read.

    ``timeout_s`` is the age at which the last message no longer counts; ``suspend_service`` (type
    ``mhri/SetSuspended``) is called when the mode enters (False) and leaves (True) the source, None
    where there is nothing to suspend.
    """

    name: str
    label: str
    topic: str
    profile: Profile
    timeout_s: float = 0.5
    suspend_service: Optional[str] = None


@dataclass(frozen=True)
class MuxConfig:
    """The content of ``mux.yaml``: the sources in order, the first mode and the first limits.

    ``enabling`` is the source whose first button is a dead-man for whatever drives, None where
    there is none. With ``automatic_switching``, a source that is touched while everything stands
    still becomes the active one.
    """

    sources: Tuple[Source, ...]
    default: str
    linear_mps: float
    angular_rad_s: float
    enabling: Optional[str] = None
    automatic_switching: bool = False


def parse_mux_config(text, origin, read_profile):
    """Return the :class:`MuxConfig` that a YAML text describes.

    :param read_profile: function from a profile's name to (origin, text); may raise OSError
    :raises ConfigError: names the file and the key that is wrong
    """
    section = parse_yaml(text, origin)
    sources = []
    for row in section.sections('sources'):
        source = _source(row, read_profile)
        if any(source.name == other.name for other in sources):
            raise row.error('name', 'source {!r} is there twice'.format(source.name))
        if any(source.topic == other.topic for other in sources):
            raise row.error('topic', '{} feeds two sources'.format(source.topic))
        sources.append(source)
    if not sources:
        raise section.error('sources', 'name at least one source')
    default = section.text('default', sources[0].name)
    if default not in [source.name for source in sources]:
        raise section.error('default', 'no source {!r}'.format(default))
    limits = section.section('speed_limit')
    config = MuxConfig(tuple(sources), default, limits.number('linear_mps', 0.0, 5.0),
                       limits.number('angular_rad_s', 0.0, 10.0),
                       _enabling(section, sources), section.flag('automatic_switching', False))
    limits.close()
    section.close()
    return config


def _enabling(section, sources):
    """Read the name of the enabling source, None where there is none."""
    name = section.text('enabling', None)
    if name is not None and name not in [source.name for source in sources]:
        raise section.error('enabling', 'no source {!r}'.format(name))
    return name


def _source(row, read_profile):
    """Read one row."""
    name = row.text('name')
    if not is_base_name(name):
        raise row.error('name', 'expected a letter, then letters, digits and _, got {!r}'.format(
            name))
    profile_name = row.text('profile')
    try:
        profile = parse_profile(*reversed(read_profile(profile_name)))
    except OSError as error:
        raise row.error('profile', 'cannot read profile {!r}: {}'.format(
            profile_name, error.strerror or error))
    topic, service = row.text('topic'), row.text('suspend_service', None)
    for key, value in (('topic', topic), ('suspend_service', service)):
        if value is not None and not is_global_name(value):
            raise row.error(key, 'expected a name such as /mux_in/joy, got {!r}'.format(value))
    source = Source(name, row.text('label', name), topic, profile,
                    row.number('timeout_s', 0.05, 2.0, 0.5), service)
    row.close()
    return source
