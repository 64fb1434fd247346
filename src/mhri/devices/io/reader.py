# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The interface of every input device to :class:`mhri.devices.ros.input_node.InputNode`."""
from dataclasses import dataclass
from typing import Tuple


class DeviceAbsent(Exception):
    """No device can be opened; the text says what was wanted, and the remedy."""


class DeviceLost(Exception):
    """The open device is gone, or must not be used any longer; the text says why."""


@dataclass(frozen=True)
class Reading:
    """The whole state of a device: what a ``sensor_msgs/Joy`` carries.

    ``axes`` are finite, as the driver gives them; ``buttons`` are 0 or 1. ``profile`` is the name
    of the profile that says what they mean ('' if the source's row says it). ``rest`` are the
    values of the axes while nobody touches the device, () if all of them rest at 0: a trigger rests
    at -1, and at 0 it would be half pressed.
    """

    axes: Tuple[float, ...]
    buttons: Tuple[int, ...] = ()
    profile: str = ''
    rest: Tuple[float, ...] = ()

    def neutral(self):
        """Return the reading of the same device with nothing touched."""
        rest = self.rest + (0.0,) * (len(self.axes) - len(self.rest))
        return Reading(rest[:len(self.axes)], (0,) * len(self.buttons), self.profile, self.rest)


class Reader:
    """A device that is read on one thread: call every method only on that thread.

    ``kind`` is the word for it in messages, e.g. 'pad'; ``name`` is the open device's own name,
    e.g. 'Logitech Gamepad F710'; ``note`` is what the operator should know about it ('': nothing),
    e.g. that it waits for something.
    """

    kind = 'device'
    name = ''
    note = ''

    def find(self):
        """Return the name of the device that :meth:`open` would open, without touching any.

        The node asks every two seconds while it is suspended, so this must cost next to nothing.
        '' if unknown.

        :raises DeviceAbsent: there is none
        """
        return ''

    def there(self):
        """Return the names of all devices that could be opened, () if unknown.

        Asked as often as :meth:`find`, and with each reading.
        """
        return ()

    def open(self):
        """Open the device and return a text that describes it; the next reading is complete.

        :raises DeviceAbsent: there is none, or it cannot be opened
        """
        raise NotImplementedError

    def read(self, timeout_s):
        """Wait for a change.

        :param timeout_s: at most this long [s]; 0.0: only look
        :returns: a :class:`Reading`, or None if nothing changed, or the device's state is not
            known yet
        :raises DeviceLost: it is gone; close and open it again
        """
        raise NotImplementedError

    def close(self):
        """Release the device; does nothing if none is open."""
        raise NotImplementedError


class Remembered:
    """A function called again only when its argument has changed.

    :param function: may raise :class:`DeviceAbsent`, which is remembered, too
    """

    def __init__(self, function):
        self._function = function
        self._asked = None
        self._answer = None

    def __call__(self, *question):
        """Return the answer to a question.

        :raises DeviceAbsent: the function did so
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
