# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What the buttons, sticks and the hat of a pad do with accessories, as its profile says."""
import math
from typing import Any, Collection, List, Mapping, NamedTuple, Optional, Sequence, Tuple

from mhri.base.accessories import OFF, ON
from mhri.base.config import Section, shown

#: the choice of a toggle that is not in force
TOGGLED = 'toggle'
MAX_BINDINGS = 48
# Fraction of the travel at which an axis counts as a button.
_PRESSED = 0.5


class Input(NamedTuple):
    """A button or an axis of a pad, by its number; ``rest`` is the axis' value when let go."""

    button: Optional[int] = None
    axis: Optional[int] = None
    rest: float = 0.0

    def travel(self, axes: Sequence[float], buttons: Sequence[int]) -> float:
        """Return how far it is from rest, in [-1, 1]; an input that is missing is at rest."""
        if self.button is not None:
            return float(self.button < len(buttons) and bool(buttons[self.button]))
        if self.axis is None or self.axis >= len(axes):
            return 0.0
        return max(-1.0, min(1.0, (axes[self.axis] - self.rest) / (1.0 + abs(self.rest))))


class Binding(NamedTuple):
    """One input that acts on one accessory.

    :param key: of the accessory
    :param source: the :class:`Input`
    :param value: of an accessory that is held, at full travel: one or two from -1 to 1; of a
        choice, the direction of the axis
    :param choice: the choice, or :data:`TOGGLED`; None for an accessory that is held
    :param shift: whether it counts while the shift button is held, and only then
    """

    key: str
    source: Input
    value: Tuple[float, ...] = (1.0,)
    choice: Optional[str] = None
    shift: bool = False

    def is_pressed(self, travel: float) -> bool:
        """Return whether its input, so far from rest, counts as a pressed button."""
        return travel * self.value[0] >= _PRESSED


class Layout(NamedTuple):
    """What a profile uses already.

    :param shift: the button that is held for rows with ``shift: true``, None for none
    :param always: {button: meaning} of those that keep it while the shift button is held
    :param plain: {button: meaning} of those that do not
    :param driving: the axes that drive
    """

    shift: Optional[int]
    always: Mapping[int, str]
    plain: Mapping[int, str]
    driving: Collection[int]


def read_bindings(section: Section, layout: Layout) -> Tuple[Binding, ...]:
    """Return the bindings of a profile, from ``accessories``: a row, or several, for each key.

    :raises ConfigError: a row is wrong; the text names file and key
    """
    raw: Any = section.take('accessories', {})
    if not isinstance(raw, dict):
        raise section.error('accessories', 'expected a mapping, got {}'.format(shown(raw)))
    found: List[Binding] = []
    for key, rows in raw.items():
        for row in rows if isinstance(rows, list) else [rows]:
            part = section.sub_section('accessories.{}'.format(key), row)
            bindings = _row(part, str(key))
            for binding in bindings:
                _check(part, binding, layout)
            found += bindings
    if len(found) > MAX_BINDINGS:
        raise section.error('accessories', 'more than {}'.format(MAX_BINDINGS))
    return tuple(found)


def _row(row: Section, key: str) -> List[Binding]:
    """Read one row: one binding, or two for the two axes of a stick."""
    names = [name for name in ('button', 'axis', 'axes') if name in row]
    if len(names) != 1:
        raise row.error(names[1] if names else 'button', 'name one of button, axis and axes')
    held = names[0] != 'button' or 'value' in row
    choice: Any = row.take('choice', None)
    # YAML reads "on" and "off" as true and false.
    choice = {True: ON, False: OFF}[choice] if isinstance(choice, bool) else choice
    if choice is None and not held:
        choice = ''
    elif not (choice is None or isinstance(choice, str)):
        raise row.error('choice', 'expected a word, got {}'.format(shown(choice)))
    shift, rest = row.flag('shift', False), row.number('rest', -1.0, 1.0, 0.0)
    if names[0] == 'axes':
        found = _stick(row, key, choice, shift, rest)
    else:
        number = row.index(names[0])
        source = Input(button=number) if names[0] == 'button' else Input(axis=number, rest=rest)
        found = [Binding(key, source, _value(row, [1.0]), choice, shift)]
    row.close()
    return found


def _stick(row: Section, key: str, choice: Optional[str], shift: bool,
           rest: float) -> List[Binding]:
    """Read the two axes of a stick."""
    axes: Any = row.take('axes')
    if not isinstance(axes, list) or len(axes) != 2 or choice is not None or not all(
            isinstance(axis, int) and not isinstance(axis, bool) and axis >= 0 for axis in axes):
        raise row.error('axes', 'expected two axes of an accessory that is held, such as [2, 3], '
                        'got {}'.format(shown(axes)))
    value = _value(row, [1.0, 1.0])
    if len(value) != 2:
        raise row.error('value', 'expected two numbers, one for each axis')
    return [Binding(key, Input(axis=axes[0], rest=rest), (value[0], 0.0), None, shift),
            Binding(key, Input(axis=axes[1], rest=rest), (0.0, value[1]), None, shift)]


def _value(row: Section, default: List[float]) -> Tuple[float, ...]:
    """Read one or two numbers from -1 to 1."""
    raw: Any = row.take('value', default)
    values = raw if isinstance(raw, list) else [raw]
    if not 1 <= len(values) <= 2 or not any(values) or not all(
            isinstance(one, (int, float)) and not isinstance(one, bool) and math.isfinite(one)
            and abs(one) <= 1.0 for one in values):
        raise row.error('value', 'expected one or two numbers from -1 to 1, not all 0, got '
                        '{}'.format(shown(raw)))
    return tuple(map(float, values))


def _check(row: Section, binding: Binding, layout: Layout) -> None:
    """Refuse a row whose input has another meaning at the same time."""
    button, axis = binding.source.button, binding.source.axis
    if binding.shift and layout.shift is None:
        raise row.error('shift', 'the profile has no shift_button')
    if button is not None:
        meaning = layout.always.get(button) or not binding.shift and layout.plain.get(button)
        if meaning:
            raise row.error('button', 'button {} is {} already'.format(button, meaning))
    if axis in layout.driving and not binding.shift:
        raise row.error('axis', 'axis {} drives; with shift: true it acts while the shift button '
                        'is held'.format(axis))
