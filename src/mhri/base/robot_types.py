# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Robot types: the topics, limits and tile of each kind of robot, as validated data."""
import math
import re
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any, Callable, Dict, Iterable, List, Mapping, Optional, Sequence, Tuple

from mhri.base.accessories import Accessory, read_accessories
from mhri.base.config import ConfigError, parse_yaml, Section, shown
from mhri.base.robot_hardware import (
    HardwareStopSpec, MotorPowerSpec, read_hardware_stop, read_motor_power)

ODOMETRY_TYPES = ('nav_msgs/Odometry', 'turtlesim/Pose')
#: units of a battery's charge; '': told by its values (:class:`mhri.base.battery.Charge`)
BATTERY_UNITS = ('', 'fraction', 'percent')
# Default time without odometry after which a robot is silent [s].
SILENT_AFTER_S = 1.0
# Default radius of a robot, which is the clearance that a robot on a task keeps [m].
RADIUS_M = 0.25
_HARDWARE = ('motor_power', 'hardware_stop')
# http://wiki.ros.org/Names, without "~": a robot's topics are never private to our nodes.
_TOPIC = re.compile(r'/?[A-Za-z][A-Za-z0-9_]*(/[A-Za-z0-9_]+)*\Z')
_MAX_LETTERS = 250
#: Ahead of the robot's centre, to the left [m], turned to the left [rad].
LaserPlace = Tuple[float, float, float]
#: {key of a sensor other than odometry: type of its messages}
SENSOR_TYPES = {
    'imu': 'sensor_msgs/Imu', 'rgb': 'sensor_msgs/Image', 'depth': 'sensor_msgs/Image',
    'cloud': 'sensor_msgs/PointCloud2', 'scan': 'sensor_msgs/LaserScan',
    'battery': 'sensor_msgs/BatteryState'}
#: those of them that may be sensor_msgs/CompressedImage below their topic
PICTURE_KEYS = ('rgb', 'depth')
# The keys of a template that list topics.
TOPIC_KEYS = ('command', 'imu', 'odometry', 'rgb', 'depth', 'cloud', 'scan', 'battery')


@dataclass(frozen=True)
class Limits:
    """The maximum speeds of commands to a robot: linear [m/s] and angular [rad/s], both > 0.

    ``holonomic``: it can move sideways; then the linear limit is for any direction.
    """

    linear_mps: float
    angular_rad_s: float
    holonomic: bool = False


def common_limits(limits: Sequence[Limits]) -> Limits:
    """Return the common limits of a group: the lowest of each of their limits."""
    return Limits(min(one.linear_mps for one in limits), min(one.angular_rad_s for one in limits),
                  all(one.holonomic for one in limits))


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
                           problem + '; fix it there and start mhri again')


@dataclass(frozen=True)
class Seen:
    """Properties of a robot derived from the graph, besides its parameters.

    :param at_root: whether it has no namespace; then its topics begin at ``/``
    :param kind: the type recognised by its topics, None if it was not recognised
    :param command: its velocity topic, as in a template; None if it has none, or if several are
        equally likely
    :param instance: prefix of the topics of this robot, e.g. ``/turtle2``, if one node has several
        robots; else None
    :param behind: its velocity topics published by a node that also subscribes velocities, and not
        those of another robot: a multiplexer with its lock
    :param guard_behind: the ones of these that its guard publishes as well
    :param input_of: another robot, whose base its velocity topics command; None if they do not
    """

    at_root: bool = False
    kind: Optional[str] = None
    command: Optional[str] = None
    instance: Optional[str] = None
    behind: Tuple[str, ...] = ()
    guard_behind: Tuple[str, ...] = ()
    input_of: Optional[str] = None

    def anything(self) -> bool:
        """Return whether anything besides its name is known."""
        return bool(self.at_root or self.kind or self.command or self.instance or self.behind
                    or self.input_of)


