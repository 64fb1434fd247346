# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What the plain robot of the search sees and says: its laser, its odometry, the proof of its stop.

The real ``StickBrake`` looks through the laser, and a real ``StopProof`` listens to the odometry.
The robot's place is left out: it turns and gets nowhere.
"""
import math

import numpy as np

from mhri.base.geometry import Pose
from mhri.base.views import PROOF_STOPPED
from mhri.driving.stick_brake import StickBrake
from mhri.robots.link import Motion
from mhri.robots.stop_proof import StopProof
from mhri.sensors.brake import Scan
from support.driving_contract import Contract, LEASE_S, READINGS

RADIUS_M = 0.2
HERE = Pose(0.0, 0.0, 0.0)
STANDS, MOVES = Motion(0.0, 0.0), Motion(0.4, 0.0)
# How much later a reading comes than the quickest [s].
OLD_S = 1.0
_BEAMS = 36


def _scan(ranges_m, **facts):
    return Scan(np.array(ranges_m), -math.pi, 2.0 * math.pi / _BEAMS, 0.1, 5.0, **facts)


# A free way; a wall before it; no beam measured anything; "nothing there", as a dead laser says.
SCANS = {'free': _scan([3.0] * _BEAMS), 'wall': _scan([3.0] * 15 + [0.25] * 7 + [3.0] * 14),
         'dead': _scan([math.nan] * _BEAMS, blind_m=np.full(_BEAMS, math.inf)),
         'nothing': _scan([math.nan] * _BEAMS, sure_share=0.0)}


class Senses(Contract):
    """The part of :class:`support.driving_world.World` that sees; see there for the options."""

    def __init__(self, options, premises):
        super().__init__(options, premises)
        self.scan = self.odometry = 'off'
        self.brakes = frozenset('a') if 'eye' in options else frozenset()
        self.proof = StopProof(self.now)
        self._see_anew()

    def _see_anew(self):
        """Let p have a brake that has seen nothing."""
        self.eye, self.braking = StickBrake(RADIUS_M, True), False
        self.eye.move(HERE)

    def allow(self, velocity, now):
        """Return what the brake of p leaves of a velocity."""
        return self.eye.allow(velocity, now) if 'eye' in self.options \
            else self._brake(velocity, now)

    def _follow_brake(self):
        """Ask for the brake as long as its robot is selected with it, as its line does."""
        rule = self.drive.robots['p']
        if self.eye.asked != (self.drive.settings.brake and rule.selected):
            self.eye.ask(not self.eye.asked)
        braking = self.settings.brake and 'p' in (self.wish or ()) \
            and self.now - self.wish_at < LEASE_S
        if braking and not self.braking:
            self._forget_sight()
        self.braking = braking

    def _forget_sight(self):
        self.saw, self.saw_at = '', -math.inf

    def do_scan(self, word):
        """The laser says something else from now on, or nothing ("off")."""
        if self.scan == word:
            return False
        self.scan = word
        return self._look()

    def _look(self):
        if self.scan == 'off' or not self.eye.asked:
            return
        self.eye.see(SCANS[self.scan], self.now, HERE)
        if self.scan in ('free', 'wall'):
            self.saw, self.saw_at = self.scan, self.now

    def do_jump(self, _):
        """The odometry of p begins anew: nobody knows where what it saw is."""
        self.eye.move(HERE, anew=True)
        self._forget_sight()

    def do_brake(self, name):
        """An operator switches the brake on or off."""
        if self.there[name] != 'on':
            return False
        self.brakes ^= {name}
        return self._wish(name)

    def do_odometry(self, word):
        """It is heard from now on, or not; or one reading comes late, or without a date."""
        if word in ('old', 'none'):
            return self._read(STANDS, OLD_S if word == 'old' else None)
        if self.odometry == word:
            return False
        self.odometry = word

    def _sense(self):
        """Let what is repeated come: a scan, a reading."""
        self._look()
        if self.odometry == 'live' and not self.cut['p']:
            self._read(MOVES if any(self.given['p']) else STANDS, 0.0)

    def _read(self, motion, late_s):
        self.proof.on_motion(motion, self.now, late_s)
        if motion is MOVES:
            self.stills = 0
        elif late_s is not None and self.proof_at is not None \
                and self.now - late_s >= self.proof_at:
            self.stills, self.read_at = min(self.stills + 1, READINGS), max(
                self.read_at, self.now - late_s)

    def _begin_proof(self):
        if self.proof_at is None and 'proof' in self.options:
            self.proof, self.proof_at = StopProof(self.now), self.now
            self.stills, self.read_at = 0, -math.inf

    def _look_at_proof(self):
        if self.proof_at is not None:
            self._judge_proof(self.proof.view(self.now).state == PROOF_STOPPED)
