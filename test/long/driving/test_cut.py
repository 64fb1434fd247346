# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The network to a plain robot is cut while the stick is held: behind what was on its way a zero.

So it is with a moving part, which is held meanwhile: behind that its neutral value.
Nothing can reach it before the link is back. Then the kernel tries again: of its own accord only
after a pause as long as the outage, in which the robot drives on.
"""
import socket
import time

from support.ros_system import wait_for

LONG_S = 300.0
# What is waited for inside, so that a failure says what it was waiting for. And how long
# the flipper may take to be held before it is asked for from neutral once more [s].
WAIT_S, FLIPS_S, LOGGED_S = 80.0, 5.0, 0.5
# Promised between the first byte and the zero [s]: else it would come with the next try. That, at
# the latest [s]: the first seven come every 0.2 s, the others after 1 s, or on an older kernel
# after pauses that double.
ZERO_S, TRY_S, FIRST_TRIES_S = 0.05, 1.3, 1.4
# What the neutral value of a moving part may take behind the first value that arrives [s]: with the
# next second try it would take more.
FLIP_S = 0.5
MAX_PAUSE = 44
# Longer than a kernel with short pauses would try by itself.
LONGEST_CUT_S = 17.0


def test_after_a_cut_a_zero_is_directly_behind_what_was_on_its_way(in_own_network):
    in_own_network(LONG_S)


def pauses_are_short():
    """Return whether this kernel can be asked for short pauses (since 6.15)."""
    with socket.socket() as end:
        try:
            end.setsockopt(socket.IPPROTO_TCP, MAX_PAUSE, 1000)
            return True
        except OSError:
            return False


def cut_while_it_drives(world, how):
    """Cut the network of the robot that drives; return when, None if it did not drive by then."""
    robot, = world.robots
    world.let_go()
    world.drive()
    world.flip = 1.0
    begun = time.monotonic()

    def is_held():
        return robot.flips()[-1:] and robot.flips()[-1][1] == 1.0
    wait_for(lambda: is_held() or not robot.moves() or time.monotonic() > begun + FLIPS_S, WAIT_S,
             'the flipper')
    if not is_held():
        return None
    cut = world.cut(how)
    # By then its log has what it heard just before: behind a zero there is none that is owed.
    wait_for(lambda: time.monotonic() > cut + LOGGED_S, WAIT_S, 'its log')
    if robot.moves() and is_held():
        return cut
    world.mend(how)
    return None


def see_flipper(robot, back):
    """See the neutral value directly behind what was on its way, and nothing behind that."""
    told = wait_for(lambda: [row for row in robot.flips(back) if row[1] == 0.0]
                    and robot.flips(back), WAIT_S, 'the neutral value')
    values = [value for _, value in told]
    neutral = values.index(0.0)
    print('MEASURED of the flipper: for {:.2f} s {} old values, and then: neutral {:.3f} s behind '
          'the first'.format(told[0][0] - back, neutral, told[neutral][0] - told[0][0]))
    assert told[neutral][0] - told[0][0] <= FLIP_S
    assert not any(value for _, value in robot.flips(back)[neutral:])


def inside():
    """Be the operator; end with an AssertionError where something is not so."""
    from support.far_world import BOTH_WAYS, FarWorld, ONE_WAY
    from support.node_tools import measured
    with FarWorld('far1') as world:
        robot, = world.robots
        for how, cut_s in [(ONE_WAY, 1.0), (BOTH_WAYS, 5.0), (ONE_WAY, LONGEST_CUT_S)]:
            cut = wait_for(lambda: cut_while_it_drives(world, how), WAIT_S, 'it to drive')
            wait_for(lambda: time.monotonic() > cut + cut_s, WAIT_S, 'the cut')
            back = world.mend(how)
            world.zeros(back)
            first, zero = robot.after(back)[0][0] - back, world.zeros(back)[0]
            print('MEASURED network cut {} for {:g} s: back for {:.2f} s it hears {} old commands, '
                  'and then:'.format(how, cut_s, first, sum(any(word[1:]) and word[0] < back + zero
                                                            for word in robot.after(back))))
            world.stays(back, back + zero + 1.0)
            see_flipper(robot, back)
            measured('from the first of them to the zero', zero - first, ZERO_S)
            assert first <= (TRY_S if cut_s < FIRST_TRIES_S or pauses_are_short() else cut_s)


if __name__ == '__main__':
    inside()
