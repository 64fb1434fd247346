# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Runs a module of mhri in a separate process, and exchanges messages with it.

``python3 -c`` and ``python3 -m`` look for modules in the working folder first: a child would run a
``json.py`` or an ``mhri.py`` there. Messages have their own socket, since sound libraries write to
the standard output.
"""
import json
import os
import select
import socket
import subprocess
import sys

# -I leaves out the working folder, but also PYTHONPATH: pass the paths as the first argument.
_RUN = ('import sys; sys.path[:] = sys.argv.pop(1).split({!r}); import importlib; '
        'importlib.import_module(sys.argv.pop(1)).main()'.format(os.pathsep))
# The maximum size of a packet, and the minimum buffer for packets not received yet [bytes].
_PACKET_BYTES = 1 << 18


class Channel:
    """One end of a packet connection to another process; packets are sent whole."""

    def __init__(self, end):
        end.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, _PACKET_BYTES)
        self._socket = end

    def fileno(self):
        """Return the descriptor to poll."""
        return self._socket.fileno()

    def send(self, message, wait=False):
        """Send a message.

        :param message: bytes, sent as they are, or a value for JSON
        :param wait: wait for room; otherwise drop the message if the buffer is full
        :raises OSError: the other end is gone; BlockingIOError: the buffer is full
        """
        self._socket.send(message if isinstance(message, bytes) else json.dumps(message).encode(),
                          0 if wait else socket.MSG_DONTWAIT)

    def packet(self, timeout_s=0.0):
        """Return the next message as bytes, b'' if none is received in time (None: no time-out).

        :raises EOFError: the other end is gone, and all messages have been read
        """
        poll = select.poll()
        poll.register(self._socket, select.POLLIN)
        if not poll.poll(None if timeout_s is None else 1000.0 * max(0.0, timeout_s)):
            return b''
        try:
            packet = self._socket.recv(_PACKET_BYTES)
        except ConnectionResetError:
            # The other end closed without reading everything; its own messages are still readable.
            packet = self._socket.recv(_PACKET_BYTES)
        if not packet:
            raise EOFError
        return packet

    def messages(self, timeout_s=0.0):
        """Return all received messages, parsed from JSON; wait for the first like :meth:`packet`.

        :raises EOFError: the other end is gone, and all messages have been read
        """
        found = []
        try:
            packet = self.packet(timeout_s)
            while packet:
                found.append(json.loads(packet.decode()))
                packet = self.packet()
        except EOFError:
            if not found:
                raise
        return found


class Child(Channel):
    """A process that runs ``main()`` of a module, which calls :func:`parent`.

    :param module: dotted name
    :param arguments: texts, the ``sys.argv[1:]`` of the module
    :param options: of ``subprocess.Popen``; by default its standard streams are discarded
    :raises OSError: it cannot be started
    """

    def __init__(self, module, *arguments, **options):
        ours, its = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        with its:
            try:
                self.process = subprocess.Popen(
                    command(module, str(its.fileno()), *arguments), pass_fds=(its.fileno(),),
                    **{**dict.fromkeys(('stdin', 'stdout', 'stderr'), subprocess.DEVNULL),
                       **options})
            except OSError:
                ours.close()
                raise
        super().__init__(ours)

    def end(self, timeout_s=0.0):
        """Close the connection; kill the process after a time-out. Return its exit status."""
        self._socket.close()
        try:
            self.process.wait(timeout_s)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
        return self.process.returncode


def parent():
    """Return the :class:`Channel` to the process that started this one by :class:`Child`."""
    return Channel(socket.socket(fileno=int(sys.argv.pop(1))))


def command(module, *arguments):
    """Return the command that runs ``main()`` of a module with the module path of this process.

    :param module: dotted name
    :param arguments: texts, the ``sys.argv[1:]`` of the module
    """
    # An imported package of a devel space puts its sources first in the path, but its messages are
    # elsewhere: keep PYTHONPATH first, as at the start of this process.
    wanted = os.environ.get('PYTHONPATH', '').split(os.pathsep) + sys.path
    paths = os.pathsep.join(path for path in dict.fromkeys(wanted) if os.path.isabs(path))
    return [sys.executable, '-I', '-c', _RUN, paths, module, *arguments]
