# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The pad's node with virtual pads, for tests."""
import contextlib
import os

from support import graph
from support.input_nodes import InputNode
from support.virtual_pad import missing, PadProcess

PS3 = 'Sony PLAYSTATION(R)3 Controller'
NO_PADS = missing()


class JoyNode(InputNode):
    """``mhri_joy`` in a process, suspended, with no pad.

    :param env: additional variables of its environment, None for none
    """

    def __init__(self, *arguments, env=None):
        super().__init__('mhri_joy', graph.PAD, lambda: PadProcess(*arguments, env=env))

    def do(self, command, **arguments):
        """Carry out a command of :class:`support.virtual_pad.Pads`."""
        return self.process.do(command, **arguments)

    def attach(self, name, axes=None, counts=(6, 17, 0), product=0):
        """Plug a pad in; return its number."""
        number = self.do('attach', name=name, axes=counts[0], buttons=counts[1], hats=counts[2],
                         vendor=0x1209, product=product)
        self.set(number, axes=axes)
        return number

    def set(self, number, **state):
        """Move a pad; return when that was done."""
        self.do('set', number=number, **state)
        return self.process.done_at

    def detach(self, number):
        """Pull a pad out; return when SDL reported it."""
        return self.do('detach', number=number)

    def open_devices(self):
        """Return the device files that the node has open."""
        links, folder = [], '/proc/{}/fd'.format(self.pid)
        for name in os.listdir(folder):
            with contextlib.suppress(FileNotFoundError):
                links.append(os.readlink(os.path.join(folder, name)))
        return [link for link in links if link.startswith(('/dev/input', '/dev/hidraw'))]
