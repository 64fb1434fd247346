# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Joysticks by SDL, through pygame 1.9.6 (SDL 1.2) and 2.x (SDL 2).

pygame does not provide whether an axis has reported yet, whether a pad is still attached, or its
port, and provides name and GUID only for an opened pad. If it runs on SDL 2, this module therefore
also calls that library through ctypes. Otherwise an axis is known from its first event on, and a
pad is gone when its file in /dev/input is.
"""
import ctypes
from dataclasses import replace
import os
import re
import select
import time

from mhri.devices.io.event_nodes import find_pads, where_is
from mhri.devices.io.reader import DeviceAbsent, DeviceLost
from mhri.devices.pads import PadInfo

# Polling period of a pad without a file to wait for (a virtual one) [s].
POLL_S = 0.004
_DEVICE_FILE = re.compile(r'/dev/(input/|hidraw)')
# Not SDL2_image, _mixer, _ttf; Debian's is libSDL2-2.0.so.0, in a wheel the name has a hash.
_LIBRARY = re.compile(r'\S*/libSDL2-2[^/_]*\.so[^/ \n]*')

ENVIRONMENT = {
    'SDL_VIDEODRIVER': 'dummy',                   # events without a window
    'SDL_JOYSTICK_ALLOW_BACKGROUND_EVENTS': '1',  # no window can have the focus
    'SDL_NO_SIGNAL_HANDLERS': '1',                # rospy handles SIGTERM and Ctrl-C
    'PYGAME_HIDE_SUPPORT_PROMPT': '1',
    # Use only the kernel's drivers: SDL's own drivers number the axes and buttons of a pad
    # differently in each version, and always keep its file open.
    'SDL_JOYSTICK_HIDAPI': '0',
}


class _Guid(ctypes.Structure):
    _fields_ = [('data', ctypes.c_uint8 * 16)]


def load_library():
    """Return the SDL 2 library loaded by this process, with its types declared, or None."""
    try:
        with open('/proc/self/maps', encoding='utf-8', errors='replace') as maps:
            found = _LIBRARY.search(maps.read())
        library = ctypes.CDLL(found.group(0)) if found else None
    except OSError:
        return None
    if library is None:
        return None
    pointer, number = ctypes.c_void_p, ctypes.c_int
    try:
        for function, result, arguments in (
                (library.SDL_JoystickFromInstanceID, pointer, [ctypes.c_int32]),
                (library.SDL_JoystickGetAttached, number, [pointer]),
                (library.SDL_JoystickGetAxisInitialState, number,
                 [pointer, number, ctypes.POINTER(ctypes.c_int16)]),
                (library.SDL_JoystickNameForIndex, ctypes.c_char_p, [number]),
                (library.SDL_JoystickGetDeviceInstanceID, ctypes.c_int32, [number]),
                (library.SDL_JoystickGetDeviceGUID, _Guid, [number])):
            function.restype, function.argtypes = result, arguments
    except AttributeError:  # an SDL older than 2.0.6
        return None
    if hasattr(library, 'SDL_JoystickPathForIndex'):  # from 2.24 on
        library.SDL_JoystickPathForIndex.restype = ctypes.c_char_p
        library.SDL_JoystickPathForIndex.argtypes = [number]
    return library


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
        self._library = None

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
        if pygame.get_sdl_version()[0] >= 2:
            self._library = load_library()
        wanted = [pygame.JOYDEVICEADDED, pygame.JOYDEVICEREMOVED] if hasattr(
            pygame, 'JOYDEVICEREMOVED') else []
        if self._library is None:
            wanted.append(pygame.JOYAXISMOTION)
        pygame.event.set_blocked(None)
        if wanted:
            pygame.event.set_allowed(wanted)
        self._pygame = pygame

    def look(self):
        """Return the :class:`PadInfo` of every connected joystick.

        :raises DeviceAbsent: SDL cannot be used at all
        """
        if self._pygame is None:
            self._start()
        pygame = self._pygame
        if pygame.get_sdl_version()[0] < 2:
            # SDL 1.2 lists joysticks only once, at its start.
            pygame.joystick.quit()
            pygame.joystick.init()
        pygame.event.pump()
        pygame.event.get()
        return self._list()

    def connected(self):
        """Return the result of :meth:`look` without updating SDL; [] if SDL is too old."""
        if self._library is None:
            return []
        return self._list()

    def _list(self):
        """Return all joysticks with their ports."""
        pads = [replace(pad, where=self._where(pad.index)) for pad in map(
            self._info, range(self._pygame.joystick.get_count()))]
        if all(pad.where for pad in pads):
            return pads
        # An SDL version without their files lists them in the kernel's order.
        kernel = find_pads()
        places = {pad.name: iter([other.where for other in kernel if other.name == pad.name])
                  for pad in pads}
        return [replace(pad, where=pad.where or next(places[pad.name], '')
                        or self._number(pad.index)) for pad in pads]

    def _where(self, index):
        """Return the port of a joystick, '' if its file is unknown."""
        if not hasattr(self._library, 'SDL_JoystickPathForIndex'):
            return ''
        return where_is((self._library.SDL_JoystickPathForIndex(index) or b'').decode())

    def _number(self, index):
        """Return the number of a joystick while it is connected, '' if unknown."""
        return 'number {}'.format(self._library.SDL_JoystickGetDeviceInstanceID(index) + 1) \
            if self._library else ''

    def _info(self, index):
        if self._library is not None:
            name = self._library.SDL_JoystickNameForIndex(index) or b''
            guid = bytes(self._library.SDL_JoystickGetDeviceGUID(index).data).hex()
            return PadInfo(index, name.decode('utf-8', 'replace'), guid)
        joystick = self._pygame.joystick.Joystick(index)
        guid = joystick.get_guid() if hasattr(joystick, 'get_guid') else ''
        return PadInfo(index, joystick.get_name(), guid)

    def open(self, info):
        """Open a joystick of the last :meth:`look`; return its :class:`Joystick`.

        :raises DeviceAbsent: it cannot be opened
        """
        before = device_files()
        try:
            joystick = self._pygame.joystick.Joystick(info.index)
            joystick.init()
        except self._pygame.error as error:
            raise DeviceAbsent('{} cannot be opened: {}; is it yours to read (group input)?'.format(
                info.name, error))
        files = [number for number in device_files() if number not in before]
        return Joystick(self._pygame, self._library, joystick, info, files)


class Joystick:
    """One open joystick, by :meth:`Joysticks.open`.

    A hat appears twice: as two axes after the device's own (right +1, down +1, as in the kernel)
    and as four buttons after the device's own (up, right, down, left).
    """

    def __init__(self, pygame, library, joystick, info, files):
        self._pygame = pygame
        self._library = library
        self._joystick = joystick
        self.info = info
        self._axes = range(joystick.get_numaxes())
        self._buttons = range(joystick.get_numbuttons())
        self._hats = range(joystick.get_numhats())
        self._instance = joystick.get_instance_id() if hasattr(
            joystick, 'get_instance_id') else None
        # Valid while the joystick is open, until close().
        self._pointer = library.SDL_JoystickFromInstanceID(self._instance) if library else None
        self._known = set()
        self._files = files
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
        if index not in self._known and not self._is_known(index):
            return None
        self._known.add(index)
        return max(-1.0, min(1.0, self._joystick.get_axis(index)))

    def _is_known(self, index):
        """Return whether an axis has reported, without SDL 2 by its first event."""
        value = ctypes.c_int16()
        return bool(self._pointer) and bool(self._library.SDL_JoystickGetAxisInitialState(
            self._pointer, index, ctypes.byref(value)))

    def _pump(self):
        """Process the pending events of SDL.

        :raises DeviceLost: the joystick is gone
        """
        pygame = self._pygame
        for event in pygame.event.get():
            if event.type == pygame.JOYAXISMOTION and self._is_mine(event):
                self._known.add(event.axis)
            elif event.type == getattr(pygame, 'JOYDEVICEREMOVED', None) and self._is_mine(event):
                raise DeviceLost('it was unplugged or switched off')
        if self._pointer and not self._library.SDL_JoystickGetAttached(self._pointer):
            raise DeviceLost('it was unplugged or switched off')
        # SDL 1.2 does not report a removal.
        if not self._library and any(os.fstat(number).st_nlink == 0 for number in self._files):
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
        self._pointer = None
        self._joystick.quit()
