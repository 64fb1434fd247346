# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Robot types: the topics, limits and window of each kind of robot, as validated data."""
from dataclasses import dataclass, field, replace
from typing import Dict, Optional, Tuple

from mhri.core.config import ConfigError, Section, parse_yaml

ODOMETRY_TYPES = ('nav_msgs/Odometry', 'turtlesim/Pose')
_TOPIC_KEYS = ('command', 'imu', 'odometry', 'rgb', 'depth', 'scan', 'battery')


@dataclass(frozen=True)
class Limits:
    """The most a robot may be asked for: linear [m/s] and angular [rad/s], both > 0."""

    linear_mps: float
    angular_rad_s: float


@dataclass(frozen=True)
class RobotType:
    """A template: what a robot of this type offers below its namespace.

    Every topic list is relative to the robot's namespace and ordered: the first that exists (for
    ``command``: the first that has a subscriber) is used. An empty list means the robot has none.
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
    scan: Tuple[str, ...] = ()
    battery: Tuple[str, ...] = ()

    def with_model(self, model):
        """Return this type with the limits of one of its models, e.g. ``waffle``.

        Without a model (None), the type keeps the limits of its file, which for a type with models
        are those of the slowest: an unknown robot is never driven faster than it can.

        :raises ConfigError: the type has no such model
        """
        if model is None:
            return self
        if not isinstance(model, str) or model not in self.models:
            raise ConfigError(self.name, 'robot_model', 'no model {!r}; known: {}'.format(
                model, ', '.join(sorted(self.models)) or 'none'))
        return replace(self, model=model, limits=self.models[model],
                       label='{} {}'.format(self.label, model.replace('_', ' ').title()))


def _limits(section):
    """Read ``linear_mps`` and ``angular_rad_s`` of a section."""
    limits = Limits(section.number('linear_mps', 0.001, 50.0),
                    section.number('angular_rad_s', 0.001, 50.0))
    section.close()
    return limits


def parse_robot_type(text, origin):
    """Return the :class:`RobotType` that a YAML text describes.

    :raises ConfigError: names the file and the key that is wrong
    """
    section = parse_yaml(text, origin)
    name = section.text('name')
    odometry_type = _odometry_type(section)
    robot_type = RobotType(
        name=name, label=section.text('label', name), window=section.text('window', 'turtlebot'),
        limits=_limits(section.section('limits')),
        models={key: _limits(item) for key, item in section.named_sections('models').items()},
        odometry_type=odometry_type,
        **{key: _topics(section, key) for key in _TOPIC_KEYS})
    section.close()
    return robot_type


def _odometry_type(section):
    """Read the ROS type of the odometry."""
    kind = section.text('odometry_type', 'nav_msgs/Odometry')
    if kind not in ODOMETRY_TYPES:
        raise section.error('odometry_type', 'expected one of {}, got {!r}'.format(
            ', '.join(ODOMETRY_TYPES), kind))
    return kind


def _topics(section, key):
    """Read a list of topics; only ``command`` may not be empty."""
    topics = section.texts(key, ())
    if key == 'command' and not topics:
        raise section.error('command', 'name at least one velocity topic')
    return topics


def load_robot_types(files):
    """Parse many templates; one bad file never hides the good ones.

    :param files: pairs (origin, text)
    :returns: ({name: RobotType}, [ConfigError]); of two files with one name the first stays
    """
    types, errors = {}, []
    for origin, text in files:
        try:
            robot_type = parse_robot_type(text, origin)
            if robot_type.name in types:
                raise ConfigError(origin, 'name', 'a type {!r} exists already'.format(
                    robot_type.name))
            types[robot_type.name] = robot_type
        except ConfigError as error:
            errors.append(error)
    return types, errors


def resolve_robot_type(types, robot, params):
    """Choose and adjust the template of one robot.

    :param types: {name: RobotType} with at least ``generic``
    :param robot: the robot's name
    :param params: the parameters below its namespace as a nested dict: ``robot_type``,
        ``robot_model`` and, under ``mhri``, any key of a template file to override
    :returns: (RobotType, [ConfigError]); a parameter that cannot be used is reported and left out,
        an unknown type becomes ``generic``
    """
    errors = []
    origin = '/' + robot
    wanted = params.get('robot_type', 'generic')
    chosen = types.get(wanted) if isinstance(wanted, str) else None
    if chosen is None:
        chosen = types['generic']
        errors.append(ConfigError(origin, 'robot_type', 'no template {!r} (known: {}); driven as '
                                  'generic'.format(wanted, ', '.join(sorted(types)))))
    try:
        chosen = chosen.with_model(params.get('robot_model'))
    except ConfigError as error:
        errors.append(ConfigError(origin, 'robot_model', error.problem + '; driven at the slowest'))
    overrides = params.get('mhri')
    if overrides:
        try:
            chosen = _overridden(chosen, overrides, origin)
        except ConfigError as error:
            errors.append(error)
    return chosen, errors


def _overridden(robot_type, overrides, origin):
    """Return the type with the values of a robot's ``mhri`` parameters."""
    section = Section(overrides, origin, 'mhri')
    changes = {key: _topics(section, key) for key in _TOPIC_KEYS if key in section}
    if 'odometry_type' in section:
        changes['odometry_type'] = _odometry_type(section)
    for key in ('label', 'window'):
        if key in section:
            changes[key] = section.text(key)
    if 'limits' in section:
        limits = section.section('limits')
        changes['limits'] = Limits(
            limits.number('linear_mps', 0.001, 50.0, robot_type.limits.linear_mps),
            limits.number('angular_rad_s', 0.001, 50.0, robot_type.limits.angular_rad_s))
        limits.close()
    section.close()
    return replace(robot_type, **changes)
