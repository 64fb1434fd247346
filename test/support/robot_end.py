# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The robot's end of a link in the hands of somebody who says what no robot should."""
import io
import os
import struct
import threading

from mhri.link.carried import COMMAND, key_of, STATE
from mhri.link.frames import About, Beat, pack, pack_about, pack_beat, unpack, unpack_beat
from mhri.link.peer import BEAT_S, Peer
from mhri.link.ros.carrier import Carrier
from mhri.link.ros.clock import boot_clock


class RobotEnd:
    """Beats to whichever host calls, and says what it is told to.

    :param robot: its name on the link
    :param listen: an endpoint
    """

    def __init__(self, robot, listen):
        self._robot = robot
        self._carrier = Carrier(listen=[listen])
        self._session = struct.unpack('>I', os.urandom(4))[0]
        self._senders, self._numbers = {}, {}
        self._peer = Peer()
        self.host = ''
        self.about = About({}, ())
        # What is sent again and again: {topic: bytes}.
        self.said = {}
        self._ended = threading.Event()
        self._carrier.listen(key_of(robot, '*', 'down', '_beat'), self._hear)
        threading.Thread(target=self._run, daemon=True).start()

    def _hear(self, key, data):
        self.host = key.split('/')[2]
        frame = unpack(data)
        self._peer.on_beat(frame, unpack_beat(frame.body), boot_clock())

    def say(self, topic, body, urgency=STATE):
        """Send one message."""
        key = key_of(self._robot, self.host, 'up', topic)
        if key not in self._senders:
            self._senders[key] = self._carrier.sender(key, urgency)
        self._numbers[key] = self._numbers.get(key, 0) + 1
        self._senders[key](pack(self._session, self._numbers[key], boot_clock(), body))

    def _run(self):
        while not self._ended.wait(0.5 * BEAT_S):
            if self.host:
                about = self.about
                self.say('_beat', pack_beat(Beat(self._peer.echo(boot_clock()), about.name)),
                         COMMAND)
                self.say('_about', pack_about(about))
                for topic, body in list(self.said.items()):
                    self.say(topic, body)

    def close(self):
        """Hang up."""
        self._ended.set()
        self._carrier.close()


def bytes_of(message):
    """Return a ROS message as bytes."""
    data = io.BytesIO()
    message.serialize(data)
    return data.getvalue()
