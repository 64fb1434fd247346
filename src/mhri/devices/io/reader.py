# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The interface of every input device to :class:`mhri.devices.ros.input_node.InputNode`."""
from dataclasses import dataclass
from typing import Tuple


class DeviceAbsent(Exception):
    """No device can be opened; the text has the request and the remedy."""


class DeviceLost(Exception):
    """The open device is gone, or must not be used any longer; the text is the reason."""


@dataclass(frozen=True)
class Reading:
    """The whole state of a device, as in a ``sensor_msgs/Joy``.

    ``axes`` are the finite values of the driver; ``buttons`` are 0 or 1. ``profile`` is the name
    of the profile with their meanings ('' if the source's row has them). ``rest`` are the values of
    the axes of a released device, () if all rest at 0: a trigger rests at -1, and at 0 it would be
    half pressed.
    """

    axes: Tuple[float, ...]
    buttons: Tuple[int, ...] = ()
    profile: str = ''
    rest: Tuple[float, ...] = ()

    def neutral(self):
        """Return the reading of the same device while released."""
        rest = self.rest + (0.0,) * (len(self.axes) - len(self.rest))
        return Reading(rest[:len(self.axes)], (0,) * len(self.buttons), self.profile, self.rest)


class Reader:
    """A device that is read on one thread: call all methods only on that thread.

    ``kind`` is the word for it in messages, e.g. 'pad'; ``name`` is the open device's own name,
    e.g. 'Logitech Gamepad F710'; ``note`` is for the operator or '', e.g. that an axis has to be
    moved once.
    """

    kind = 'device'
    name = ''
    note = ''

    def find(self):
        """Return the name of the device that :meth:`open` would open, without opening any.

        It is called every two seconds while the node is suspended, so it must be cheap. '' if
        unknown.

        :raises DeviceAbsent: no device can be opened
        """
        return ''

    def available(self):
        """Return the names of all devices that could be opened, () if unknown.

        It is called as often as :meth:`find`, and with each reading.
        """
        return ()

    def open(self):
        """Open the device and return a text that describes it; the next reading is complete.

        :raises DeviceAbsent: no device is connected, or it cannot be opened
        """
        raise NotImplementedError

    def read(self, timeout_s):
        """Wait for a change.

        :param timeout_s: maximum time [s]; 0.0: return at once
        :returns: a :class:`Reading`, or None if nothing has changed or the device's state is not
            known yet
        :raises DeviceLost: the device is gone; close and open it again
        """
        raise NotImplementedError

    def close(self):
        """Release the device; does nothing if none is open."""
        raise NotImplementedError


class CachedLookup:
    """A function that is called again only when its argument has changed.

    :param function: may raise :class:`DeviceAbsent`, which is cached, too
    """

    def __init__(self, function):
        self._function = function
        self._asked = None
        self._answer = None

    def __call__(self, *question):
        """Return the result of the function.

        :raises DeviceAbsent: the function raised it
        """
        if question != self._asked:
            try:
                self._answer = self._function(*question), None
            except DeviceAbsent as reason:
                self._answer = None, reason
            self._asked = question
        value, reason = self._answer
        if reason is not None:
            raise DeviceAbsent(str(reason))
        return value
