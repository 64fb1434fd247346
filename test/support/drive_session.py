# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""An operator at the real panel who drives three simulated robots, with an eye on each."""
import subprocess

from mhri.driving.gui.hands import Errand, Grip
from support.journals import Journal
from support.panel_session import PanelSession

ROBOTS = ('bot1', 'bot2', 'bot3')


class DriveSession(PanelSession):
    """The robots are found by the panel's own button; the mux writes a journal."""

    def __init__(self):
        super().__init__([('sim.launch', 'n:=3')], ())
        from support.robots import Witness
        self.witnesses = {name: Witness(name) for name in ROBOTS}

    def mux_words(self):
        self.journal = Journal(self.system.home)
        return (self.journal.argument,)

    def tidy(self):
        """Begin a test with three robots at rest, none selected, nothing stopped."""
        self.look()
        self.select()
        self.rest()

    def robot(self, name):
        return self.operator.robot_view(name)

    def proof(self, name):
        """Return the state of a robot's proof, None while the drive has not said it is stopped."""
        proof = self.robot(name).proof
        return proof.state if proof else None

    def drive(self, forward, turn, condition, what='the robots to drive'):
        """Hold the stick until a condition comes true."""
        self.until(Grip(lambda: self.hands.hold_stick(forward, turn), self.hands.let_go,
                        lambda: self.operator.view().status, condition), what=what)

    def click(self, name):
        """Click a widget with the pointer of the X server: what lies above it gets it instead."""
        widget = self.hands.widget(name)
        place = widget.mapToGlobal(widget.rect().center())
        clicks = subprocess.Popen(['xdotool', 'mousemove', '--sync', str(place.x()),
                                   str(place.y()), 'click', '1'])
        # Not by waiting: a screen that hangs meanwhile stops all robots.
        self.until(lambda: clicks.poll() is not None, what='the click')
        assert clicks.returncode == 0

    def look(self):
        """Have the panel find all robots, once they are there."""
        self.until(lambda: all(witness.live() for witness in self.witnesses.values()),
                   what='the robots')
        if len(self.operator.selection.robots) < len(ROBOTS):
            self.click('look_button')
        self.until(lambda: [self.robot(name).link for name in self.operator.selection.robots]
                   == ['live'] * len(ROBOTS), what='three live robots')

    def select(self, *names):
        """Click check boxes until exactly these robots are selected."""
        for name in ROBOTS:
            if (name in names) != (name in self.operator.selection.selected):
                self.click('check_' + name)
        self.until(lambda: set(self.operator.selection.selected) == set(names),
                   what=lambda: '{}, not {}'.format(names, self.operator.selection.selected))
        self.until(lambda: set(self.presenter.windows) >= set(names), what='the windows')
        self.until(lambda: self.operator.view().status.endswith('ready') or not names,
                   what=lambda: 'the panel to be ready: ' + self.operator.view().status)

    def release(self):
        """Give up stop-all as a person does."""
        def release():
            self.hands.click('release_button')
            self.hands.click('confirm_button')
        # The mux may not have seen yet that the stick was let go.
        self.until(Errand(release, lambda: not self.operator.view().stop_all, 1.0,
                          self.hands.widget('release_button').isEnabled), what='the release')

    def rest(self):
        self.until(lambda: all(witness.at_rest() for witness in self.witnesses.values()),
                   what='all robots to stand still')
