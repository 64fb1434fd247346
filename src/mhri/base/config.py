# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Parses configuration text into validated values; refuses unknown keys by name."""
import re
import reprlib
from numbers import Real
from typing import (
    Any, Callable, Dict, Iterable, List, NoReturn, Optional, Tuple, Type, TypeVar, Union)

import yaml

Default = TypeVar('Default')
Value = TypeVar('Value')

# Limits for a configuration. The shipped ones have at most 2 kB, 300 values and 6 levels.
MAX_BYTES = 250 * 1000
MAX_VALUES, MAX_DEPTH = 10 * 1000, 40
# Words of one unquoted text, each of which costs PyYAML a search; digits of a number or date.
MAX_WORDS, MAX_DIGITS = 50 * 1000, 64
MAX_ERROR = 300
_MAX_KEY, _MAX_ORIGIN = 60, 130
_REQUIRED: Any = object()
_SHORT = reprlib.Repr()
_SHORT.maxstring = _SHORT.maxother = _SHORT.maxlong = 80
_SHORT.maxlevel = 2


def shown(value: object) -> str:
    """Return any value as text for an error: like ``repr``, but at most 600 characters.

    Lists and mappings are cut after a few items, texts and numbers in the middle.
    """
    try:
        return _SHORT.repr(value)
    except ValueError:  # Python does not format numbers of more than 4,300 digits
        return 'a number of too many digits'


def _cut(text: str, most: int, tail: int) -> str:
    """Return a printable text of at most ``most`` characters, with its last ``tail`` kept."""
    if len(text) > 2 * most:  # before the check of each character
        text = text[:most] + text[-most:]
    text = ''.join(char if char.isprintable() else char.encode('unicode_escape').decode('ascii')
                   for char in text)
    if len(text) <= most:
        return text
    return text[:most - tail - 3] + '...' + text[len(text) - tail:]


class ConfigError(ValueError):
    """An unusable configuration value; the text names the file, the key and the remedy.

    :param origin: the file (or parameter namespace) the value came from
    :param key: dotted key inside it, or '' for the whole file
    :param problem: the problem and the remedy, as a sentence without a full stop

    The message is one printable line of at most :data:`MAX_ERROR` characters.
    """

    def __init__(self, origin: str, key: str, problem: str) -> None:
        self.origin = origin
        self.key = key
        self.problem = problem
        place = _cut(str(origin), _MAX_ORIGIN, _MAX_ORIGIN - 3)
        if key:
            place += ': ' + _cut(str(key), _MAX_KEY, 20)
        super().__init__('{}: {}'.format(place, _cut(str(problem), MAX_ERROR - len(place) - 2, 50)))