@dataclass(frozen=True)
class RobotType:
    """A template: the interfaces of a robot of this type in its namespace.

    Every topic list is relative to the robot's namespace (:func:`mhri.base.names.topic_of`)
    and ordered: the first that exists (for ``command``: the first that has a subscriber) is used.
    An empty list means the robot has none. ``window`` is a key of ``mhri.screen.gui.windows`` or,
    in a lab's own package, a class as ``package.module.Class``. ``known_by`` is {topic: ROS type}
    of topics that only robots of this type publish, to recognise robots without a ``robot_type``.
    ``silent_after_s``: a robot is silent after this long without odometry [s]; 0 means that silence
    has no meaning (it sends odometry only in motion). ``motor_power`` and ``hardware_stop`` are
    None if not supported. ``radius_m`` is the radius of the disc that encloses it [m].
    Used without tf: ``laser_x_m`` and ``depth_x_m`` are the distances of laser and depth camera
    ahead of its centre, ``depth_z_m`` is the height of the camera [m], 0 if unknown; ``lasers``
    is the pose of each laser of ``scan``: ahead, to the left [m], turned to the left [rad].
    ``no_return`` is {range_max of a laser [m], None for any other: its values for "no return"}, if
    empty, according to REP 117.
    ``instance`` is the first segment of all its topics if one node may have several such robots,
    each with its own first segment. ``behind`` are the topics of ``command`` behind the robot's own
    multiplexer: zeros may go there, commands may not. ``guard_behind``: whether the guard's output
    goes there. ``accessories`` are its tools and its other sensors. ``found`` are the keys whose
    last topic is not of the type: it was found by its message type
    (:class:`mhri.robots.found_streams.FoundStreams`).
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
    battery_unit: str = ''
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
    accessories: Tuple[Accessory, ...] = ()
    found: Tuple[str, ...] = ()

    @property
    def sensor_types(self) -> Dict[str, str]:
        """{key of each sensor: type of its messages}."""
        return dict(SENSOR_TYPES, odometry=self.odometry_type)

    @property
    def is_behind(self) -> bool:
        """Whether all its velocity topics lie behind the robot's own multiplexer."""
        return bool(self.behind) and set(self.command) <= set(self.behind)

    def laser_place(self, number: int) -> Optional[LaserPlace]:
        """Return the pose of the laser of ``scan[number]`` by its type, None if unknown.

        With several lasers, none is assumed to face forward: with one that faces backward the robot
        would drive into obstacles it sees. Nor is one that was found.
        """
        if 'scan' in self.found and number == len(self.scan) - 1:
            return None
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
        changes['accessories'] = tuple(one.at_root() for one in self.accessories)
        return replace(self, **changes)

    def for_instance(self, place: str) -> 'RobotType':
        """Return this type with the topics of one of several robots.

        :param place: their prefix, e.g. ``/turtle2``
        :raises ValueError: a node can have only one robot of this type
        """
        if self.instance is None:
            raise ValueError('robot type {} has no instance'.format(self.name))
        own = len(self.instance)
        changes: Dict[str, Any] = {
            key: tuple(place + topic[own:] for topic in getattr(self, key)) for key in TOPIC_KEYS}
        changes['accessories'] = tuple(
            one.renamed(lambda name: place + name[own:]) for one in self.accessories)
        return replace(self, **changes)

    def with_model(self, model: object) -> 'RobotType':
        """Return this type with the limits of one of its models, e.g. ``waffle``.

        Without a model (None), the type keeps the limits of its file, which for a type with models
        are those of the slowest: an unknown robot is never driven faster than it can go.

        :raises ConfigError: the type has no such model
        """
        if model is None:
            return self
        if not isinstance(model, str) or model not in self.models:
            raise ConfigError(self.name, 'robot_model', 'no model {!r}; known: {}'.format(
                model, ', '.join(sorted(self.models)) or 'none'))
        return replace(self, model=model, limits=self.models[model],
                       label='{} {}'.format(self.label, model.replace('_', ' ').title()))


def _limits(section: Section, holonomic: bool) -> Limits:
    """Read ``linear_mps`` and ``angular_rad_s`` of a section."""
    limits = Limits(section.number('linear_mps', 0.001, 50.0),
                    section.number('angular_rad_s', 0.001, 50.0), holonomic)
    section.close()
    return limits


def parse_robot_type(text: str, origin: str) -> RobotType:
    """Parse a :class:`RobotType` from a YAML text.

    :raises ConfigError: a key is wrong; the text names it and the file
    """
    section = parse_yaml(text, origin)
    name = section.text('name')
    holonomic = section.flag('holonomic', False)
    robot_type = RobotType(
        name=name, limits=_limits(section.section('limits'), holonomic),
        models={key: _limits(item, holonomic)
                for key, item in section.named_sections('models').items()},
        known_by=_known_by(section), instance=section.text('instance', None),
        **{key: read(section) for key, read in _PARTS.items()})
    robot_type = replace(robot_type, label=robot_type.label or name,
                         lasers=_lasers(section, len(robot_type.scan)))
    _check_instance(section, robot_type)
    section.close()
    return robot_type


def _check_instance(section: Section, robot_type: RobotType) -> None:
    """Refuse an instance that is not the first segment of every topic."""
    if robot_type.instance is None:
        return
    topics = [topic for key in TOPIC_KEYS for topic in getattr(robot_type, key)]
    topics += [name for one in robot_type.accessories for name in one.names]
    for topic in topics + list(robot_type.known_by):
        if topic.partition('/')[0] != robot_type.instance:
            raise section.error('instance', '{} does not begin with {}/'.format(
                topic, robot_type.instance))
    if not robot_type.known_by:
        raise section.error('instance', 'needs known_by, to find the others by')


