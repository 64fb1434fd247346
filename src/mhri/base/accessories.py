# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Accessories of a robot type: lamps, grippers, flippers, heads and other sensors, as data.

``accessories`` of a type's file is a mapping of keys to rows. A row names a kind, a topic, service
or action with its type, and what a stop does to it; see :class:`Accessory`. Any installed message
type serves, by its fields.
"""
from dataclasses import dataclass, replace
import math
import re
from typing import (
    Any, Callable, Dict, Iterable, List, NamedTuple, Optional, Sequence, Tuple, Union)

from mhri.base.config import Section, shown
from mhri.base.robot_hardware import AtRoot, FIELD, matching, NAME, TYPE, Value

# Kinds: done once; on or off; held; proportional in one or two directions; one of several; a
# sensor.
TAP, TOGGLE, HOLD, AXIS, AXIS2, CHOICE, READOUT = KINDS = (
    'tap', 'toggle', 'hold', 'axis', 'axis2', 'choice', 'readout')
#: {kind: number of its values} of kinds that act while they are held
HELD = {HOLD: 1, AXIS: 1, AXIS2: 2}
TOPIC, SERVICE, ACTION = WAYS = ('topic', 'service', 'action')
# What a value means: a rate, for which a neutral value stops; or a position, for which it would
# move it.
RATE, POSITION = MODES = ('rate', 'position')
# What a stop does: send the neutral value, or the position last reported, where there is one;
# cancel the goal; or nothing, e.g. to a lamp, which works under a stop as well.
STOP, CANCEL, KEEP = ENDS = ('stop', 'cancel', 'keep')
# Which robots it acts on: those that are selected, or the one looked at.
SELECTED, LOOKED_AT = PLACES = ('selected', 'looked_at')
ON, OFF = 'on', 'off'
#: the key of the accessory that turns the camera
HEAD = 'head'
MAX_ACCESSORIES = 16
MAX_CHOICES = 12
MAX_ELEMENTS = 32
MAX_WORDS = 4
#: the words of the spoken commands of ``resource/voice/english.yaml``: no accessory has one
COMMAND_WORDS = frozenset(
    'a ahead all and back backward bit controller deselect drive end everything faster foot '
    'forward go joystick left little mark move no none nothing number only pedal please record '
    'recording right robot robots select slower start stop tablet the this turn use virtual '
    'voice'.split())
_WORDS = re.compile(r"[a-z][a-z']*( [a-z][a-z']*)*\Z")
_KEY = re.compile(r'[a-z][a-z0-9_]{0,23}\Z')
_MAX_LABEL, _MAX_BITS = 24, 32
# {ROS type: its usual fields for one and for two values}
_FIELDS = {'geometry_msgs/Vector3': ('x', 'y'), 'geometry_msgs/Point': ('x', 'y')}
_RATE_HZ = 10.0
# A head turned by less than this share of its range looks ahead.
_AHEAD = 0.02

#: what a field is set to; an array at once
Set = Union[Value, Tuple[Union[int, float], ...]]


class Act(NamedTuple):
    """What an accessory is to do.

    :param key: of the accessory
    :param choice: the choice of a tap, a toggle or a choice; '' for values
    :param value: the values of an accessory that is held, in its own units; () for a choice
    :param ends: whether it ends the motion: sent first, never dropped
    """

    key: str
    choice: str = ''
    value: Tuple[float, ...] = ()
    ends: bool = False


#: The act that cancels the goal of an action.
CANCELLED = 'cancel'


@dataclass(frozen=True)
class Feedback(AtRoot):
    """Where an accessory reports its state.

    :param name: the topic, relative to the robot's namespace
    :param kind: its ROS type
    :param fields: the fields of its message with the values
    """

    kind: str = 'std_msgs/Bool'
    fields: Tuple[str, ...] = ('data',)


@dataclass(frozen=True)
class Accessory(AtRoot):
    """One accessory of a robot type.

    :param name: topic, service or action, relative to the robot's namespace
    :param key: its name in the type's file
    :param kind: one of :data:`KINDS`
    :param way: one of :data:`WAYS`
    :param type: ROS type of the message, service or action
    :param label: its word on the screen
    :param icon: name of an icon, '' for none
    :param fields: fields of the message that hold the values of a held kind, and of a readout
    :param choices: pairs (choice, pairs (field, value)) of a tap, a toggle and a choice
    :param ranges: the lowest and the highest value, for each value of a held kind
    :param neutral: the values that stop a held kind in mode ``rate``
    :param rate_hz: how often a held value is repeated [Hz]
    :param mode: one of :data:`MODES`
    :param on_stop: one of :data:`ENDS`
    :param of: one of :data:`PLACES`
    :param team: whether one action counts for several robots
    :param state: where it reports its state, None if it does not
    :param unit: unit of a readout
    :param warn_below: a readout below this warns; None: never
    :param warn_above: a readout above this warns; None: never
    :param bits: names of the bits of a readout, the lowest first; () for an ordinary number
    :param optional: not every robot of the type has it: hidden while no node listens or sends
    :param words: phrases that a voice says for it; None: its label; (): none
    """

    key: str = ''
    kind: str = TAP
    way: str = TOPIC
    type: str = 'std_msgs/Bool'
    label: str = ''
    icon: str = ''
    fields: Tuple[str, ...] = ('data',)
    choices: Tuple[Tuple[str, Tuple[Tuple[str, Set], ...]], ...] = ()
    ranges: Tuple[Tuple[float, float], ...] = ()
    neutral: Tuple[float, ...] = ()
    rate_hz: float = _RATE_HZ
    mode: str = RATE
    on_stop: str = STOP
    of: str = SELECTED
    team: bool = False
    state: Optional[Feedback] = None
    unit: str = ''
    warn_below: Optional[float] = None
    warn_above: Optional[float] = None
    bits: Tuple[str, ...] = ()
    optional: bool = False
    words: Optional[Tuple[str, ...]] = None

    @property
    def names(self) -> Tuple[str, ...]:
        """The names on the graph, relative to the robot's namespace."""
        return (self.name,) if self.state is None else (self.name, self.state.name)

    def renamed(self, rename: Callable[[str], str]) -> 'Accessory':
        """Return it with all its names changed."""
        return replace(self, name=rename(self.name), state=self.state and replace(
            self.state, name=rename(self.state.name)))

    def at_root(self) -> 'Accessory':
        """Return it with absolute names, for a robot without a namespace."""
        return self.renamed(lambda name: '/' + name.lstrip('/'))

    @property
    def moves(self) -> bool:
        """Whether it is a moving part: a stop ends it."""
        return self.kind != READOUT and self.on_stop != KEEP

    @property
    def is_spoken(self) -> bool:
        """Whether a voice may use it.

        It starts no motion that only another word would end, unless the row has ``words``.
        """
        if self.kind in (*HELD, READOUT) or self.words is not None:
            return bool(self.words)
        return self.kind == TAP or self.on_stop == KEEP

    def problem(self, choice: str, value: Sequence[float]) -> str:
        """Return why an act is impossible for this accessory, '' if it is possible."""
        if self.kind == READOUT:
            return '{} is a sensor: it has no action'.format(self.key)
        if self.kind in HELD:
            count = HELD[self.kind]
            if choice or len(value) != count or not all(-1.0 <= one <= 1.0 for one in value):
                return '{} takes {} from -1 to 1'.format(
                    self.key, 'one value' if count == 1 else 'two values')
        elif value or choice not in dict(self.choices):
            return '{}: no choice {!r}, it has {}'.format(
                self.key, choice[:40], ', '.join(word for word, _ in self.choices) or 'none')
        return ''

    def scaled(self, value: Sequence[float]) -> Tuple[float, ...]:
        """Return fractions in [-1, 1] as values in its own units: 0 is the neutral value."""
        return tuple(
            rest + share * ((high - rest) if share > 0.0 else (rest - low))
            for share, rest, (low, high) in zip(value, self.neutral, self.ranges))

    def reading(self, value: float) -> str:
        """Return the value of a readout as text: with its unit, or the names of its bits.

        NaN, infinite values and no bits are a dash.
        """
        finite = math.isfinite(value)
        if self.bits:
            return ', '.join(name for place, name in enumerate(self.bits)
                             if finite and int(value) >> place & 1) or '–'
        return '{} {}'.format('{:.4g}'.format(value) if finite else '–', self.unit).rstrip()

    def is_at_rest(self, value: Sequence[float]) -> bool:
        """Return whether reported values are the neutral ones, but for 2 % of the range."""
        return len(value) == len(self.neutral) and all(
            abs(one - rest) <= _AHEAD * (high - low)
            for one, rest, (low, high) in zip(value, self.neutral, self.ranges))

    def warns(self, value: float) -> bool:
        """Return whether the value of a readout is beyond its limits; NaN is not."""
        return (self.warn_above is not None and value > self.warn_above
                or self.warn_below is not None and value < self.warn_below)


