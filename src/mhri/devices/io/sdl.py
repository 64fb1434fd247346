# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Joysticks by SDL, through pygame 1.9.6 (SDL 1.2) and 2.x (SDL 2).

The kernel knows what pygame does not say: a joystick's name, GUID and port by the file that SDL
opens for it, and the value of an axis that SDL has not reported yet. Without a file (a virtual
joystick) an axis is known from its first event on.
"""
from dataclasses import replace
import os
import re
import select
import time

import evdev
from evdev import ecodes

from mhri.devices.io.event_nodes import pad_at
from mhri.devices.io.reader import DeviceAbsent, DeviceLost
from mhri.devices.pads import PadInfo

# Polling period of a pad without a file to wait for (a virtual one) [s].
POLL_S = 0.004
_DEVICE_FILE = re.compile(r'/dev/input/')

ENVIRONMENT = {
    'SDL_VIDEODRIVER': 'dummy',                   # events without a window
    'SDL_JOYSTICK_ALLOW_BACKGROUND_EVENTS': '1',  # no window can have the focus
    'SDL_NO_SIGNAL_HANDLERS': '1',                # rospy handles SIGTERM and Ctrl-C
    'PYGAME_HIDE_SUPPORT_PROMPT': '1',
    # Use only the kernel's drivers: SDL's own drivers number the axes and buttons of a pad
    # differently in each version, and always keep its file open.
    'SDL_JOYSTICK_HIDAPI': '0',
}


def device_files():
    """Return {file descriptor: path} of the input devices that this process has open."""
    found = {}
    for name in os.listdir('/proc/self/fd'):
        try:
            path = os.readlink('/proc/self/fd/' + name)
        except OSError:  # the folder's own descriptor, already closed
            continue
        if _DEVICE_FILE.match(path):
            found[int(name)] = path
    return found


class Joysticks:
    """The joysticks of this computer; all calls on one thread.

    SDL is started by the first :meth:`look` and stays loaded: with closed pads it costs nothing.
    """

    def __init__(self):
        self._pygame = None
        # None while it may have changed.
        self._listed = None

    def _start(self):
        """Start SDL.

        :raises DeviceAbsent: pygame is missing, or SDL does not start
        """
        for name, value in ENVIRONMENT.items():
            os.environ.setdefault(name, value)
        # Override it in any case: with a real driver SDL would need a display.
        os.environ['SDL_VIDEODRIVER'] = 'dummy'
        try:
            import pygame
        except ImportError as error:
            raise DeviceAbsent('pygame cannot be loaded ({}): apt install python3-pygame'.format(
                error))
        try:
            pygame.display.init()
            pygame.joystick.init()
        except pygame.error as error:
            raise DeviceAbsent('SDL does not start: {}'.format(error))
        pygame.event.set_blocked(None)
        pygame.event.set_allowed([pygame.JOYAXISMOTION] + [
            getattr(pygame, name) for name in ('JOYDEVICEADDED', 'JOYDEVICEREMOVED')
            if hasattr(pygame, name)])
        self._pygame = pygame

    def look(self):
        """Return the :class:`PadInfo` of every connected joystick, while none is open.

        :raises DeviceAbsent: SDL cannot be used at all
        """
        if self._pygame is None:
            self._start()
        pygame = self._pygame
        if pygame.get_sdl_version()[0] < 2:
            # SDL 1.2 lists joysticks only once, at its start.
            pygame.joystick.quit()
            pygame.joystick.init()
            self._listed = None
        if pygame.event.get() or self._listed is None:
            self._listed = self._list()
        return self._listed

    def _list(self):
        """Return all joysticks that can be opened: pygame describes only an open one."""
        found = []
        for index in range(self._pygame.joystick.get_count()):
            try:
                joystick, files = self._opened(index)
            except self._pygame.error:  # unplugged meanwhile
                continue
            found.append(_info(index, joystick, files))
            joystick.quit()
        return found

    def _opened(self, index):
        """Return (pygame's joystick, opened; {file descriptor: path} of its files)."""
        before = device_files()
        joystick = self._pygame.joystick.Joystick(index)
        joystick.init()
        return joystick, {number: path for number, path in device_files().items()
                          if number not in before}

    def open(self, info):
        """Open a joystick of the last :meth:`look`; return its :class:`Joystick`.

        :raises DeviceAbsent: it cannot be opened
        """
        self._listed = None
        try:
            joystick, files = self._opened(info.index)
        except self._pygame.error as error:
            raise DeviceAbsent('{} cannot be opened: {}; is it yours to read (group input)?'.format(
                info.name, error))
        if _info(info.index, joystick, files).full_name != info.full_name:
            joystick.quit()
            raise DeviceAbsent('{} was unplugged'.format(info.name))
        return Joystick(self._pygame, joystick, info, files)


def _info(index, joystick, files):
    """Return the :class:`PadInfo` of an open joystick of pygame."""
    guid = joystick.get_guid() if hasattr(joystick, 'get_guid') else ''
    pad = next(filter(None, map(pad_at, files.values())), None)
    if pad is not None:
        return replace(pad, index=index, guid=guid or pad.guid)
    number = 'number {}'.format(joystick.get_instance_id() + 1) if hasattr(
        joystick, 'get_instance_id') else ''
    return PadInfo(index, joystick.get_name(), guid, number)


class KernelAxes:
    """The axes of an event node but for hats, in SDL's order: that of their codes.

    :raises OSError: the file is no event node, or cannot be read
    """

    def __init__(self, path):
        self._device = evdev.InputDevice(path)
        self.codes = sorted(
            code for code, _ in self._device.capabilities().get(ecodes.EV_ABS, ())
            if not ecodes.ABS_HAT0X <= code <= ecodes.ABS_HAT3Y)

    def value(self, index):
        """Return the present value of an axis in [-1, 1].

        :raises DeviceLost: the device is gone
        """
        try:
            info = self._device.absinfo(self.codes[index])
        except OSError:
            raise DeviceLost('it was unplugged or switched off')
        return (2.0 * info.value - info.min - info.max) / max(1, info.max - info.min)

    def close(self):
        """Close the file."""
        self._device.close()


def kernel_axes(joystick, files):
    """Return the :class:`KernelAxes` of an open joystick of pygame, None if its files have none."""
    for path in files.values():
        try:
            axes = KernelAxes(path)
        except OSError:  # a joydev node, which reports all its axes on opening
            continue
        if len(axes.codes) == joystick.get_numaxes():
            return axes
        axes.close()
    return None


class Joystick:
    """One open joystick, by :meth:`Joysticks.open`.

    A hat appears twice: as two axes after the device's own (right +1, down +1, as in the kernel)
    and as four buttons after the device's own (up, right, down, left).

    :param files: {file descriptor: path} that SDL has opened for it
    """

    def __init__(self, pygame, joystick, info, files):
        self._pygame = pygame
        self._joystick = joystick
        self.info = info
        self._axes = range(joystick.get_numaxes())
        self._buttons = range(joystick.get_numbuttons())
        self._hats = range(joystick.get_numhats())
        self._instance = joystick.get_instance_id() if hasattr(
            joystick, 'get_instance_id') else None
        self._reported = set()
        self._kernel = kernel_axes(joystick, files)
        self._files = list(files)
        self._poll = select.poll()
        for number in files:
            self._poll.register(number, select.POLLIN)
        self._idle = False

    @property
    def axis_count(self):
        """The number of axes, including those of the hats."""
        return len(self._axes) + 2 * len(self._hats)

    def state(self):
        """Return the present (axes, buttons): axes in [-1, 1], None until known, buttons 0 or 1.

        :raises DeviceLost: the joystick is gone
        """
        self._pump()
        axes = [self._axis(index) for index in self._axes]
        buttons = [int(bool(self._joystick.get_button(index))) for index in self._buttons]
        for index in self._hats:
            right, up = self._joystick.get_hat(index)
            axes += [float(right), float(-up)]
            buttons += [int(up > 0), int(right > 0), int(up < 0), int(right < 0)]
        return tuple(axes), tuple(buttons)

    def _axis(self, index):
        """Return the value of one axis, or None; SDL's minimum is a little below -1."""
        if index in self._reported:
            return max(-1.0, min(1.0, self._joystick.get_axis(index)))
        return self._kernel.value(index) if self._kernel else None

    def _pump(self):
        """Process the pending events of SDL.

        :raises DeviceLost: the joystick is gone
        """
        pygame = self._pygame
        for event in pygame.event.get():
            if event.type == pygame.JOYAXISMOTION and self._is_mine(event):
                self._reported.add(event.axis)
            elif event.type == getattr(pygame, 'JOYDEVICEREMOVED', None) and self._is_mine(event):
                raise DeviceLost('it was unplugged or switched off')
        # SDL 1.2 does not report a removal.
        if any(os.fstat(number).st_nlink == 0 for number in self._files):
            raise DeviceLost('its file in /dev/input is gone')

    def _is_mine(self, event):
        if self._instance is not None and hasattr(event, 'instance_id'):
            return event.instance_id == self._instance
        return getattr(event, 'joy', self.info.index) == self.info.index

    def wait(self, timeout_s):
        """Wait, at most this long [s], for a possible change.

        :raises DeviceLost: the joystick is gone
        """
        if not self._files or self._idle:
            # Rest: the file also has events that SDL does not read, e.g. of motion sensors.
            time.sleep(min(timeout_s, POLL_S))
            self._idle = False
            return
        ready = self._poll.poll(timeout_s * 1000.0)
        if any(flags & (select.POLLERR | select.POLLHUP | select.POLLNVAL) for _, flags in ready):
            raise DeviceLost('it was unplugged or switched off')
        self._idle = bool(ready)

    def rumble(self, strength, seconds):
        """Rumble (strength 0 to 1); return whether the device supports it."""
        if not hasattr(self._joystick, 'rumble'):
            return False
        return bool(self._joystick.rumble(strength, strength, int(seconds * 1000)))

    def close(self):
        """Close the device; must be called once."""
        if self._kernel is not None:
            self._kernel.close()
        self._joystick.quit()
