# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Pads without hardware: the real node with SDL's virtual joysticks in its process.

``virtual_pad.py SOCKET MODULE ARGUMENT...`` runs ``MODULE.main()`` and attaches, moves and detaches
joysticks as it is told through a socket, by :class:`PadProcess` in the process of the test. All of
the node is real, from pygame on; only the device below SDL is not. SDL has virtual joysticks from
2.0.14 on; :func:`missing` tells.
"""
import ctypes
import importlib
import json
import os
import re
import socket
import subprocess
import sys
import tempfile
import threading
import time

SDL_INIT_JOYSTICK = 0x200
GAME_CONTROLLER = 1
FULL = 32767
TIMEOUT_S = 30.0
GO_ON = threading.Event()


class _Desc(ctypes.Structure):
    """SDL_VirtualJoystickDesc of SDL 2.24."""

    RUMBLE = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p, ctypes.c_uint16, ctypes.c_uint16)
    _fields_ = [(name, ctypes.c_uint16) for name in (
        'version', 'type', 'naxes', 'nbuttons', 'nhats', 'vendor_id', 'product_id', 'padding')] + [
        ('button_mask', ctypes.c_uint32), ('axis_mask', ctypes.c_uint32),
        ('name', ctypes.c_char_p), ('userdata', ctypes.c_void_p), ('Update', ctypes.c_void_p),
        ('SetPlayerIndex', ctypes.c_void_p), ('Rumble', RUMBLE),
        ('RumbleTriggers', ctypes.c_void_p), ('SetLED', ctypes.c_void_p),
        ('SendEffect', ctypes.c_void_p)]


def _load():
    """Return pygame's SDL with the functions of virtual joysticks declared, or None."""
    from mhri.devices.io import sdl
    for name, value in sdl.ENVIRONMENT.items():
        os.environ.setdefault(name, value)
    import pygame  # noqa: F401  (loads the library)
    with open('/proc/self/maps', encoding='utf-8', errors='replace') as maps:
        # Debian's is libSDL2-2.0.so.0, in a wheel the name has a hash.
        found = re.search(r'\S*/libSDL2-2[^/_]*\.so[^/ \n]*', maps.read())
    library = ctypes.CDLL(found.group(0)) if found else None
    if not hasattr(library, 'SDL_JoystickAttachVirtualEx'):
        return None
    library.SDL_JoystickOpen.restype = ctypes.c_void_p
    for name in ('SDL_JoystickClose', 'SDL_JoystickInstanceID'):
        getattr(library, name).argtypes = [ctypes.c_void_p]
    library.SDL_JoystickGetDeviceInstanceID.restype = ctypes.c_int32
    library.SDL_JoystickSetVirtualAxis.argtypes = [ctypes.c_void_p, ctypes.c_int, ctypes.c_int16]
    for name in ('SDL_JoystickSetVirtualButton', 'SDL_JoystickSetVirtualHat'):
        getattr(library, name).argtypes = [ctypes.c_void_p, ctypes.c_int, ctypes.c_uint8]
    return library


def missing():
    """Return why there can be no virtual pad here, or None."""
    try:
        return None if _load() else 'SDL before 2.24 has no virtual joysticks with names'
    except ImportError as error:
        return str(error)


class KernelAxes:
    """The axes of a virtual pad: {index: value}; one that was never moved is at 0."""

    def __init__(self, axes):
        self._axes = axes

    def value(self, index):
        """Return the present value."""
        return self._axes.get(index, 0.0)

    def close(self):
        """There is no file."""


class Pads:
    """The virtual joysticks of this process; each command is a method."""

    def __init__(self):
        self._sdl = None
        self._pads, self._axes = {}, {}
        self._kept = []
        self._rumbles = []

    def attach(self, name, axes=6, buttons=17, hats=0, vendor=0, product=0):
        """Plug a pad in; return its number."""
        if self._sdl is None:
            from mhri.devices.io import sdl
            self._sdl = _load()
            sdl.kernel_axes = self._kernel_axes
        self._sdl.SDL_InitSubSystem(SDL_INIT_JOYSTICK)
        desc = _Desc(1, GAME_CONTROLLER, axes, buttons, hats, vendor, product, 0, 0, 0,
                     name.encode(), Rumble=_Desc.RUMBLE(self._on_rumble))
        self._kept.append(desc)  # SDL keeps its pointers
        index = self._sdl.SDL_JoystickAttachVirtualEx(ctypes.byref(desc))
        assert index >= 0, 'not attached'
        pad = self._sdl.SDL_JoystickOpen(index)
        number = self._sdl.SDL_JoystickInstanceID(pad)
        self._pads[number] = pad
        self._axes[number] = {}
        return number

    def _kernel_axes(self, joystick, _):
        """Answer for the kernel, which knows no virtual pad."""
        return KernelAxes(self._axes[joystick.get_instance_id()])

    def _on_rumble(self, _, low, high):
        self._rumbles.append((time.monotonic(), low, high))
        return 0

    def rumbles(self):
        """Return (time, low, high) of every call that reached the device."""
        return self._rumbles

    def set(self, number, axes=None, buttons=None, hats=None):
        """Move axes {index: -1.0 to 1.0}, buttons {index: 0 or 1}, hats {index: bits}."""
        pad = self._pads[number]
        self._axes[number].update(
            (int(index), value) for index, value in (axes or {}).items())
        for index, value in (axes or {}).items():
            self._sdl.SDL_JoystickSetVirtualAxis(pad, int(index), int(round(value * FULL)))
        for index, value in (buttons or {}).items():
            self._sdl.SDL_JoystickSetVirtualButton(pad, int(index), value)
        for index, value in (hats or {}).items():
            self._sdl.SDL_JoystickSetVirtualHat(pad, int(index), value)

    def swing(self, number, axis, value):
        """Push an axis and let it go, as slowly as it takes to be seen."""
        for part in (0.5 * value, value, value, 0.0):
            self.set(number, {axis: part})
            time.sleep(0.1)

    def click(self, number, button):
        """Press a button and let it go, as slowly as it takes to be seen."""
        for value in (1, 0):
            self.set(number, buttons={button: value})
            time.sleep(0.1)

    def go_on(self):
        """Let a process that was started with ``paused`` become the node."""
        GO_ON.set()

    def detach(self, number):
        """Pull a pad out; SDL reports it within this call."""
        pad = self._pads.pop(number)
        for index in range(self._sdl.SDL_NumJoysticks()):
            if self._sdl.SDL_JoystickGetDeviceInstanceID(index) == number:
                self._sdl.SDL_JoystickDetachVirtual(index)
                break
        at = time.monotonic()
        self._sdl.SDL_JoystickClose(pad)
        return at

    def shown_in(self, folder):
        """Let the kernel's list of input devices be a folder (:mod:`support.kernel_pads`)."""
        from mhri.devices.io import event_nodes
        event_nodes.SYS_INPUT = folder


