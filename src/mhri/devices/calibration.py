# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The dialogue that writes a profile for a pad, without screen, device or clock.

The steps are::

    REST      everything released: record the axes at rest       confirm() -> FORWARD
    FORWARD   one stick or trigger pushed and released           -> LEFT
    LEFT      another axis pushed and released                   -> the buttons
    <action>  one button pressed and released, or confirm()      -> the next one, finally DONE

If an input is ambiguous (two axes at once, a button already used), :attr:`Calibration.problem` is
set, and the step is repeated.
"""
import json
import re
from typing import Collection, Dict, FrozenSet, Mapping, Optional, Sequence, Set, Tuple

from mhri.base.names import is_base_name
from mhri.devices.profile import ACTIONS

REST, FORWARD, LEFT, DONE = 'rest', 'forward', 'left', 'done'
_BUTTONS = ('dead_man', 'turbo') + ACTIONS
STEPS = (REST, FORWARD, LEFT) + _BUTTONS + (DONE,)

_PROMPTS = {
    REST: 'Move every stick and trigger once, let go of everything, then press Next.',
    FORWARD: 'Push the stick that should drive FORWARD all the way forward, and let go.',
    LEFT: 'Push the stick that should turn LEFT all the way to the left, and let go.',
    'dead_man': 'Press the button that must be held for anything to move (dead-man button), or '
                'choose None.',
    'turbo': 'Press the button to be held for full speed (half speed without it), or choose None.',
    'stop_all': 'Press the button that stops all robots, or choose None.',
    'next_robot': 'Press the button that selects the next robot, or choose None.',
    'previous_robot': 'Press the button that selects the previous robot, or choose None.',
    'select_all': 'Press the button that selects all robots, or choose None.',
    DONE: 'Done.',
}

# Fractions of an axis' travel: beyond the first it is pushed, within the second released.
_PUSHED = 0.5
_RELEASED = 0.2
# A push is ambiguous if a second axis moved more than this share of the first one's travel.
_ALIKE = 0.8
_DEAD_ZONE = 0.08


def profile_name(device: str, taken: Collection[str] = ()) -> str:
    """Return a profile name for a pad with this name: letters, digits and _.

    :param taken: names already in use
    """
    name = re.sub(r'[^a-z0-9]+', '_', device.lower()).strip('_')
    name = name if is_base_name(name) else 'pad_' + name if name else 'my_pad'
    return 'my_' + name if name in taken else name


class Calibration:
    """One calibration; feed it the states of the pad until :attr:`step` is ``DONE``.

    :param name: of the profile
    :param device: name of the pad
    :param guid: of the pad, or '': then its name identifies it
    """

    def __init__(self, name: str, device: str, guid: str = '') -> None:
        self._name = name
        self._device = device
        self._guid = guid
        self.step = REST
        self.problem = ''
        self._rest: Dict[int, float] = {}
        self._now: Tuple[Optional[float], ...] = ()
        self._stuck: FrozenSet[int] = frozenset()
        self._travel: Dict[int, float] = {}
        self._pressed: Set[int] = set()
        self._down: FrozenSet[int] = frozenset()
        self._axes: Dict[str, int] = {}
        # By step: the entry of the axis in the file, and the button of the action.
        self._entries: Dict[str, Dict[str, float]] = {}
        self._buttons: Dict[str, int] = {}

    @property
    def prompt(self) -> str:
        """The instruction of the present step for the operator."""
        return _PROMPTS[self.step]

    @property
    def axes(self) -> Dict[str, int]:
        """The axes assigned so far: {step: index}."""
        return dict(self._axes)

    @property
    def buttons(self) -> Dict[str, int]:
        """The buttons assigned so far: {step: index}."""
        return dict(self._buttons)

    def confirm(self) -> None:
        """Go on: at REST everything is released; at a button the pad has none for it."""
        if self.step == REST:
            self._confirm_rest()
        elif self.step in _BUTTONS and not self._pressed:
            self._next()

    def _confirm_rest(self) -> None:
        """Record the axes at rest."""
        rest = {index: value for index, value in enumerate(self._now) if value is not None}
        if len(rest) < 2:
            self.problem = 'Fewer than two axes have moved yet.'
            return
        self._rest = rest
        self._stuck = self._down
        self._next()

    def feed(self, axes: Sequence[Optional[float]], buttons: Sequence[int]) -> None:
        """Handle a state of the pad: axes in [-1, 1] or None if unknown, buttons 0 or 1."""
        self._now = tuple(axes)
        self._down = frozenset(index for index, value in enumerate(buttons) if value)
        if self.step in (FORWARD, LEFT):
            self._feed_axes()
        elif self.step in _BUTTONS:
            self._feed_buttons()

    def _feed_axes(self) -> None:
        """Track the axes until one has been pushed and all are released."""
        moved = [(self._fraction(index, value), index) for index, value in enumerate(self._now)
                 if value is not None and index in self._rest]
        for fraction, index in moved:
            if abs(fraction) > abs(self._travel.get(index, 0.0)):
                self._travel[index] = fraction
        order = sorted(self._travel, key=lambda index: -abs(self._travel[index]))
        pushed = order and abs(self._travel[order[0]]) >= _PUSHED
        if not pushed or any(abs(fraction) > _RELEASED for fraction, _ in moved):
            return
        far = abs(self._travel[order[0]])
        if len(order) > 1 and abs(self._travel[order[1]]) > _ALIKE * far:
            self._again('Axes {} and {} moved alike: only one of them, please.'.format(
                *sorted(order[:2])))
        elif order[0] in self._axes.values():
            self._again('That is the axis that drives forward: another one, please.')
        else:
            self._accept_axis(order[0])

    def _fraction(self, index: int, value: float) -> float:
        """Return the distance of an axis from its rest, as a fraction of its travel."""
        rest = self._rest[index]
        return (value - rest) / (1.0 + abs(rest))

    def _accept_axis(self, index: int) -> None:
        travel = self._travel[index]
        rest = self._rest[index]
        # A stick rests at its centre, and the dead zone covers its offset; a trigger rests at its
        # end.
        self._axes[self.step] = index
        entry: Dict[str, float] = {'axis': index}
        if abs(rest) > _PUSHED:
            entry['rest'] = round(rest, 2)
        entry['scale'] = round(max(-2.0, min(2.0, 1.0 / travel)), 2)
        self._entries[self.step] = entry
        self._next()

    def _feed_buttons(self) -> None:
        """Wait until one button has been pressed and released."""
        self._pressed |= self._down - self._stuck
        if not self._pressed or self._down - self._stuck:
            return
        button = min(self._pressed)
        if len(self._pressed) > 1:
            self._again('Buttons {} were pressed together: only one, please.'.format(
                ' and '.join(map(str, sorted(self._pressed)))))
        elif button in self._buttons.values():
            self._again('Button {} has a meaning already: another one, please, or choose '
                        'None.'.format(button))
        else:
            self._buttons[self.step] = button
            self._next()

    def _again(self, problem: str) -> None:
        """Repeat the step."""
        self.problem = problem
        self._travel = {}
        self._pressed = set()

    def _next(self) -> None:
        self._again('')
        self.step = STEPS[STEPS.index(self.step) + 1]

    def text(self) -> str:
        """Return the profile as YAML, once :attr:`step` is ``DONE``."""
        if self.step != DONE:
            raise ValueError('the calibration is at step {}'.format(self.step))
        drift = max((abs(self._rest[self._axes[step]]) for step, entry in self._entries.items()
                     if 'rest' not in entry), default=0.0)
        dead_zone = round(min(0.3, max(_DEAD_ZONE, 2.0 * drift)), 2)
        lines = ['# Written by the page Pad for ' + ' '.join(self._device.split()),
                 'name: ' + self._name,
                 'forward: ' + _flow(self._entries[FORWARD]),
                 'turn: ' + _flow(self._entries[LEFT]),
                 'dead_zone: {}'.format(dead_zone)]
        lines += ['{}_button: {}'.format(action, self._buttons[action])
                  for action in _BUTTONS if action in self._buttons]
        match = 'guids: ["{}"]'.format(self._guid) if self._guid else 'names: [{}]'.format(
            json.dumps(self._device, ensure_ascii=False))
        return '\n'.join(lines + ['match: {' + match + '}', ''])


def _flow(entry: Mapping[str, float]) -> str:
    return '{' + ', '.join('{}: {}'.format(key, value) for key, value in entry.items()) + '}'