def _one_of(section: Section, key: str, words: Sequence[str]) -> str:
    """Read one of some words; the first is the default."""
    word = section.text(key, words[0])
    if word not in words:
        raise section.error(key, 'expected one of {}, got {!r}'.format(
            ', '.join(filter(None, words)), word))
    return word


def _silent_after_s(section: Section) -> float:
    """Read how long the odometry may be missing [s], 0 for ever.

    Below 0.3 s, ordinary wireless networks would make a robot silent again and again.
    """
    value = section.number('silent_after_s', 0.0, 60.0, SILENT_AFTER_S)
    if 0.0 < value < 0.3:
        raise section.error('silent_after_s', 'expected 0 (its silence means nothing) or a number '
                            'from 0.3 to 60, got {!r}'.format(value))
    return value


def _lasers(section: Section, count: int) -> Tuple[LaserPlace, ...]:
    """Read the poses of a number of lasers, if given."""
    rows = section.take('lasers', [])
    if not rows and isinstance(rows, list):
        return ()
    if not isinstance(rows, list) or len(rows) != count or not all(map(_is_place, rows)):
        raise section.error('lasers', 'expected where each of the {} topics of scan sits: ahead, '
                            'to the left [m], turned to the left [degrees], such as '
                            '[[0.2, 0, 0], [-0.2, 0, 180]], got {}'.format(count, shown(rows)))
    return tuple((float(x), float(y), math.radians(turn)) for x, y, turn in rows)


def _is_place(row: object) -> bool:
    """Return whether a row is a valid laser pose: two distances [m] and an angle [degrees]."""
    return isinstance(row, list) and len(row) == 3 and all(
        isinstance(value, (int, float)) and not isinstance(value, bool) and abs(value) <= most
        for value, most in zip(row, (10.0, 10.0, 360.0)))


def _no_return(section: Section) -> Dict[Optional[float], Tuple[float, ...]]:
    """Read the ranges that mean "no return": a list, or lists by the laser's range_max [m]."""
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
    """Convert a number or the text of one, as used in parameters; None for anything else."""
    if isinstance(value, bool) or not isinstance(value, (int, float, str)):
        return None
    try:
        return float(value.replace('.nan', 'nan').replace('.inf', 'inf')
                     if isinstance(value, str) else value)
    except (ValueError, OverflowError):
        return None


def is_topic(name: str) -> bool:
    """Return whether a type may list a topic; the names on a master may be anything."""
    return len(name) <= _MAX_LETTERS and _TOPIC.match(name) is not None


def _topics(section: Section, key: str) -> Tuple[str, ...]:
    """Read a list of topics; only ``command`` may not be empty."""
    topics = section.texts(key, ())
    for topic in topics:
        if not is_topic(topic):
            raise section.error(key, 'expected names of topics, e.g. cmd_vel, got {}'.format(
                shown(topic)))
    if key == 'command' and not topics:
        raise section.error('command', 'name at least one velocity topic')
    return topics


def _known_by(section: Section) -> Dict[str, str]:
    """Read {topic: ROS type} of topics that only robots of this type publish."""
    signs = section.take('known_by', {})
    if not isinstance(signs, dict) or not all(
            isinstance(word, str) for item in signs.items() for word in item):
        raise section.error('known_by', 'expected {{topic: type}}, got {!r}'.format(signs))
    return dict(signs)


# Keys of a type's file and of a robot's parameters; each has a default.
_PARTS: Dict[str, Callable[[Section], Any]] = {
    'label': lambda section: section.text('label', ''),
    'window': lambda section: section.text('window', 'turtlebot'),
    'odometry_type': partial(_one_of, key='odometry_type', words=ODOMETRY_TYPES),
    'battery_unit': partial(_one_of, key='battery_unit', words=BATTERY_UNITS),
    'silent_after_s': _silent_after_s,
    # The disc that encloses the robot.
    'radius_m': lambda section: section.number('radius_m', 0.02, 10.0, RADIUS_M),
    # The poses of laser and depth camera on the robot.
    'laser_x_m': lambda section: section.number('laser_x_m', -10.0, 10.0, 0.0),
    'depth_x_m': lambda section: section.number('depth_x_m', -10.0, 10.0, 0.0),
    'depth_z_m': lambda section: section.number('depth_z_m', 0.0, 10.0, 0.0),
    'no_return': _no_return,
    'motor_power': read_motor_power,
    'hardware_stop': read_hardware_stop,
    'accessories': read_accessories,
    **{key: partial(_topics, key=key) for key in TOPIC_KEYS}}