class Section:
    """One mapping of a configuration, read key by key; :meth:`close` refuses unread keys."""

    def __init__(self, mapping: object, origin: str, path: str = '') -> None:
        if not isinstance(mapping, dict):
            raise ConfigError(origin, path, 'expected a mapping of keys to values, got {}'.format(
                shown(mapping)))
        self.origin = origin
        self._path = path
        self._left = dict(mapping)

    def key(self, name: object) -> str:
        """Return the dotted name of a key, as used in error messages."""
        return '{}.{}'.format(self._path, name) if self._path else str(name)

    def error(self, name: object, problem: str) -> ConfigError:
        """Return (not raise) a :class:`ConfigError` for one key of this section."""
        return ConfigError(self.origin, self.key(name), problem)

    def __contains__(self, name: str) -> bool:
        return self._left.get(name) is not None

    def names(self) -> List[str]:
        """Return the keys that were not read yet, as texts."""
        return [str(name) for name in self._left]

    def take(self, name: str, default: object = _REQUIRED) -> object:
        """Return the raw value of a key; a missing key is an error unless there is a default."""
        value = self._left.pop(name, None)
        if value is not None:
            return value
        if default is _REQUIRED:
            raise self.error(name, 'is missing')
        return default

    def _read(self, name: str, default: Default, kind: Type[Value], expected: str,
              is_right: Callable[[Any], bool] = lambda value: True) -> Union[Value, Default]:
        """Return the value of a key, checked by type and ``is_right``, or the default."""
        value = self.take(name, default)
        if value is default:
            return default
        if isinstance(value, kind) and isinstance(value, bool) == (kind is bool) \
                and is_right(value):
            return value
        raise self.error(name, 'expected {}, got {}'.format(expected, shown(value)))

    def text(self, name: str, default: Default = _REQUIRED) -> Union[str, Default]:
        """Return a string."""
        return self._read(name, default, str, 'text')

    def flag(self, name: str, default: Default = _REQUIRED) -> Union[bool, Default]:
        """Return a boolean."""
        return self._read(name, default, bool, 'true or false')

    def number(self, name: str, low: float, high: float,
               default: Default = _REQUIRED) -> Union[float, Default]:
        """Return a finite float in [low, high]."""
        value: Any = self._read(name, default, Real, 'a number from {:g} to {:g}'.format(low, high),
                                lambda value: low <= value <= high)
        return default if value is default else float(value)

    def index(self, name: str, default: Default = _REQUIRED) -> Union[int, Default]:
        """Return a whole number >= 0 (an axis or a button)."""
        return self._read(name, default, int, 'a whole number from 0 up', lambda value: value >= 0)

    def texts(self, name: str, default: Default = _REQUIRED) -> Union[Tuple[str, ...], Default]:
        """Return a tuple of strings; one string alone counts as a list of one."""
        value: Any = self.take(name, default)
        if value is default:
            return default
        items = [value] if isinstance(value, str) else value
        if not isinstance(items, list) or not all(isinstance(item, str) for item in items):
            raise self.error(name, 'expected a list of texts, got {}'.format(shown(value)))
        return tuple(items)

    def section(self, name: str, default: Default = _REQUIRED) -> Union['Section', Default]:
        """Return a sub-section, or the default if the key is missing."""
        value = self.take(name, default)
        return default if value is default else self.sub_section(name, value)

    def sub_section(self, name: str, value: object) -> 'Section':
        """Return a value taken from a key as a sub-section."""
        return Section(value, self.origin, self.key(name))

    def sections(self, name: str) -> List['Section']:
        """Return the sub-sections of a list of mappings."""
        value = self._read(name, _REQUIRED, list, 'a list')
        return [Section(item, self.origin, '{}[{}]'.format(self.key(name), number))
                for number, item in enumerate(value)]

    def named_sections(self, name: str) -> Dict[str, 'Section']:
        """Return {key: sub-section} of a mapping of mappings; {} if the key is missing."""
        value = self._read(name, {}, dict, 'a mapping')
        return {str(key): Section(item, self.origin, '{}.{}'.format(self.key(name), key))
                for key, item in value.items()}

    def close(self) -> None:
        """Raise an error for unread keys, most often a spelling mistake."""
        if self._left:
            name = sorted(self._left, key=str)[0]
            raise self.error(name, 'unknown key')


class _Loader(yaml.SafeLoader):  # type: ignore[misc]  # mypy does not look into yaml
    """Reads YAML like ``SafeLoader``, but gives up before a text costs much time or memory.

    An alias counts as all the values it refers to: nine nested lists of nine aliases each are 387
    million values in 200 bytes.
    """

    def __init__(self, stream: str) -> None:
        super().__init__(stream)
        self._depth = self._values = self._words = 0
        self._sizes: Dict[str, int] = {}

    def compose_node(self, parent: Optional[yaml.Node], index: object) -> yaml.Node:
        """Count the next value and its nested values."""
        event = self.peek_event()
        alias = isinstance(event, yaml.AliasEvent)
        if alias and event.anchor in self.anchors and event.anchor not in self._sizes:
            self._refuse('*{} stands inside itself'.format(event.anchor), event)
        begun = self._values
        self._values += self._sizes.get(event.anchor, 1) if alias else 1
        self._depth += 1
        if self._values > MAX_VALUES:
            self._refuse('more than {} values, aliases unfolded'.format(MAX_VALUES), event)
        if self._depth > MAX_DEPTH:
            self._refuse('more than {} levels'.format(MAX_DEPTH), event)
        node = super().compose_node(parent, index)
        self._depth -= 1
        if event.anchor is not None and not alias:
            self._sizes[event.anchor] = self._values - begun
        return node

    def construct_object(self, node: yaml.Node, deep: bool = False) -> object:
        """Return the value of a node; an invalid tag is an error in the file."""
        scalar = isinstance(node, yaml.ScalarNode)
        if scalar and len(node.value) > MAX_DIGITS and node.tag in _MEASURED:
            self._refuse('a number or date of {} characters'.format(len(node.value)), node)
        try:
            return super().construct_object(node, deep)
        except (ValueError, LookupError, AttributeError, TypeError, ArithmeticError):
            self._refuse('{} is not a valid {}'.format(
                shown(node.value) if scalar else 'this', node.tag.rpartition(':')[2]), node)

    def scan_plain_spaces(self, indent: int, start_mark: yaml.Mark) -> List[str]:
        """Count the words of unquoted texts."""
        self._words += 1
        if self._words > MAX_WORDS:
            raise yaml.scanner.ScannerError(
                None, None, 'more than {} words'.format(MAX_WORDS), start_mark)
        spaces: List[str] = super().scan_plain_spaces(indent, start_mark)
        return spaces

    def _refuse(self, problem: str, what: Union[yaml.Event, yaml.Node]) -> NoReturn:
        raise yaml.constructor.ConstructorError(None, None, problem, what.start_mark)


