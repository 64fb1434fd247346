# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The drive is killed while a plain robot is behind a radio that loses much: as a stick let go.

``MHRI_KILLS`` sets how often. Which packets are lost is chance: what is compared is the medians.
"""
import os
import signal
import statistics
import time

from support.ros_system import wait_for

KILLS = int(os.environ.get('MHRI_KILLS', '5'))
LONG_S = 60.0
BAD = {'at_s': 0, 'delay_ms': 200, 'loss_percent': 20}
LET_GO, KILLED = 'stick let go', 'drive killed'
# A few packets more or less are lost: a try takes 0.6 s and more; single ones took 4.2 s, of 20
# either way. With the connection lost it was 4.5 to 15.5 s.
CHANCE_S = 3.0


def test_a_kill_behind_a_bad_radio_is_as_a_stick_let_go(in_own_network):
    in_own_network(LONG_S * (2 + KILLS))


def drives_behind_a_bad_radio(world):
    """Drive on a clean cable, then make it bad; return whether the robot still moves."""
    world.radio.follow([{'at_s': 0}])
    world.drive()
    world.radio.follow([BAD])
    begun = time.monotonic()
    wait_for(lambda: time.monotonic() > begun + 1.5, LONG_S, 'what came over the cable')
    # Where many are lost in a row its line is lost: it stands, and waits for neutral.
    return world.robots[0].moves()


def inside():
    """Be the operator; end with an AssertionError where something is not so."""
    from support.far_world import FarWorld
    found = {LET_GO: [], KILLED: []}
    with FarWorld('far1') as world:
        for how in [LET_GO, KILLED] * KILLS:
            wait_for(lambda: drives_behind_a_bad_radio(world), LONG_S, 'it to drive')
            run, since = world.state.message.run, time.monotonic()
            if how == KILLED:
                os.kill(world.child(), signal.SIGKILL)
            else:
                world.forward = 0.0
            found[how] += world.zeros(since)
            if how == KILLED:
                world.stays(since, since + 1.0)
                world.radio.follow([{'at_s': 0}])
                world.next(run)
    for how, zeros in found.items():
        print('MEASURED behind {delay_ms} ms and {loss_percent} %, {}: first zero after {:.2f} s '
              '(median), {:.2f} s at worst of {}'.format(
                  how, statistics.median(zeros), max(zeros), len(zeros), **BAD))
    assert statistics.median(found[KILLED]) <= statistics.median(found[LET_GO]) + CHANCE_S


if __name__ == '__main__':
    inside()