def load_robot_types(
        files: Iterable[Tuple[str, str]],
        exports: Iterable[Export] = ()) -> Tuple[Dict[str, RobotType], List[ConfigError]]:
    """Parse many templates; an invalid file does not affect the others.

    :param files: pairs (origin, text)
    :param exports: :class:`Export` of other packages; they never replace an existing type
    :returns: ({name: RobotType}, [ConfigError]); of two files with the same name the first counts
    """
    types: Dict[str, RobotType] = {}
    errors: List[ConfigError] = []
    own: List[Tuple[str, str, Optional[Export]]] = [(*file, None) for file in files]
    for origin, text, export in own + [(one.origin, one.text, one) for one in exports]:
        try:
            robot_type = parse_robot_type(text, origin)
            if robot_type.name in types:
                raise ConfigError(origin, 'name', 'there is a type {!r} already, choose another '
                                  'name'.format(robot_type.name))
            if export is not None and export.window:
                robot_type = replace(robot_type, window=export.window)
            types[robot_type.name] = robot_type
        except ConfigError as error:
            errors.append(error if export is None else export.error(error.key, error.problem))
    return types, errors


#: key in the error on a robot's own choice of a window
WINDOW_KEY = 'mhri.window'


def resolve_robot_type(types: Mapping[str, RobotType], robot: str, params: Mapping[str, object],
                       seen: Seen = Seen()) -> Tuple[RobotType, List[ConfigError]]:
    """Choose and adjust the template of one robot.

    :param types: {name: RobotType} with at least ``generic``
    :param robot: the robot's name
    :param params: the parameters below its namespace as a nested dict: ``robot_type``,
        ``robot_model`` and, under ``mhri``, any key of a template file to override
    :param seen: :class:`Seen`; a robot driven as ``generic`` gets its real velocity topic
    :returns: (RobotType, [ConfigError]); unusable parameters are reported and left out; an unknown
        type becomes ``generic``
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
            # Showing a window runs its code, so a robot may only choose an installed one.
            if chosen.window not in {one.window for one in types.values()}:
                errors.append(ConfigError(origin, WINDOW_KEY, 'no installed robot type has {!r}; '
                                          'export it from a package'.format(chosen.window[:80])))
                chosen = replace(chosen, window=standard.window)
        except ConfigError as error:
            errors.append(error)
    errors += _behind_error(chosen, origin, seen.input_of)
    return chosen.at_root() if seen.at_root else chosen, errors


def _behind(chosen: RobotType, seen: Seen, overrides: object) -> RobotType:
    """Return a generic type with its topics behind the robot's own multiplexer marked.

    So are all topics of a namespace that only commands another robot, which mhri must not drive
    twice. Topics set by the robot's parameters are not marked: they were chosen deliberately.
    """
    if chosen.name != 'generic':
        return chosen
    named = overrides.get('command') if isinstance(overrides, dict) else None
    known = {one for one in named if isinstance(one, str)} if isinstance(named, list) else set()
    return replace(chosen, guard_behind=bool(set(seen.guard_behind) - known), behind=tuple(
        one for one in chosen.command
        if (seen.input_of or one in seen.behind) and one not in known))


def _behind_error(chosen: RobotType, origin: str, input_of: Optional[str]) -> List[ConfigError]:
    """Return the error if only its own multiplexer may drive it, with the remedy; or []."""
    if not chosen.is_behind:
        return []
    if input_of:
        return [ConfigError(origin, '', 'its velocity goes to the base of {}: '
                            'select that one'.format(input_of))]
    return [ConfigError(origin, 'mhri/command', 'its velocity topic {} is written by a node that '
                        'reads velocity itself, behind whose lock mhri must not drive: set this '
                        'parameter to a topic that this node reads'.format(chosen.behind[0]))]


def _overridden(robot_type: RobotType, overrides: object, origin: str) -> RobotType:
    """Return the type with the values of a robot's ``mhri`` parameters."""
    section = Section(overrides, origin, 'mhri')
    changes: Dict[str, Any] = {
        key: read(section) for key, read in _PARTS.items() if key in section}
    if 'command' in changes:
        changes['behind'] = tuple(one for one in robot_type.behind if one in changes['command'])
    if 'lasers' in section or 'scan' in changes:
        # Other topics mean other lasers.
        changes['lasers'] = _lasers(section, len(changes.get('scan', robot_type.scan)))
    holonomic = section.flag('holonomic', robot_type.limits.holonomic)
    changes['limits'] = replace(robot_type.limits, holonomic=holonomic)
    if 'limits' in section:
        limits = section.section('limits')
        changes['limits'] = Limits(
            limits.number('linear_mps', 0.001, 50.0, robot_type.limits.linear_mps),
            limits.number('angular_rad_s', 0.001, 50.0, robot_type.limits.angular_rad_s),
            holonomic)
        limits.close()
    section.close()
    return replace(robot_type, **changes)
