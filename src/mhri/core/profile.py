# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Profiles: which axis and button of a device means what."""
import math
from dataclasses import dataclass
from typing import Optional

from mhri.core.config import parse_yaml


class JoyRefused(ValueError):
    """A Joy message that cannot be used; ``kind`` is the word it is counted under."""

    def __init__(self, kind, problem):
        self.kind = kind
        super().__init__(problem)


@dataclass(frozen=True)
class Axis:
    """One axis of a device: its index and the sign that makes forward and left positive."""

    index: int
    scale: float

    def read(self, axes):
        """Return the value in [-1, 1]; a driver's overshoot is cut off."""
        return max(-1.0, min(1.0, axes[self.index] * self.scale))


@dataclass(frozen=True)
class Stick:
    """What the operator asks for, as fractions of the speed limits.

    ``forward`` and ``turn`` (left +) are in [-1, 1] and already zero while the dead-man button is
    released; ``neutral`` tells whether the stick itself rests; ``held`` whether the dead-man button
    (if the profile names one) is pressed.
    """

    forward: float
    turn: float
    neutral: bool
    held: bool = True

    def is_zero(self):
        """Tell whether nothing is asked for."""
        return self.forward == 0.0 and self.turn == 0.0


@dataclass(frozen=True)
class Profile:
    """The mapping of one device, read from ``resource/pads/<name>.yaml``.

    ``dead_zone`` is the fraction of travel around the centre that counts as zero (the rest is
    stretched, so that full travel stays full speed); ``neutral`` the fraction inside which the
    stick counts as released for the interlock.
    """

    name: str
    forward: Axis
    turn: Axis
    dead_zone: float = 0.0
    neutral: float = 0.02
    dead_man: Optional[int] = None

    def read(self, axes, buttons):
        """Turn the axes and buttons of a ``sensor_msgs/Joy`` into a :class:`Stick`.

        :raises JoyRefused: no axes, too few axes or buttons, NaN or infinity anywhere
        """
        if not axes:
            raise JoyRefused('no_axes', 'a Joy message without axes')
        if not all(math.isfinite(value) for value in axes):
            raise JoyRefused('not_finite', 'a Joy message with NaN or infinity in its axes')
        needed = max(self.forward.index, self.turn.index) + 1
        if len(axes) < needed:
            raise JoyRefused('too_few_axes', 'a Joy message with {} axes; profile {} needs '
                             '{}'.format(len(axes), self.name, needed))
        if self.dead_man is not None and len(buttons) <= self.dead_man:
            raise JoyRefused('too_few_buttons', 'a Joy message with {} buttons; the dead-man '
                             'button of profile {} is number {}'.format(
                                 len(buttons), self.name, self.dead_man))
        forward, turn = self.forward.read(axes), self.turn.read(axes)
        held = self.dead_man is None or bool(buttons[self.dead_man])
        neutral = max(abs(forward), abs(turn)) <= self.neutral
        if not held:
            return Stick(0.0, 0.0, neutral, False)
        return Stick(self._stretch(forward), self._stretch(turn), neutral)

    def _stretch(self, value):
        """Take the dead zone out of one axis."""
        size = abs(value)
        if size <= self.dead_zone:
            return 0.0
        return math.copysign((size - self.dead_zone) / (1.0 - self.dead_zone), value)


def _axis(section):
    """Read ``{axis: 1, scale: -1}``."""
    axis = Axis(section.index('axis'), section.number('scale', -10.0, 10.0, 1.0))
    if axis.scale == 0.0:
        raise section.error('scale', 'must not be 0: the axis would do nothing')
    section.close()
    return axis


def parse_profile(text, origin):
    """Return the :class:`Profile` that a YAML text describes.

    :raises ConfigError: names the file and the key that is wrong
    """
    section = parse_yaml(text, origin)
    dead_zone = section.number('dead_zone', 0.0, 0.9, 0.0)
    profile = Profile(
        name=section.text('name'),
        forward=_axis(section.section('forward')),
        turn=_axis(section.section('turn')),
        dead_zone=dead_zone,
        neutral=section.number('neutral', 0.0, 0.9, max(0.02, dead_zone)),
        dead_man=section.index('dead_man_button', None))
    section.close()
    return profile
