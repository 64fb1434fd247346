# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Reads the other sensors of a robot: the rows ``readout`` of its type, of any message type."""
from functools import partial
import math

from mhri.base.accessories import READOUT
from mhri.base.plausible import SENSOR, sifted
from mhri.base.views import AccessoryView
from mhri.graph.ros.messages import message_class, MessageMissing, read_field
from mhri.robots.readout import is_number, Readout
from mhri.robots.ros.streams import RobotStreams, StreamRow


# A sensor that was heard within this time is not silent, whatever its robot is [s]; many publish
# only changes.
FRESH_S = 1.0


def _read(field, message, note):
    """Return the number in a field, NaN for an impossible or a missing one."""
    try:
        found = read_field(message, field)
    except AttributeError:  # the array is too short now
        return math.nan
    (number,), problem = sifted((SENSOR,), (float(found) if is_number(found) else math.nan,))
    if problem:
        note(problem)
    return number


def _stream_row(spec):
    """Return the :class:`StreamRow` of a readout."""
    def of(name, robot_type):
        (field,) = spec.fields
        try:
            kind = message_class(spec.type)
        except MessageMissing:
            if not spec.optional:
                raise
            return (), None
        array, _, element = field.partition('[')
        try:
            found = read_field(kind(), array)
        except AttributeError:
            found = None
        # The elements of an array are known once it has some.
        if not (isinstance(found, (bytes, list)) if element else is_number(found)):
            raise MessageMissing('{} has no number {!r}'.format(spec.type, field))
        return [spec.name], kind, partial(_read, field)
    return StreamRow(spec.key, of)


class Readouts:
    """The accessories of a robot as its own messages show them: its readouts are filled in.

    :param name: the robot
    :param robot_type: :class:`mhri.base.robot_types.RobotType`
    :param clock: function that returns monotonic seconds
    """

    def __init__(self, name, robot_type, clock):
        self._clock = clock
        self._specs = robot_type.accessories
        self._rows = {spec.key: _stream_row(spec) for spec in self._specs if spec.kind == READOUT}
        self._readouts = {spec.key: Readout(spec) for spec in self._specs if spec.key in self._rows}
        self._streams = RobotStreams(name, robot_type, self._rows.values(), clock, {
            row: partial(self._on_message, key) for key, row in self._rows.items()})

    def open(self):
        """Subscribe them (blocking: it asks the master)."""
        self._streams.open(*self._rows.values())

    def _on_message(self, key, newest):
        if newest.value is not None:
            self._readouts[key].on_value(newest.value, newest.at_s)

    def views(self, silent=''):
        """Return an :class:`AccessoryView` for each accessory of the robot.

        What is optional is left out until a node publishes it.

        :param silent: why nothing is heard from the robot, '' if it is
        """
        views = (self._view(spec, silent) if spec.key in self._rows else AccessoryView(spec)
                 for spec in self._specs)
        return tuple(view for view in views if not self._lacks(view))

    def _lacks(self, view):
        """Return whether the robot does not have a sensor that is optional."""
        row = self._rows.get(view.spec.key)
        return row is not None and view.spec.optional and not view.known \
            and not self._streams[row].connections()

    def _view(self, spec, silent):
        row = self._rows[spec.key]
        value = self._readouts[spec.key].value(self._clock())
        stands = self._streams.problem(row)
        if not stands and not self._streams[row].connections():
            stands = 'no node publishes it as {}'.format(spec.type)
        elif not stands and not value:
            stands = 'nothing received yet'
        elif not stands and self._streams[row].value(FRESH_S) is None:
            stands = silent
        return AccessoryView(spec, bool(value), value=value, stands=stands)

    def close(self):
        """Unregister all of them (blocking: it asks the master)."""
        self._streams.close()
