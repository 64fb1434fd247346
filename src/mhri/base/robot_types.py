# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Robot types: the topics, limits and tile of each kind of robot, as validated data."""
import math
import re
from dataclasses import dataclass, field, replace
from typing import Any, Callable, Dict, Iterable, List, Mapping, Optional, Tuple

from mhri.base.config import ConfigError, parse_yaml, Section, shown
from mhri.base.robot_hardware import (
    HardwareStopSpec, MotorPowerSpec, read_hardware_stop, read_motor_power)

ODOMETRY_TYPES = ('nav_msgs/Odometry', 'turtlesim/Pose')
# Unless its type says otherwise, a robot is silent after this long without odometry [s].
SILENT_AFTER_S = 1.0
# And so large is one whose type does not say it: a robot on a task keeps that much room [m].
RADIUS_M = 0.25
_HARDWARE: Dict[str, Callable[[Section], Any]] = {
    'motor_power': read_motor_power, 'hardware_stop': read_hardware_stop}
# http://wiki.ros.org/Names, without "~": no topic of a robot is private to us.
_TOPIC = re.compile(r'/?[A-Za-z][A-Za-z0-9_]*(/[A-Za-z0-9_]+)*\Z')
_MOST_LETTERS = 250
#: Ahead of the robot's middle, to the left [m], turned to the left [rad].
LaserPlace = Tuple[float, float, float]
# The keys of a template that list topics.
TOPIC_KEYS = ('command', 'imu', 'odometry', 'rgb', 'depth', 'cloud', 'scan', 'battery')


@dataclass(frozen=True)
class Limits:
    """The highest speeds a robot may be asked for: linear [m/s] and angular [rad/s], both > 0."""

    linear_mps: float
    angular_rad_s: float


@dataclass(frozen=True)
class Export:
    """A template that another package exports in its package.xml.

    :param package: its name
    :param origin: the file of the template
    :param text: its content
    :param window: the class of its tile as ``package.module.Class``, '' for none
    """

    package: str
    origin: str
    text: str
    window: str = ''

    def error(self, key: str, problem: str) -> ConfigError:
        """Return (not raise) a :class:`ConfigError` that names package, file and remedy."""
        return ConfigError('package {}: {}'.format(self.package, self.origin), key,
                           problem + '; mend it there and start mhri again')


@dataclass(frozen=True)
class Seen:
    """What the graph says about a robot, besides its parameters.

    :param at_root: it has no namespace; its topics begin at ``/``
    :param kind: the type recognised by its topics, None if it was not recognised
    :param command: its velocity topic, as in a template; None if there is none, or if several are
        equally likely
    :param instance: where the topics of this robot begin, e.g. ``/turtle2``, if one node has
        several robots; else None
    :param behind: its velocity topics that a node of its own writes which reads velocity itself: a
        multiplexer with its lock
    :param guard_behind: those of them that its guard writes as well
    """

    at_root: bool = False
    kind: Optional[str] = None
    command: Optional[str] = None
    instance: Optional[str] = None
    behind: Tuple[str, ...] = ()
    guard_behind: Tuple[str, ...] = ()

    def anything(self) -> bool:
        """Tell whether anything but its name is known."""
        return bool(self.at_root or self.kind or self.command or self.instance or self.behind)


