# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Sources: the rows of ``mux.yaml``, one for each input device or publisher."""
from dataclasses import dataclass, replace
from typing import Callable, List, Optional, Sequence, Tuple

from mhri.base.config import parse_yaml, Section
from mhri.base.names import is_base_name, is_global_name
from mhri.devices.profile import parse_profile, Profile


# Maps a profile's name to (origin, text).
ReadProfile = Callable[[str], Tuple[str, str]]

JOY, TWIST = 'joy', 'twist'
# Maximum length of a label on the screen.
LONGEST_LABEL = 60


@dataclass(frozen=True)
class Source:
    """One source of commands: its topic and how to read its messages.

    ``profile`` is None for a source of type ``twist``. ``timeout_s`` is the age [s] at which the
    last message no longer counts. ``suspend_service`` (type ``mhri/SetSuspended``) is called when
    the source becomes active (False) and inactive (True); None if there is nothing to suspend.
    With ``holds``, the source sends changes only.
    """

    name: str
    label: str
    topic: str
    profile: Optional[Profile]
    timeout_s: float = 0.5
    suspend_service: Optional[str] = None
    kind: str = JOY
    holds: bool = False

    @property
    def rests(self) -> bool:
        """Whether it may be silent at rest; it then counts as fresh while its publisher is there.

        Publishers of velocities often send one zero and nothing more.
        """
        return self.holds or self.kind == TWIST


@dataclass(frozen=True)
class MuxConfig:
    """The content of ``mux.yaml``: the sources in order, the first mode and the first limits.

    ``enabling`` is the source whose first button is a dead-man switch for all sources, None for
    none. With ``automatic_switching``, a source that is touched while everything stands still
    becomes the active one. With ``dead_man``, the dead-man buttons of profiles count.
    """

    sources: Tuple[Source, ...]
    default: str
    linear_mps: float
    angular_rad_s: float
    enabling: Optional[str] = None
    automatic_switching: bool = False
    dead_man: bool = True

    def without_dead_man(self) -> 'MuxConfig':
        """Return the same configuration without dead-man buttons."""
        return replace(self, dead_man=False, sources=tuple(
            source if source.profile is None else
            replace(source, profile=source.profile.without_dead_man())
            for source in self.sources))


def parse_mux_config(text: str, origin: str, read_profile: ReadProfile) -> MuxConfig:
    """Parse a :class:`MuxConfig` from a YAML text.

    :param read_profile: maps a profile's name to (origin, text); may raise OSError
    :raises ConfigError: names the file and the wrong key
    """
    section = parse_yaml(text, origin)
    sources: List[Source] = []
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
    config = MuxConfig(tuple(sources), default, limits.number('linear_mps', 0.01, 5.0),
                       limits.number('angular_rad_s', 0.01, 10.0),
                       _enabling(section, sources), section.flag('automatic_switching', False))
    dead_man = section.flag('dead_man', True)
    limits.close()
    section.close()
    return config if dead_man else config.without_dead_man()


def _enabling(section: Section, sources: Sequence[Source]) -> Optional[str]:
    """Read the name of the enabling source, None for none."""
    name = section.text('enabling', None)
    problem = enabling_problem(sources, name)
    if problem:
        raise section.error('enabling', problem)
    return name


def enabling_problem(sources: Sequence[Source], name: Optional[str]) -> Optional[str]:
    """Return why a source cannot be the enabling one; None if it can, or if none is named."""
    source = next((source for source in sources if source.name == name), None)
    if name and source is None:
        return 'no source {!r}'.format(name)
    if source is not None and source.kind == TWIST:
        return 'source {!r} is of type twist and has no button to press'.format(name)
    return None


def _source(row: Section, read_profile: ReadProfile) -> Source:
    """Read one row."""
    name = row.text('name')
    if not is_base_name(name):
        raise row.error('name', 'expected a letter, then letters, digits and _, got {!r}'.format(
            name))
    kind = row.text('type', JOY)
    if kind not in (JOY, TWIST):
        raise row.error('type', 'expected joy or twist, got {!r}'.format(kind))
    profile = _profile(row, read_profile) if kind == JOY else None
    topic, service = row.text('topic'), row.text('suspend_service', None)
    for key, value in (('topic', topic), ('suspend_service', service)):
        if value is not None and not is_global_name(value):
            raise row.error(key, 'expected a name such as /mux_in/joy, got {!r}'.format(value))
    label = row.text('label', name)
    if len(label) > LONGEST_LABEL:
        raise row.error('label', 'has {} characters; at most {} can be shown'.format(
            len(label), LONGEST_LABEL))
    holds = row.flag('holds', False)
    # A held value also expires: joy_node publishes nothing when its pad is unplugged.
    timeout_s = row.number('timeout_s', 0.05, 60.0 if holds else 2.0, 5.0 if holds else 0.5)
    # Obsolete, since every source is exclusive now; older files may contain it.
    row.flag('exclusive', True)
    source = Source(name, label, topic, profile, timeout_s, service, kind, holds)
    row.close()
    return source


def _profile(row: Section, read_profile: ReadProfile) -> Profile:
    """Read the profile that a row of type joy names."""
    profile_name = row.text('profile')
    try:
        origin, text = read_profile(profile_name)
    except OSError as error:
        raise row.error('profile', 'cannot read profile {!r}: {}'.format(
            profile_name, error.strerror or error))
    return parse_profile(text, origin)