def looks_ahead(accessories: Iterable[Any]) -> bool:
    """Return whether the camera looks ahead: no head, or one reported to be at its neutral place.

    :param accessories: of a robot, each with ``spec`` and ``value``
    """
    return all(one.spec.is_at_rest(one.value) for one in accessories if one.spec.key == HEAD)


def read_accessories(section: Section) -> Tuple[Accessory, ...]:
    """Return the :class:`Accessory` rows at ``accessories``, in their order.

    :raises ConfigError: a row is wrong; the text names file and key
    """
    rows = section.named_sections('accessories')
    if len(rows) > MAX_ACCESSORIES:
        raise section.error('accessories', '{} rows, {} at most'.format(
            len(rows), MAX_ACCESSORIES))
    return tuple(_read(section, key, row) for key, row in rows.items())


def _read(section: Section, key: str, row: Section) -> Accessory:
    """Read one row."""
    if not _KEY.match(key):
        raise section.error('accessories', 'the key {} is not a word of lower case letters, digits '
                            'and _, at most 24'.format(shown(key)))
    kind = _one_of(row, 'kind', KINDS)
    ways = [way for way in WAYS if way in row]
    if len(ways) != 1:
        raise row.error(ways[1] if ways else 'topic', 'name one of topic, service and action')
    way = ways[0]
    if way != TOPIC and kind in (*HELD, READOUT):
        raise row.error(way, 'a {} needs a topic'.format(kind))
    found = Accessory(
        name=matching(row, way, NAME), key=key, kind=kind, way=way,
        type=matching(row, 'type', TYPE, 'std_msgs/Bool'),
        label=row.text('label', key.replace('_', ' '))[:_MAX_LABEL], icon=row.text('icon', ''),
        of=_one_of(row, 'of', PLACES, SELECTED), team=row.flag('team', False),
        on_stop=_on_stop(row, kind, way), optional=row.flag('optional', False),
        words=_words(row, kind))
    found = replace(found, state=_report(row, found), **_OF_KIND[kind](row, found))
    row.close()
    return found