@dataclass(frozen=True)
class RobotType:
    """A template: what a robot of this type offers below its namespace.

    Every topic list is relative to the robot's namespace (:func:`mhri.base.names.topic_of`)
    and ordered: the first that exists (for ``command``: the first that has a subscriber) is used.
    An empty list means the robot has none. ``window`` is a key of ``mhri.screen.gui.windows`` or,
    in a lab's own package, a class as ``package.module.Class``. ``known_by`` is {topic: ROS type}
    of topics that only robots of this type publish, to recognise robots without a ``robot_type``.
    ``silent_after_s``: a robot is silent after this long without odometry [s]; 0 means that silence
    says nothing (it sends odometry only in motion). ``motor_power`` and ``hardware_stop`` are None
    if there is no such thing. ``radius_m`` is the radius of the disc around all of it [m].
    Where tf does not say it, ``laser_x_m`` and ``depth_x_m`` are how far ahead of its middle laser
    and depth camera sit, ``depth_z_m`` how high the camera sits [m], 0: nobody knows; ``lasers``
    is where each laser of ``scan`` sits: ahead, to the left [m], turned to the left [rad].
    ``no_return`` is {range_max of a laser [m], None for any other: values by which it says "nothing
    there"}, empty: as REP 117 says.
    ``instance`` is the first segment of all its topics if one node may
    have several such robots, each with its own first segment. ``behind`` are those of ``command``
    that lie behind the robot's own multiplexer: a zero may go there, no command.
    ``guard_behind``: what its guard passes on goes there.
    """

    name: str
    label: str
    window: str
    limits: Limits
    models: Dict[str, Limits] = field(default_factory=dict)
    model: Optional[str] = None
    command: Tuple[str, ...] = ()
    imu: Tuple[str, ...] = ()
    odometry: Tuple[str, ...] = ()
    odometry_type: str = 'nav_msgs/Odometry'
    rgb: Tuple[str, ...] = ()
    depth: Tuple[str, ...] = ()
    cloud: Tuple[str, ...] = ()
    scan: Tuple[str, ...] = ()
    battery: Tuple[str, ...] = ()
    known_by: Dict[str, str] = field(default_factory=dict)
    silent_after_s: float = SILENT_AFTER_S
    radius_m: float = RADIUS_M
    laser_x_m: float = 0.0
    lasers: Tuple[LaserPlace, ...] = ()
    depth_x_m: float = 0.0
    depth_z_m: float = 0.0
    no_return: Dict[Optional[float], Tuple[float, ...]] = field(default_factory=dict)
    motor_power: Optional[MotorPowerSpec] = None
    hardware_stop: Optional[HardwareStopSpec] = None
    instance: Optional[str] = None
    behind: Tuple[str, ...] = ()
    guard_behind: bool = False

    @property
    def is_behind(self) -> bool:
        """Whether all its velocity topics lie behind the robot's own multiplexer."""
        return bool(self.behind) and set(self.command) <= set(self.behind)

    def laser_place(self, number: int) -> Optional[LaserPlace]:
        """Return where the laser of ``scan[number]`` sits by its type, None: unknown.

        Of several lasers none is taken to look ahead: one that looks back would have the robot
        drive into what it sees.
        """
        if self.lasers:
            return self.lasers[number]
        return (self.laser_x_m, 0.0, 0.0) if len(self.scan) == 1 else None

    def at_root(self) -> 'RobotType':
        """Return this type with absolute topics, for a robot without a namespace."""
        changes: Dict[str, Any] = {
            key: tuple('/' + topic.lstrip('/') for topic in getattr(self, key))
            for key in TOPIC_KEYS + ('behind',)}
        changes.update((key, getattr(self, key).at_root()) for key in _HARDWARE
                       if getattr(self, key))
        return replace(self, **changes)

    def for_instance(self, place: str) -> 'RobotType':
        """Return this type with the topics of one of several robots.

        :param place: where they begin, e.g. ``/turtle2``
        :raises ValueError: a node can have only one robot of this type
        """
        if self.instance is None:
            raise ValueError('robot type {} has no instance'.format(self.name))
        own = len(self.instance)
        changes: Dict[str, Any] = {
            key: tuple(place + topic[own:] for topic in getattr(self, key)) for key in TOPIC_KEYS}
        return replace(self, **changes)

    def with_model(self, model: object) -> 'RobotType':
        """Return this type with the limits of one of its models, e.g. ``waffle``.

        Without a model (None), the type keeps the limits of its file, which for a type with models
        are those of the slowest: never drive an unknown robot faster than it can go.

        :raises ConfigError: the type has no such model
        """
        if model is None:
            return self
        if not isinstance(model, str) or model not in self.models:
            raise ConfigError(self.name, 'robot_model', 'no model {!r}; known: {}'.format(
                model, ', '.join(sorted(self.models)) or 'none'))
        return replace(self, model=model, limits=self.models[model],
                       label='{} {}'.format(self.label, model.replace('_', ' ').title()))


def _limits(section: Section) -> Limits:
    """Read ``linear_mps`` and ``angular_rad_s`` of a section."""
    limits = Limits(section.number('linear_mps', 0.001, 50.0),
                    section.number('angular_rad_s', 0.001, 50.0))
    section.close()
    return limits


