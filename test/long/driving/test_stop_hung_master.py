# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Stops while the ROS master hangs: the screen and the voice have found the mux before."""
import signal
import threading
import time
from unittest import mock
from urllib.parse import urlsplit

import psutil
import pytest
import rosgraph

from support import graph
from support.ros_system import freeze, System, wait_for

# Each looks for the mux twice a second, and what it has found then stays.
FOUND_S = 1.0
# A topic of each; the screen's lines for all robots and for single ones, and the voice's.
LINES = 5
# 0.05 s is promised; the rest is for a busy computer.
SOON_S = 0.5


class Desk:
    """A screen's and a voice's way to a mux whose master can be made to hang."""

    def __init__(self, system):
        import rospy
        from mhri.driving.ros.drive_client import DriveClient
        from mhri.voice.grammar import Command, STOP
        from mhri.voice.ros.voice import VoiceLink
        self.system, self.stops, self.answers = system, [], []
        self._lines, self._since = set(), 0.0
        system.start_master()
        self.mux = system.node('mux', '__name:=mux')
        rospy.init_node('stop_hung_master', disable_signals=True)
        self.panel = DriveClient(lambda state, now: self.stops.append((state.stop_all, now)),
                                 self.answers.append).start()
        self.panel.start_driving()
        voice = VoiceLink()
        voice.start(mock.Mock(), threading.Event())
        self.press = {'panel': self.panel.stop_all, 'voice': lambda: voice.on_act(Command(STOP))}
        self._wait_mux()

    def _wait_mux(self):
        wait_for(self.panel.answers, what='the mux')
        wait_for(self._found, what=lambda: 'the lines, only {}'.format(self._lines), poll_s=0.05)

    def _found(self):
        """Return whether all have their line to the mux that there is."""
        try:
            port = urlsplit(rosgraph.Master('/test').lookupService(graph.SET_STOP_ALL)).port
        except rosgraph.MasterError:
            return False
        lines = {line.laddr for line in psutil.Process().connections()
                 if line.raddr and line.raddr.port == port}
        if lines != self._lines:
            self._lines, self._since = lines, time.monotonic()
        return len(lines) >= LINES and time.monotonic() - self._since > FOUND_S

    def mux_restarted(self):
        self.system.kill(self.mux)
        wait_for(lambda: not self.panel.answers(), what='its end')
        self.mux = self.system.node('mux', '__name:=mux')
        self._wait_mux()

    def mux_replaced(self):
        """The older one hangs, and holds on to what is connected to it."""
        older = self.panel.state().run
        freeze(self.mux.pid)
        self.system.node('mux', '__name:=other_mux')
        wait_for(lambda: self.panel.state().run != older, what='the other mux')
        self._wait_mux()

    def at_rest(self):
        """Return whether no stop is in force; ask for its release."""
        stopped = wait_for(lambda: self.stops, what='the word of the mux')[-1][0]
        self.stops.clear()
        if stopped:
            self.panel.send_stick(0.0, 0.0)
            self.answers.clear()
            self.panel.release()
            wait_for(lambda: self.answers, what='the answer')
        return not stopped


@pytest.fixture(scope='module', name='desk')
def _desk():
    with System() as system:
        desk = Desk(system)
        yield desk
        system.kill(desk.mux)


@pytest.mark.parametrize('happened', ['nothing', 'mux_restarted', 'mux_replaced'])
def test_stop_needs_no_master(desk, happened):
    if happened != 'nothing':
        getattr(desk, happened)()
    for who, press in desk.press.items():
        freeze(desk.system.master.pid)
        try:
            desk.stops.clear()
            desk.answers.clear()
            pressed = time.monotonic()
            press()
            at = wait_for(lambda: [at for stopped, at in desk.stops if stopped], what=who)[0]
            print('MEASURED {} to stop-all: {:.1f} ms'.format(who, 1e3 * (at - pressed)))
            assert at - pressed < SOON_S
            assert who == 'voice' or wait_for(lambda: desk.answers, what='the answer') == ['']
            pressed = time.monotonic()
            desk.panel.stop_robots(['bot1'])
            wait_for(lambda: not desk.panel.stops('bot1'), what='one robot', poll_s=0.001)
            took_s = time.monotonic() - pressed
            print('MEASURED one robot: {:.1f} ms'.format(1e3 * took_s))
            assert took_s < SOON_S
        finally:
            desk.system.master.send_signal(signal.SIGCONT)
        wait_for(desk.at_rest, what='the release')
