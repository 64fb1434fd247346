# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The accessory of the plain robot of the search: a flipper that operator a holds; its contract.

It keeps the value that it was sent last, like a robot its velocity.
"""
import math

from mhri.base.accessories import Accessory, HOLD
from mhri.base.limits import Velocity
from support.driving_contract import LEASE_S, STEP_S
from support.driving_senses import Senses
from support.every_state import Violation

#: The contract's figure: silent for so long, it is released [s].
SILENT_S = 0.25
FLIPPER = Accessory('flipper', key='flipper', kind=HOLD, type='std_msgs/Float64',
                    ranges=((-1.0, 1.0),), neutral=(0.0,))
_VALUES = {'hold': 1.0, 'rest': 0.0}


class Tools(Senses):
    """The part of :class:`support.driving_world.World` with the accessory."""

    def __init__(self, options, premises):
        super().__init__(options, premises)
        self.tools = (FLIPPER,) if 'tool' in options else ()
        # What the operator's hand says, and since when its robot has to rest.
        self.tool, self.tool_late = 'off', None
        # When it was said to be held; whether it was released since the last end; how it is.
        self.tool_at, self.tool_calm, self.tool_moves = -math.inf, False, False

    def do_tool(self, word):
        """The operator's hand holds the flipper, lets it go, or says nothing more."""
        if self.tool == word or self.there['a'] == 'off':
            return False
        self.tool = word
        return None if word == 'off' else self._use()

    def _use(self):
        """Say it once; what comes after a sleep is old."""
        if self.there['a'] == 'off':
            self.tool = 'off'
        if self.tool == 'off':
            return
        if self.now >= self.deaf_until:
            if self.tool == 'rest' or self.now - self.tool_at >= SILENT_S:
                self.tool_calm = True
            self.tool_at = self.now if self.tool == 'hold' else -math.inf
        orders, _ = self.drive.on_accessory('/a', ('p',), 'flipper', '', (_VALUES[self.tool],),
                                            self.now)
        self._carry_out(orders)

    def _end_tools(self):
        """It has to be released before it moves again."""
        self.tool_calm = False

    def _without_authority(self):
        """Return all that forbids the operator to move the flipper."""
        checks = (
            (self.stopped, 'stop-all'), ('p' in self.alone, 'stopped alone'),
            (not self.undertaken, 'no undertaker'),
            (self.holder is None or self.holder.name != '/a', 'not in control'),
            (self.wish is None or 'p' not in self.wish, 'not selected'),
            (self.now - self.wish_at >= LEASE_S, 'no lease'),
            (self.held['p'], 'not reachable'))
        return [words for holds, words in checks if holds]

    def _tool_reasons(self):
        """Return why the flipper has to rest."""
        found = self._without_authority()
        if found:
            self._end_tools()
            return found
        return [words for holds, words in (
            (not self.tool_calm, 'released first'),
            (self.now - self.tool_at >= SILENT_S, 'silent')) if holds]

    def _take_in_acts(self, orders):
        """Let the flipper have what is ordered for it; return the velocities."""
        for _, act in orders:
            if isinstance(act, Velocity):
                continue
            self.tool_moves = any(act.value)
            if self.tool_moves:
                reasons = self._tool_reasons()
                if reasons:
                    raise Violation('the flipper moves in spite of {}'.format(reasons))
        return [order for order in orders if isinstance(order[1], Velocity)]

    def _judge_tools(self):
        """Judge whether the flipper moves that must rest."""
        reasons = self._tool_reasons()
        if len(reasons) == 1:
            self.premises['a flipper: ' + reasons[0]] += 1
        if not (self.tool_moves and reasons):
            self.premises['a flipper moves'] += self.tool_moves
            self.tool_late = None
            return
        self.tool_late = self.now if self.tool_late is None else self.tool_late
        if self.now - self.tool_late >= STEP_S - 1e-6:
            raise Violation('the flipper moves on in spite of {}'.format(reasons))