def parse_robot_type(text: str, origin: str) -> RobotType:
    """Return the :class:`RobotType` that a YAML text describes.

    :raises ConfigError: names the file and the wrong key
    """
    section = parse_yaml(text, origin)
    name = section.text('name')
    odometry_type = _odometry_type(section)
    robot_type = RobotType(
        name=name, label=section.text('label', name), window=section.text('window', 'turtlebot'),
        limits=_limits(section.section('limits')),
        models={key: _limits(item) for key, item in section.named_sections('models').items()},
        odometry_type=odometry_type, known_by=_known_by(section),
        silent_after_s=_silent_after_s(section), radius_m=_radius_m(section),
        **_places(section), no_return=_no_return(section),
        **{key: read(section) for key, read in _HARDWARE.items()},
        instance=section.text('instance', None), **_all_topics(section))
    robot_type = replace(robot_type, lasers=_lasers(section, len(robot_type.scan)))
    _check_instance(section, robot_type)
    section.close()
    return robot_type


def _check_instance(section: Section, robot_type: RobotType) -> None:
    """Refuse an instance that is not the first segment of everything."""
    if robot_type.instance is None:
        return
    topics = [topic for key in TOPIC_KEYS for topic in getattr(robot_type, key)]
    for topic in topics + list(robot_type.known_by):
        if topic.partition('/')[0] != robot_type.instance:
            raise section.error('instance', '{} does not begin with {}/'.format(
                topic, robot_type.instance))
    if not robot_type.known_by:
        raise section.error('instance', 'needs known_by, to find the others by')


def _odometry_type(section: Section) -> str:
    """Read the ROS type of the odometry."""
    kind = section.text('odometry_type', 'nav_msgs/Odometry')
    if kind not in ODOMETRY_TYPES:
        raise section.error('odometry_type', 'expected one of {}, got {!r}'.format(
            ', '.join(ODOMETRY_TYPES), kind))
    return kind


def _silent_after_s(section: Section) -> float:
    """Read how long the odometry may be missing [s]; 0: for ever.

    Below 0.3 s, ordinary wireless networks would make a robot silent again and again.
    """
    value = section.number('silent_after_s', 0.0, 60.0, SILENT_AFTER_S)
    if 0.0 < value < 0.3:
        raise section.error('silent_after_s', 'expected 0 (its silence means nothing) or a number '
                            'from 0.3 to 60, got {!r}'.format(value))
    return value


def _radius_m(section: Section) -> float:
    """Read the radius of the disc around all of the robot."""
    return section.number('radius_m', 0.02, 10.0, RADIUS_M)


def _places(section: Section) -> Dict[str, Any]:
    """Read where laser and depth camera sit on the robot, as far as that is given."""
    rows = ('laser_x_m', -10.0), ('depth_x_m', -10.0), ('depth_z_m', 0.0)
    return {key: section.number(key, least, 10.0) for key, least in rows if key in section}


def _lasers(section: Section, count: int) -> Tuple[LaserPlace, ...]:
    """Read where each of so many lasers sits, as far as that is given."""
    rows = section.take('lasers', [])
    if not rows and isinstance(rows, list):
        return ()
    if not isinstance(rows, list) or len(rows) != count or not all(map(_is_place, rows)):
        raise section.error('lasers', 'expected where each of the {} topics of scan sits: ahead, '
                            'to the left [m], turned to the left [degrees], such as '
                            '[[0.2, 0, 0], [-0.2, 0, 180]], got {}'.format(count, shown(rows)))
    return tuple((float(x), float(y), math.radians(turn)) for x, y, turn in rows)


def _is_place(row: object) -> bool:
    """Tell whether this is where a laser may sit: two distances [m] and an angle [degrees]."""
    return isinstance(row, list) and len(row) == 3 and all(
        isinstance(value, (int, float)) and not isinstance(value, bool) and abs(value) <= most
        for value, most in zip(row, (10.0, 10.0, 360.0)))