def _one_of(row: Section, key: str, known: Sequence[str], default: Optional[str] = None) -> str:
    """Read one of some words."""
    word = row.text(key) if default is None else row.text(key, default)
    if word not in known:
        raise row.error(key, 'expected one of {}, got {}'.format(', '.join(known), shown(word)))
    return word


def _on_stop(row: Section, kind: str, way: str) -> str:
    """Read what a stop does; a moving part must say it, as nobody else knows."""
    if kind == READOUT:
        return KEEP
    word = _one_of(row, 'on_stop', ENDS)
    if word == CANCEL and way != ACTION:
        raise row.error('on_stop', 'only an action can be cancelled')
    if word == STOP and way == ACTION:
        raise row.error('on_stop', 'an action is ended by cancel')
    return word


def _words(row: Section, kind: str) -> Optional[Tuple[str, ...]]:
    """Read what a voice says for it."""
    phrases = row.texts('words', None)
    if phrases and kind in (*HELD, READOUT):
        raise row.error('words', 'a {} is not for a voice: use tap, toggle or choice'.format(kind))
    if len(phrases or ()) > MAX_WORDS:
        raise row.error('words', '{} phrases, {} at most'.format(len(phrases or ()), MAX_WORDS))
    for phrase in phrases or ():
        if len(phrase) > _MAX_LABEL or not _WORDS.match(phrase):
            raise row.error('words', 'expected lower-case words with one space between them, at '
                            'most {} letters, got {}'.format(_MAX_LABEL, shown(phrase)))
        taken = [word for word in phrase.split() if word in COMMAND_WORDS]
        if taken:
            raise row.error('words', '{}: "{}" is a word of other spoken commands'.format(
                shown(phrase), taken[0]))
    return phrases


def _names_of_fields(row: Section, key: str, kind: str, count: int) -> Tuple[str, ...]:
    """Read the fields that hold some values."""
    usual = _FIELDS.get(kind, ('data',))[:count]
    names = row.texts(key, usual)
    if len(names) != count or not all(FIELD.match(name) for name in names):
        raise row.error(key, 'expected {} of {}, got {}'.format(
            'one field' if count == 1 else '{} fields'.format(count), kind, shown(list(names))))
    return names


def _report(row: Section, accessory: Accessory) -> Optional[Feedback]:
    """Read where the accessory reports its state."""
    if 'state' not in row:
        return None
    count = HELD.get(accessory.kind, 1)
    kind = matching(row, 'state_type', TYPE, accessory.type if accessory.way == TOPIC
                    else 'std_msgs/Bool')
    return Feedback(matching(row, 'state', NAME), kind,
                    _names_of_fields(row, 'state_fields', kind, count))