def serve(path):
    """Obey one client after the other, each line a command as JSON."""
    pads = Pads()
    server = socket.socket(socket.AF_UNIX)
    server.bind(path)
    server.listen(1)
    while True:
        with server.accept()[0].makefile('rwb') as stream:
            for line in stream:
                name, arguments = json.loads(line)
                try:
                    answer = [True, getattr(pads, name)(**arguments)]
                except Exception as error:
                    answer = [False, repr(error)]
                stream.write(json.dumps(answer + [time.monotonic()]).encode() + b'\n')
                stream.flush()


def pad_command(path, module, *arguments):
    """Return the command of a process with virtual pads that listens to a :class:`PadClient`."""
    return [sys.executable, os.path.abspath(__file__), path, module] + list(arguments)


class PadClient:
    """Tells a process with virtual pads what to do with them.

    :param path: the socket at which it listens, or will
    :param lives: tells whether it runs
    :param said: returns what it has written
    """

    def __init__(self, path, lives=lambda: True, said=lambda: ''):
        self._said = said
        self._socket = socket.socket(socket.AF_UNIX)
        self.done_at = None
        deadline = time.monotonic() + TIMEOUT_S
        while True:
            try:
                self._socket.connect(path)
                break
            except OSError:
                if not lives() or time.monotonic() > deadline:
                    raise AssertionError('the node with the pads does not run: ' + said())
                time.sleep(0.01)
        self._stream = self._socket.makefile('rwb')

    def do(self, command, **arguments):
        """Let the process carry out a method of :class:`Pads`; return its answer."""
        self._stream.write(json.dumps([command, arguments]).encode() + b'\n')
        self._stream.flush()
        line = self._stream.readline()
        assert line, 'the node has ended: ' + self._said()
        good, answer, self.done_at = json.loads(line)
        assert good, answer
        return answer

    def close(self):
        """Say nothing more."""
        self._stream.close()
        self._socket.close()


class PadProcess:
    """A node with virtual pads, as a process; use it as a context manager or :meth:`end` it.

    :param module: e.g. 'mhri.nodes.mhri_joy'
    :param paused: do not become the node before the command ``go_on``
    """

    def __init__(self, *arguments, module='mhri.nodes.mhri_joy', env=None, stdin=None,
                 paused=False):
        self._folder = tempfile.TemporaryDirectory(prefix='mhri_pad_')
        path = os.path.join(self._folder.name, 'socket')
        self._log = open(os.path.join(self._folder.name, 'log'), 'w+', encoding='utf-8')
        self.popen = subprocess.Popen(
            pad_command(path, module, *arguments),
            env=dict(os.environ, MHRI_PAUSED='1' if paused else '', **(env or {})),
            stdin=stdin or subprocess.DEVNULL, stdout=self._log, stderr=subprocess.STDOUT)
        self._client = PadClient(path, lambda: self.popen.poll() is None, self.said)

    @property
    def pid(self):
        """Number of the process."""
        return self.popen.pid

    def said(self):
        """Return everything the process has written."""
        with open(self._log.name, encoding='utf-8', errors='replace') as stream:
            return stream.read()

    def do(self, command, **arguments):
        """Let the process carry out a method of :class:`Pads`; return its answer."""
        return self._client.do(command, **arguments)

    @property
    def done_at(self):
        """When the last command was done."""
        return self._client.done_at

    def end(self):
        """Make sure that it is gone."""
        if self.popen.poll() is None:
            self.popen.kill()
        self.popen.wait()
        self._client.close()
        self._log.close()
        if self.popen.stdin and not self.popen.stdin.closed:
            self.popen.stdin.close()
        self._folder.cleanup()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.end()


def main():
    """Serve the socket on a thread and be the node."""
    path, module = sys.argv[1:3]
    sys.argv[:] = [module] + sys.argv[3:]
    threading.Thread(target=serve, args=(path,), daemon=True).start()
    if os.environ.pop('MHRI_PAUSED', ''):
        GO_ON.wait(TIMEOUT_S)
    importlib.import_module(module).main()


if __name__ == '__main__':
    main()