def _no_return(section: Section) -> Dict[Optional[float], Tuple[float, ...]]:
    """Read which ranges mean "nothing there": a list, or lists by the laser's range_max [m]."""
    rows = section.take('no_return', {})
    if isinstance(rows, list):
        rows = {None: rows}
    found: Dict[Optional[float], Tuple[float, ...]] = {}
    for reach, values in rows.items() if isinstance(rows, dict) else [(None, None)]:
        reach_m = None if reach is None else _as_number(reach)
        numbers = [_as_number(value) for value in values] if isinstance(values, list) else [None]
        if None in numbers or reach is not None and not (reach_m and 0.0 < reach_m < math.inf):
            raise section.error('no_return', 'expected a list such as [.nan, .inf], or one for '
                                'each range_max, such as {{3.5: [0.0, .inf]}}, got {}'.format(
                                    shown(rows)))
        found[reach_m] = tuple(number for number in numbers if number is not None)
    return found


def _as_number(value: object) -> Optional[float]:
    """Return a number, or the text of one, as parameters have it; None for anything else."""
    if isinstance(value, bool) or not isinstance(value, (int, float, str)):
        return None
    try:
        return float(value.replace('.nan', 'nan').replace('.inf', 'inf')
                     if isinstance(value, str) else value)
    except (ValueError, OverflowError):
        return None


def _topics(section: Section, key: str) -> Tuple[str, ...]:
    """Read a list of topics; only ``command`` may not be empty."""
    topics = section.texts(key, ())
    for topic in topics:
        if len(topic) > _MOST_LETTERS or not _TOPIC.match(topic):
            raise section.error(key, 'expected names of topics, e.g. cmd_vel, got {}'.format(
                shown(topic)))
    if key == 'command' and not topics:
        raise section.error('command', 'name at least one velocity topic')
    return topics


def _all_topics(section: Section) -> Dict[str, Any]:
    """Read every list of topics, by its key."""
    return {key: _topics(section, key) for key in TOPIC_KEYS}


def _known_by(section: Section) -> Dict[str, str]:
    """Read {topic: ROS type} of topics that only robots of this type publish."""
    signs = section.take('known_by', {})
    if not isinstance(signs, dict) or not all(
            isinstance(word, str) for item in signs.items() for word in item):
        raise section.error('known_by', 'expected {{topic: type}}, got {!r}'.format(signs))
    return dict(signs)


def load_robot_types(
        files: Iterable[Tuple[str, str]],
        exports: Iterable[Export] = ()) -> Tuple[Dict[str, RobotType], List[ConfigError]]:
    """Parse many templates; one bad file never hides the good ones.

    :param files: pairs (origin, text)
    :param exports: :class:`Export` of other packages; they never replace an existing type
    :returns: ({name: RobotType}, [ConfigError]); of two files with the same name the first counts
    """
    types: Dict[str, RobotType] = {}
    errors: List[ConfigError] = []
    for origin, text in files:
        try:
            robot_type = parse_robot_type(text, origin)
            if robot_type.name in types:
                raise ConfigError(origin, 'name', 'a type {!r} exists already'.format(
                    robot_type.name))
            types[robot_type.name] = robot_type
        except ConfigError as error:
            errors.append(error)
    for export in exports:
        try:
            robot_type = parse_robot_type(export.text, export.origin)
            if robot_type.name in types:
                raise ConfigError(export.origin, 'name', 'there is a type {!r} already, choose '
                                  'another name'.format(robot_type.name))
            types[robot_type.name] = replace(robot_type,
                                             window=export.window or robot_type.window)
        except ConfigError as error:
            errors.append(export.error(error.key, error.problem))
    return types, errors


#: what the error of a robot's own choice of a window is called
WINDOW_KEY = 'mhri.window'