def _choices(row: Section, accessory: Accessory) -> Dict[str, Any]:
    """Read {choice: {field: value}} of a tap, a toggle or a choice."""
    raw = row.take('choices', None)
    if raw is None:
        if accessory.kind == CHOICE:
            raise row.error('choices', 'is missing')
        raw = {'': {}} if accessory.kind == TAP else {ON: {'data': True}, OFF: {'data': False}}
        if accessory.kind == TOGGLE and accessory.way != TOPIC:
            raise row.error('choices', 'is missing: what is sent for on and for off?')
    if not isinstance(raw, dict) or not 1 <= len(raw) <= MAX_CHOICES or not all(
            isinstance(fields, dict) for fields in raw.values()):
        raise row.error('choices', 'expected up to {} rows such as {{open: {{data: 1}}}}, got {}'
                        .format(MAX_CHOICES, shown(raw)))
    # YAML reads "on" and "off" as true and false.
    found = {{True: ON, False: OFF}.get(word, word) if isinstance(word, bool) else word: fields
             for word, fields in raw.items()}
    if not all(isinstance(word, str) and (_KEY.match(word) or not word and len(found) == 1)
               for word in found):
        raise row.error('choices', 'expected words of lower case letters, digits and _, got '
                        '{}'.format(shown(list(found))))
    if accessory.kind == TOGGLE and set(found) != {ON, OFF}:
        raise row.error('choices', 'a toggle has the choices on and off')
    for word, fields in found.items():
        for name, value in fields.items():
            if not (isinstance(name, str) and FIELD.match(name)) \
                    or not isinstance(value, (bool, int, float, str)) and not _is_array(value):
                raise row.error('choices', '{}: expected fields with a number, text, true, false '
                                'or a list of numbers, got {}'.format(
                                    word or 'tap', shown(fields)))
    return {'choices': tuple((word, tuple(
        (name, tuple(value) if isinstance(value, list) else value)
        for name, value in fields.items())) for word, fields in found.items())}


def _held(row: Section, accessory: Accessory) -> Dict[str, Any]:
    """Read range, neutral value, rate and mode of a held kind."""
    count = HELD[accessory.kind]
    mode = _one_of(row, 'mode', MODES, RATE)
    ranges = _numbers(row, 'range', 2, [-1.0, 1.0], count)
    neutral = tuple(one[0] for one in _numbers(row, 'neutral', 1, [0.0], count))
    for rest, (low, high) in zip(neutral, ranges):
        if not low <= rest <= high or low == high:
            raise row.error('neutral', 'expected a value within the range {:g} to {:g}, got '
                            '{:g}'.format(low, high, rest))
    return {'mode': mode, 'ranges': ranges, 'neutral': neutral,
            'rate_hz': row.number('rate_hz', 1.0, 50.0, _RATE_HZ),
            'fields': _names_of_fields(row, 'fields', accessory.type, count)}


def _numbers(row: Section, key: str, size: int, default: List[float],
             count: int) -> Tuple[Tuple[float, ...], ...]:
    """Read a group of numbers for each of some values; one group counts for all."""
    raw: Any = row.take(key, default)
    groups = [[raw] if isinstance(raw, (int, float)) else raw]
    if isinstance(raw, list) and raw and all(isinstance(one, list) for one in raw):
        groups = raw
    elif size == 1 and isinstance(raw, list) and len(raw) == count:
        groups = [[one] for one in raw]
    groups = groups * count if len(groups) == 1 else groups
    if len(groups) != count or not all(
            isinstance(group, list) and len(group) == size and all(map(_is_number, group))
            and sorted(group) == group for group in groups):
        raise row.error(key, 'expected {}, got {}'.format(
            'a number' if size == 1 else 'the lowest and the highest value, such as [-1, 1]',
            shown(raw)))
    return tuple(tuple(float(one) for one in group) for group in groups)


def _is_array(value: object) -> bool:
    return isinstance(value, list) and len(value) <= MAX_ELEMENTS and all(map(_is_number, value))


def _is_number(value: object) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool) and abs(value) <= 1e6


def _readout(row: Section, accessory: Accessory) -> Dict[str, Any]:
    """Read field, unit and limits of a sensor."""
    above = row.number('warn', -1e12, 1e12, None)
    above = row.number('warn_above', -1e12, 1e12, above)
    bits = row.texts('bits', ())
    if len(bits) > _MAX_BITS:
        raise row.error('bits', '{} names, {} at most'.format(len(bits), _MAX_BITS))
    return {'fields': (matching(row, 'field', FIELD, 'data'),), 'unit': row.text('unit', '')[:12],
            'bits': tuple(name[:_MAX_LABEL] for name in bits),
            'warn_above': above, 'warn_below': row.number('warn_below', -1e12, 1e12, None)}


_OF_KIND: Dict[str, Callable[[Section, Accessory], Dict[str, Any]]] = {
    TAP: _choices, TOGGLE: _choices, CHOICE: _choices, HOLD: _held, AXIS: _held, AXIS2: _held,
    READOUT: _readout}
