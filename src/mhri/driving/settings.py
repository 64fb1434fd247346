# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The operator's drive settings: speed limits, common pace, obstacle brake."""
from typing import Any, Dict, List, NamedTuple, Optional, Sequence, Tuple

from mhri.driving.operator_lease import MAX_REFUSED


class Settings(NamedTuple):
    """The fields of ``mhri/DriveSettings``, with the same names; limits in m/s and rad/s."""

    linear_mps: float
    angular_rad_s: float
    together: bool = False
    slow_with_link: bool = False
    brake: bool = False

    @property
    def limits(self) -> Tuple[float, float]:
        """The speed limits [m/s, rad/s]."""
        return self.linear_mps, self.angular_rad_s


def safer(one: Settings, other: Settings) -> Settings:
    """Return the first settings with the lower limits of both, and what makes either safer."""
    return one._replace(linear_mps=min(one.linear_mps, other.linear_mps),
                        angular_rad_s=min(one.angular_rad_s, other.angular_rad_s),
                        slow_with_link=one.slow_with_link or other.slow_with_link,
                        brake=one.brake or other.brake)


def settings_problem(wished: Sequence[Settings]) -> Optional[str]:
    """Return why the settings in a wish cannot be used, or None if they can.

    :param wished: no :class:`Settings` (those in force stay) or one
    """
    if len(wished) > 1:
        return '{} settings: expected one at most'.format(len(wished))
    for one in wished:
        # Far above any robot: only wrong units or garbled messages exceed these.
        for value, most, unit in ((one.linear_mps, 5.0, 'm/s'),
                                  (one.angular_rad_s, 10.0, 'rad/s')):
            if not 0.0 < value <= most:
                return 'speed limit {!r}: expected more than 0, at most {:g} {}'.format(
                    value, most, unit)
    return None


class SettingsInForce:
    """The settings in force, and those of every operator when it was last in control.

    Those in force stay when another operator takes control. One that gets control back finds
    nothing that another has made faster, or less safe, than it had it.
    """

    def __init__(self, in_force: Settings) -> None:
        self.in_force = in_force
        self._own: Dict[str, Settings] = {}
        self._operator = ''

    def on_control(self, operator: str) -> None:
        """Handle that an operator is in control now."""
        if operator != self._operator:
            self._operator = operator
            self.in_force = safer(self.in_force, self._own.get(operator, self.in_force))

    def on_wish(self, operator: str, wished: Sequence[Settings]) -> None:
        """Handle the wish of the operator in control: no :class:`Settings`, or one."""
        self.on_control(operator)
        self.in_force = wished[0] if wished else self.in_force
        self._own[operator] = self.in_force
        if len(self._own) > MAX_REFUSED:
            del self._own[next(iter(self._own))]

    def kept(self) -> List[Any]:
        """Return the state for the next process, as JSON values."""
        return [list(self.in_force),
                [[operator, list(own)] for operator, own in self._own.items()]]

    def restore(self, kept: Sequence[Any]) -> None:
        """Restore the result of :meth:`kept` of the previous process.

        :raises TypeError, ValueError: it is malformed
        """
        in_force, own = kept
        self.in_force = _restored(*in_force)
        self._own = {operator: _restored(*settings) for operator, settings in own}


def _restored(linear_mps: float, angular_rad_s: float, *flags: bool) -> Settings:
    settings = Settings(float(linear_mps), float(angular_rad_s), *map(bool, flags))
    problem = settings_problem([settings])
    if problem:
        raise ValueError(problem)
    return settings