class _Dumper(yaml.SafeDumper):  # type: ignore[misc]
    """Writes YAML that :class:`_Loader` reads as it was."""


_INT, _FLOAT = ('tag:yaml.org,2002:' + kind for kind in ('int', 'float'))
# Numbers as in YAML 1.2. By 1.1, which PyYAML reads, 5e-02 is a text, 1_5 is 15, 1:30 is 90 and
# 010 is 8. What begins with more zeros, or has a long exponent, is an identifier.
for _yaml in (_Loader, _Dumper):
    _yaml.yaml_implicit_resolvers = {
        first: [row for row in rows if row[0] not in (_INT, _FLOAT)]
        for first, rows in _yaml.yaml_implicit_resolvers.items()}
    _yaml.add_implicit_resolver(_INT, re.compile(
        r'[-+]?(0|[1-9][0-9]*|0x[0-9a-fA-F]+)\Z'), [*'-+0123456789'])
    _yaml.add_implicit_resolver(_FLOAT, re.compile(
        r'[-+]?((0|[1-9][0-9]*)(\.[0-9]*)?|\.[0-9]+)([eE][-+]?[0-9]{1,3})?\Z'
        r'|[-+]?\.(inf|Inf|INF)\Z|\.(nan|NaN|NAN)\Z'), [*'-+.0123456789'])
# Without it, a line break in a text is one in the YAML.
_Dumper.add_representer(str, lambda dumper, text: dumper.represent_scalar(
    'tag:yaml.org,2002:str', text, None if text.isprintable() else '"'))
_MEASURED = {'tag:yaml.org,2002:' + kind for kind in ('int', 'float', 'timestamp')}


def yaml_value(text: str) -> Any:
    """Return the value of a YAML text of any origin.

    :raises ValueError: it is not YAML, or larger than this module's limits
    """
    if len(text) > MAX_BYTES:
        raise ValueError('more than {} characters'.format(MAX_BYTES))
    try:
        return yaml.load(text, Loader=_Loader)
    except (yaml.YAMLError, RecursionError) as error:
        raise ValueError(' '.join(str(error).split())) from None


def yaml_text(value: object) -> str:
    """Return a value as one line of YAML, which :func:`yaml_value` reads as it was."""
    text: str = yaml.dump(value, Dumper=_Dumper, default_flow_style=True, width=1e9)
    return text.split('\n')[0]


def parse_yaml(text: str, origin: str) -> Section:
    """Return the top section of a YAML text; takes less than a second for any text.

    :raises ConfigError: the text is not YAML, larger than this module's limits, or not a mapping
    """
    if len(text) > MAX_BYTES:
        raise too_large(origin)
    try:
        data = yaml.load(text, Loader=_Loader)
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        raise ConfigError(origin, '', 'is not valid YAML: {}{}'.format(
            'line {}: '.format(mark.line + 1) if mark else '', error.problem or error.context))
    except (yaml.YAMLError, ValueError, RecursionError) as error:
        raise ConfigError(origin, '', 'is not valid YAML: {}'.format(
            ' '.join(str(error).split())))
    return Section(data, origin)


def parse_all(files: Iterable[Tuple[str, str]], parse: Callable[[str, str], Value]
              ) -> Tuple[List[Value], List[ConfigError]]:
    """Parse many texts; an invalid one does not affect the others.

    :param files: pairs (origin, text)
    :param parse: a function of text and origin that raises :class:`ConfigError`
    :returns: ([values], [ConfigError]), in their order
    """
    found: List[Value] = []
    errors: List[ConfigError] = []
    for origin, text in files:
        try:
            found.append(parse(text, origin))
        except ConfigError as error:
            errors.append(error)
    return found, errors


def short(error: Exception) -> str:
    """Return the text of an error as one printable line of at most :data:`MAX_ERROR` characters."""
    return _cut(str(error), MAX_ERROR, MAX_ERROR // 2)


def too_large(origin: str) -> ConfigError:
    """Return (not raise) the :class:`ConfigError` of a file larger than :data:`MAX_BYTES`."""
    return ConfigError(origin, '', 'is larger than {} kB; a configuration of mhri is a few: is '
                       'this the right file?'.format(MAX_BYTES // 1000))
