# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Foot switches where there is no uinput: event nodes that are pseudo terminals.

What a program reads from such a node are the kernel's ``struct input_event``, and it is evdev that
opens, polls and parses them; unplugging hangs the terminal up, which wakes a poll as a device does
that goes away. Only the ioctls, which a terminal has not, are answered from files: who the device
is, which keys are down, who has grabbed it. Those files also serve a node in another process::

    python3 test/support/evdev_stream.py FOLDER [arguments of mhri_pedal]
"""
import errno
import fcntl
import json
import os
import re
import shutil
import struct
import sys
import termios
import time
import tty

from evdev import ecodes

EVENT = struct.Struct('llHHi')
NOBODY = 65534
CODES = ecodes.ecodes
SCAN_OF_KEY = {'KEY_A': 0x70004, 'KEY_B': 0x70005, 'KEY_C': 0x70006, 'KEY_1': 0x7001e,
               'KEY_2': 0x7001f, 'KEY_3': 0x70020}


def event_bytes(events):
    """Return the bytes of (type, code, value) triples, ended by a report."""
    return b''.join(EVENT.pack(1700000000, 0, *event)
                    for event in list(events) + [(ecodes.EV_SYN, ecodes.SYN_REPORT, 0)])


def parse_evemu(text):
    """Return the bytes of a recording by evemu-record: lines ``E: 0.000001 0004 0004 458757``."""
    found = re.findall(r'^E: (\d+)\.(\d+) ([0-9a-f]{4}) ([0-9a-f]{4}) (-?\d+)', text, re.MULTILINE)
    return b''.join(EVENT.pack(int(sec), int(usec), int(kind, 16), int(code, 16), int(value))
                    for sec, usec, kind, code, value in found)


class StreamNode:
    """One event node: a terminal, its entry below ``sys`` and its link below ``dev``."""

    def __init__(self, folder, number, name, usb, phys, keys, down=()):
        self._master, self._slave = os.openpty()
        tty.setraw(self._slave)
        os.set_blocking(self._master, False)
        terminal = os.ttyname(self._slave)
        os.chmod(terminal, 0o666)
        self._terminal = terminal
        self.path = os.path.join(folder, 'dev', 'event{}'.format(number))
        self._sys = os.path.join(folder, 'sys', 'event{}'.format(number))
        self._state = os.path.join(folder, 'state', os.path.basename(terminal))
        shutil.rmtree(self._state, ignore_errors=True)
        os.makedirs(self._state)
        self._held = set(down)
        self._write('info', [3] + [int(part, 16) for part in usb.split(':')] + [0x110, name, phys])
        self._write('keys', sorted(CODES[key] for key in keys))
        self._write('down', sorted(CODES[key] for key in down))
        os.symlink(terminal, self.path)
        self._describe(name, usb, phys, keys)

    def _describe(self, name, usb, phys, keys):
        """Write what the kernel tells of a device, the folder last: it appears whole."""
        new = self._sys + '.new'
        vendor, product = usb.split(':')
        bits = sum(1 << CODES[key] for key in keys)
        words = ['{:x}'.format(bits >> shift & 0xffffffffffffffff) for shift in
                 range(max(0, (bits.bit_length() - 1) // 64) * 64, -1, -64)]
        for place, text in (('name', name), ('phys', phys), ('uniq', ''), ('id/vendor', vendor),
                            ('id/product', product), ('capabilities/key', ' '.join(words))):
            path = os.path.join(new, 'device', place)
            os.makedirs(os.path.dirname(path), exist_ok=True)
            with open(path, 'w', encoding='utf-8') as stream:
                stream.write(text + '\n')
        os.rename(new, self._sys)

    def _write(self, name, value):
        """Change one of the answers, all at once."""
        path = os.path.join(self._state, name)
        with open(path + '.new', 'w', encoding='utf-8') as stream:
            json.dump(value, stream)
        os.rename(path + '.new', path)

    def send(self, data):
        """Send bytes as they are."""
        os.write(self._master, data)

    def send_whole(self, data):
        """Send bytes, and return when all of them can be read: a terminal passes them on in parts.

        For tests that do not read meanwhile.
        """
        wanted = self._readable() + len(data)
        self.send(data)
        deadline = time.monotonic() + 10.0
        while self._readable() < wanted:
            assert time.monotonic() < deadline, 'the terminal keeps what it was sent'
            time.sleep(0.001)

    def _readable(self):
        """Return how many bytes can be read."""
        return struct.unpack('i', fcntl.ioctl(self._slave, termios.FIONREAD, b'\0' * 4))[0]

    def set_down(self, *keys):
        """Change which keys the kernel says are down, without an event."""
        self._held = set(keys)
        self._write('down', sorted(CODES[key] for key in keys))

    def key(self, key, value):
        """Press (1), release (0) or repeat (2) a key, as a keyboard reports it."""
        self.keys((key, value))

    def keys(self, *changes):
        """Change several keys, a report for each, all of which can be read when this returns."""
        data = b''
        for key, value in changes:
            if value != 2:
                self.set_down(*(self._held | {key} if value else self._held - {key}))
            data += event_bytes([(ecodes.EV_MSC, ecodes.MSC_SCAN, SCAN_OF_KEY.get(key, 0x90001)),
                                 (ecodes.EV_KEY, CODES[key], value)])
        (self.send_whole if len(changes) > 1 else self.send)(data)

    def press(self, *keys):
        """Press keys, one report each."""
        for key in keys:
            self.keys((key, 1))

    def release(self, *keys):
        """Release keys, one report each."""
        for key in keys:
            self.keys((key, 0))

    def dropped(self):
        """Report that events were lost, as the kernel does before it goes on."""
        self.send(EVENT.pack(1700000000, 0, ecodes.EV_SYN, ecodes.SYN_DROPPED, 0))

    def grabbed(self):
        """Return whether a program that lives has the device for itself."""
        return grab_holder(self._state, self._terminal) is not None

    def forbid(self, forbidden=True):
        """Let nobody open it any more but an administrator; or everybody again."""
        os.chmod(self._terminal, 0 if forbidden else 0o666)

    def pull(self):
        """Unplug it."""
        shutil.rmtree(self._sys, ignore_errors=True)
        if os.path.islink(self.path):
            os.unlink(self.path)
        if self._master is not None:
            os.close(self._master)
            os.close(self._slave)
            self._master = None


def make_folders(folder):
    """Make the folders of a system without devices; return the folder."""
    for name in ('dev', 'sys', 'state'):
        os.makedirs(os.path.join(folder, name), exist_ok=True)
    return folder


def grab_holder(state, terminal):
    """Return 'process/descriptor' of the grab in force, None where there is none.

    As with a device, the grab ends as its descriptor is closed, or its process is gone.
    """
    try:
        with open(os.path.join(state, 'grab'), encoding='utf-8') as stream:
            holder = stream.read()
        process, _, number = holder.partition('/')  # nothing while it is being written
        if os.readlink('/proc/{}/fd/{}'.format(process, number)) == terminal:
            return holder
    except (OSError, ValueError):  # gone, or not written yet
        return None
    return None


class Ioctls:
    """Answers for ``evdev._input``, by the terminal that a descriptor belongs to."""

    def __init__(self, folder, real):
        self._folder = folder
        self._real = real

    def _state_of(self, number):
        return os.path.join(self._folder, 'state', os.path.basename(os.ttyname(number)))

    def _read(self, number, name):
        try:
            path = os.path.join(self._state_of(number), name)
        except OSError:
            raise OSError(errno.ENODEV, os.strerror(errno.ENODEV))
        with open(path, encoding='utf-8') as stream:
            return json.load(stream)

    def ioctl_devinfo(self, number):
        """Who it is; what was sent before the device was opened is not for the one who opens."""
        termios.tcflush(number, termios.TCIFLUSH)
        return tuple(self._read(number, 'info')) + ('',)

    def ioctl_EVIOCGVERSION(self, number):
        return 0x10001

    def ioctl_EVIOCGEFFECTS(self, number):
        return 0

    def ioctl_capabilities(self, number):
        return {ecodes.EV_SYN: [0, 1, 4], ecodes.EV_KEY: self._read(number, 'keys'),
                ecodes.EV_MSC: [ecodes.MSC_SCAN]}

    def ioctl_EVIOCG_bits(self, number, kind):
        assert kind == ecodes.EV_KEY
        return self._read(number, 'down')

    def ioctl_EVIOCGRAB(self, number, wanted):
        state = self._state_of(number)
        me = '{}/{}'.format(os.getpid(), number)
        if wanted and grab_holder(state, os.ttyname(number)) not in (None, me):
            raise OSError(errno.EBUSY, os.strerror(errno.EBUSY))
        with open(os.path.join(state, 'grab'), 'w', encoding='utf-8') as stream:
            stream.write(me if wanted else '0/0')

    def device_read_many(self, number):
        """Read for real; a device that is gone says ENODEV, a terminal that it has nothing."""
        events = self._real(number)
        if not events:
            raise OSError(errno.ENODEV, os.strerror(errno.ENODEV))
        return events


def open_as_user(real):
    """Wrap the opening of a device, so that an administrator is turned away as a user would be."""
    def opened(self, path):
        refuse = os.geteuid() == 0 and not os.stat(path).st_mode & 0o004
        if refuse:
            os.seteuid(NOBODY)
        try:
            real(self, path)
        finally:
            if refuse:
                os.seteuid(0)
    return opened


def install(folder, put=setattr):
    """Let evdev and mhri see the devices of a folder instead of the system's.

    :param put: function like ``setattr``, e.g. that of pytest's monkeypatch
    """
    import evdev
    from evdev import _input
    from mhri.devices.io import event_nodes
    answers = Ioctls(folder, _input.device_read_many)
    for name in dir(answers):
        if not name.startswith('_'):
            put(_input, name, getattr(answers, name))
    put(evdev.InputDevice, '__init__', open_as_user(evdev.InputDevice.__init__))
    put(event_nodes, 'SYS_INPUT', os.path.join(folder, 'sys'))
    put(event_nodes, 'DEV_INPUT', os.path.join(folder, 'dev'))


def main():
    """Run the pedal node with the devices of a folder."""
    install(sys.argv.pop(1))
    from mhri.nodes.mhri_pedal import main as run
    run()


if __name__ == '__main__':
    main()
