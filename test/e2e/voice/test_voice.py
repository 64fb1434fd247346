# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The voice's node as it is shipped: speech of espeak-ng into a FIFO drives, and stops whatever."""
from support.node_tools import measured, moves, NEUTRAL, rests
from support.own_node import own_node
from support.ros_system import wait_for
from support.voice_case import HEAR_S, START_S, VoiceTest

system = own_node('voice', '../../support/mux.launch')


class Voice(VoiceTest):

    def test_stop_stops_all_without_the_wake_word_whatever_drives(self):
        """While the voice drives, and while the stick of another source does."""
        self._ready()
        self._drive()
        begun = self._said('stop')
        stopped = self.stops.wait(lambda value: value, begun, HEAR_S)
        zero = self.twists.wait(rests, begun, HEAR_S)
        measured('end of "stop" to stop-all', stopped.at - self.out)
        measured('end of "stop" to zero', zero.at - self.out)
        self._said('robot drive forward', release=False)
        self.twists.wait_silence(0.7)
        self.assertFalse([item for item in self.twists.since(zero.at) if moves(item.value)])
        self._release()
        self._mode('joy')
        wait_for(lambda: not self.node.listeners(), what='still listens', timeout_s=START_S)
        self._resume()
        self.waits.settle('')
        self.stick.hold((0.0, 1.0))
        self.twists.wait(moves, zero.at)
        begun = self._said('robot stop')
        self.stops.wait(lambda value: value, begun, HEAR_S)
        self.twists.wait(rests, begun, HEAR_S)
        self.stick.hold(NEUTRAL)