def resolve_robot_type(types: Mapping[str, RobotType], robot: str, params: Mapping[str, object],
                       seen: Seen = Seen()) -> Tuple[RobotType, List[ConfigError]]:
    """Choose and adjust the template of one robot.

    :param types: {name: RobotType} with at least ``generic``
    :param robot: the robot's name
    :param params: the parameters below its namespace as a nested dict: ``robot_type``,
        ``robot_model`` and, under ``mhri``, any key of a template file to override
    :param seen: :class:`Seen`; a robot driven as ``generic`` gets its real velocity topic
    :returns: (RobotType, [ConfigError]); parameters that cannot be used are reported and left out;
        an unknown type becomes ``generic``
    """
    errors: List[ConfigError] = []
    origin = '/' + robot
    wanted = params.get('robot_type', seen.kind or 'generic')
    chosen = types.get(wanted) if isinstance(wanted, str) else None
    if chosen is None:
        chosen = types['generic']
        errors.append(ConfigError(origin, 'robot_type', 'no template {!r} (known: {}); driven as '
                                  'generic'.format(wanted, ', '.join(sorted(types)))))
    try:
        chosen = chosen.with_model(params.get('robot_model'))
    except ConfigError as error:
        errors.append(ConfigError(origin, 'robot_model', error.problem + '; driven at the slowest'))
    if chosen.name == 'generic' and seen.command and seen.command not in chosen.command:
        chosen = replace(chosen, command=(seen.command,) + chosen.command)
    if seen.instance and chosen.instance:
        chosen = chosen.for_instance(seen.instance)
    overrides = params.get('mhri')
    chosen = _behind(chosen, seen, overrides)
    if overrides:
        try:
            chosen, standard = _overridden(chosen, overrides, origin), chosen
            # To show a window is to run its code: a robot may only choose among those installed.
            if chosen.window not in {one.window for one in types.values()}:
                errors.append(ConfigError(origin, WINDOW_KEY, 'no installed robot type has {!r}; '
                                          'export it from a package'.format(chosen.window[:80])))
                chosen = replace(chosen, window=standard.window)
        except ConfigError as error:
            errors.append(error)
    errors += _behind_error(chosen, origin)
    return chosen.at_root() if seen.at_root else chosen, errors


def _behind(chosen: RobotType, seen: Seen, overrides: object) -> RobotType:
    """Return a generic type that knows which of its topics lie behind the robot's own multiplexer.

    What its own parameters name does not: whoever names it knows what is before it.
    """
    if chosen.name != 'generic':
        return chosen
    named = overrides.get('command') if isinstance(overrides, dict) else None
    known = {one for one in named if isinstance(one, str)} if isinstance(named, list) else set()
    return replace(chosen, guard_behind=bool(set(seen.guard_behind) - known), behind=tuple(
        one for one in chosen.command if one in seen.behind and one not in known))


def _behind_error(chosen: RobotType, origin: str) -> List[ConfigError]:
    """Return that only its own multiplexer may drive a robot, with the remedy; [] otherwise."""
    if not chosen.is_behind:
        return []
    return [ConfigError(origin, 'mhri/command', 'its velocity topic {} is written by a node of its '
                        'own, behind whose lock mhri must not drive: set this parameter to a topic '
                        'that this node reads'.format(chosen.behind[0]))]


def _overridden(robot_type: RobotType, overrides: object, origin: str) -> RobotType:
    """Return the type with the values of a robot's ``mhri`` parameters."""
    section = Section(overrides, origin, 'mhri')
    changes: Dict[str, Any] = {
        key: _topics(section, key) for key in TOPIC_KEYS if key in section}
    if 'command' in changes:
        changes['behind'] = tuple(one for one in robot_type.behind if one in changes['command'])
    if 'odometry_type' in section:
        changes['odometry_type'] = _odometry_type(section)
    changes.update((key, read(section)) for key, read in _HARDWARE.items() if key in section)
    if 'silent_after_s' in section:
        changes['silent_after_s'] = _silent_after_s(section)
    if 'radius_m' in section:
        changes['radius_m'] = _radius_m(section)
    changes.update(_places(section))
    if 'lasers' in section or 'scan' in changes:
        # Other topics are other lasers.
        changes['lasers'] = _lasers(section, len(changes.get('scan', robot_type.scan)))
    if 'no_return' in section:
        changes['no_return'] = _no_return(section)
    changes.update((key, section.text(key)) for key in ('label', 'window') if key in section)
    if 'limits' in section:
        limits = section.section('limits')
        changes['limits'] = Limits(
            limits.number('linear_mps', 0.001, 50.0, robot_type.limits.linear_mps),
            limits.number('angular_rad_s', 0.001, 50.0, robot_type.limits.angular_rad_s))
        limits.close()
    section.close()
    return replace(robot_type, **changes)
