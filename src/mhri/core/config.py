# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Configuration text turned into checked values: unknown keys are refused by name."""
import yaml

_REQUIRED = object()


class ConfigError(ValueError):
    """A configuration value that cannot be used; names the file, the key and the remedy.

    :param origin: the file (or parameter namespace) the value came from
    :param key: dotted key inside it, or '' for the whole file
    :param problem: what is wrong and what would be right, as a sentence without a full stop
    """

    def __init__(self, origin, key, problem):
        self.origin = origin
        self.key = key
        self.problem = problem
        place = '{}: {}'.format(origin, key) if key else str(origin)
        super().__init__('{}: {}'.format(place, problem))


class Section:
    """One mapping of a configuration, read key by key; :meth:`close` refuses what was not read."""

    def __init__(self, mapping, origin, path=''):
        if not isinstance(mapping, dict):
            raise ConfigError(origin, path, 'expected a mapping of keys to values, got {!r}'.format(
                mapping))
        self.origin = origin
        self._path = path
        self._left = dict(mapping)

    def key(self, name):
        """Return the dotted name of a key, as it is written in error messages."""
        return '{}.{}'.format(self._path, name) if self._path else name

    def error(self, name, problem):
        """Return (not raise) a :class:`ConfigError` for one key of this section."""
        return ConfigError(self.origin, self.key(name), problem)

    def __contains__(self, name):
        return self._left.get(name) is not None

    def take(self, name, default=_REQUIRED):
        """Return the raw value of a key; a missing one is an error unless there is a default."""
        value = self._left.pop(name, None)
        if value is not None:
            return value
        if default is _REQUIRED:
            raise self.error(name, 'is missing')
        return default

    def text(self, name, default=_REQUIRED):
        """Return a string."""
        value = self.take(name, default)
        if value is not default and not isinstance(value, str):
            raise self.error(name, 'expected text, got {!r}'.format(value))
        return value

    def flag(self, name, default=_REQUIRED):
        """Return a boolean."""
        value = self.take(name, default)
        if value is not default and not isinstance(value, bool):
            raise self.error(name, 'expected true or false, got {!r}'.format(value))
        return value

    def number(self, name, low, high, default=_REQUIRED):
        """Return a finite float in [low, high]."""
        value = self.take(name, default)
        if value is default:
            return value
        good = isinstance(value, (int, float)) and not isinstance(value, bool)
        if not good or not low <= value <= high:
            raise self.error(name, 'expected a number from {:g} to {:g}, got {!r}'.format(
                low, high, value))
        return float(value)

    def index(self, name, default=_REQUIRED):
        """Return a whole number >= 0 (an axis or a button)."""
        value = self.take(name, default)
        if value is default:
            return value
        if not isinstance(value, int) or isinstance(value, bool) or value < 0:
            raise self.error(name, 'expected a whole number from 0 up, got {!r}'.format(value))
        return value

    def texts(self, name, default=_REQUIRED):
        """Return a tuple of strings; one string alone counts as a list of one."""
        value = self.take(name, default)
        if value is default:
            return value
        if isinstance(value, str):
            value = [value]
        if not isinstance(value, list) or not all(isinstance(item, str) for item in value):
            raise self.error(name, 'expected a list of texts, got {!r}'.format(value))
        return tuple(value)

    def section(self, name, default=_REQUIRED):
        """Return a sub-section, or the default where the key is missing."""
        value = self.take(name, default)
        if value is default:
            return value
        return self.sub_section(name, value)

    def sub_section(self, name, value):
        """Return a value that was taken from a key as a sub-section."""
        return Section(value, self.origin, self.key(name))

    def sections(self, name):
        """Return the sub-sections of a list of mappings."""
        value = self.take(name)
        if not isinstance(value, list):
            raise self.error(name, 'expected a list, got {!r}'.format(value))
        return [Section(item, self.origin, '{}[{}]'.format(self.key(name), number))
                for number, item in enumerate(value)]

    def named_sections(self, name):
        """Return {key: sub-section} of a mapping of mappings; {} where the key is missing."""
        value = self.take(name, {})
        if not isinstance(value, dict):
            raise self.error(name, 'expected a mapping, got {!r}'.format(value))
        return {str(key): Section(item, self.origin, '{}.{}'.format(self.key(name), key))
                for key, item in value.items()}

    def close(self):
        """Raise for the keys that nothing asked for: most often a spelling mistake."""
        if self._left:
            name = sorted(self._left, key=str)[0]
            raise self.error(name, 'unknown key')


def parse_yaml(text, origin):
    """Return the top section of a YAML text.

    :raises ConfigError: the text is not YAML, or not a mapping
    """
    try:
        return Section(yaml.safe_load(text), origin)
    except (yaml.YAMLError, ValueError, RecursionError) as error:
        raise ConfigError(origin, '', 'is not valid YAML: {}'.format(
            ' '.join(str(error).split())))
