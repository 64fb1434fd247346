#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What the guard does by itself: it brakes, and goes back to where it was heard."""
import math
import os
import signal
import sys
import time

import rospy
import rostest
from sensor_msgs.msg import LaserScan

sys.path.insert(0, os.path.join(os.path.dirname(os.path.realpath(__file__)), '..'))

from drive_tools import Hall, Hand, PATIENCE_S  # noqa: E402
from gates_case import end, GatesCase, start_gates, ZERO  # noqa: E402
from mhri.msg import RobotGate  # noqa: E402
from rostest_tools import measured, Process  # noqa: E402
from support.ros_system import wait_for  # noqa: E402
from support.velocity import VelocityEnd  # noqa: E402

GUARD = os.path.join(os.path.dirname(os.path.realpath(__file__)), '..', '..', 'utils', 'remote',
                     'mhri_guard')
AFTER_S = 2.0
CRAWL_MPS = 0.1


class Halves:
    """Two lasers made of the one that bot1 has: one looks ahead, one back."""

    def __init__(self):
        self.live = {'ahead': True, 'behind': True}
        self._lasers = {half: rospy.Publisher('/bot1/' + half, LaserScan, queue_size=1,
                                              tcp_nodelay=True) for half in self.live}
        self._all = rospy.Subscriber('/bot1/scan', LaserScan, self._share, queue_size=1)

    def _share(self, message):
        ranges, turn = message.ranges, len(message.ranges) // 4
        shift = int(round(message.angle_min / message.angle_increment))
        ranges = ranges[-shift % len(ranges):] + ranges[:-shift % len(ranges)]
        for half, begin, first in (('ahead', -turn, -math.pi / 2.0), ('behind', turn,
                                                                      math.pi / 2.0)):
            if self.live[half]:
                message.ranges = (ranges + ranges)[begin % len(ranges):][:2 * turn + 1]
                message.angle_min, message.angle_max = first, first + math.pi
                self._lasers[half].publish(message)

    def close(self):
        self._all.unregister()
        for laser in self._lasers.values():
            laser.unregister()


class GuardLook(GatesCase):

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.hall = Hall('bot1', 0.22)
        cls.end = VelocityEnd('/bot1/cmd_vel')

    def guarded(self, *options):
        """Check bot1, with a guard that was started with some options, and centre the stick."""
        guard = Process([sys.executable, GUARD, '_command:=cmd_vel', '_radius_m:=0.22',
                         '_no_return:=0,inf@3.5', *options], env={'ROS_NAMESPACE': 'bot1'})

        def leave():
            guard.send(signal.SIGTERM)
            guard.wait(PATIENCE_S)
            guard.end()
            rospy.delete_param('/bot1/mhri_guard')
        self.addCleanup(leave)
        self.operator.check('bot1')
        self.state.wait_robot('bot1', lambda gate: gate.guarded and gate.obeys == 'operator',
                              'the guard', PATIENCE_S)
        self.centre('bot1', self.end)
        return guard

    def hold(self, linear):
        """Hold the stick until the test lets it go."""
        hand = Hand(self.mux, linear)
        self.addCleanup(hand.let_go)
        return hand

    def drive_to(self, x, linear):
        """Drive there, and let go."""
        hand = self.hold(linear)
        self.hall.places.wait(lambda now: now > x if linear > 0.0 else now < x, time.monotonic(),
                              PATIENCE_S)
        hand.let_go()
        self.mux.say(0.0)
        self.hall.rests()

    def test_it_brakes_before_a_wall_and_the_gates_say_so(self):
        self.guarded('_brake:=true')
        self.state.wait_robot('bot1', lambda gate: gate.brake_on_robot
                              and gate.brake == RobotGate.BRAKE_ON, 'its word', PATIENCE_S)
        self.addCleanup(self.operator.set)
        # Asked for here as well: the one on the robot is enough.
        self.operator.set(brake=True)
        self.state.wait(lambda state: state.brake, 'the wish')
        begun = time.monotonic()
        hand = self.hold(0.25)
        slows = self.state.wait_robot('bot1', lambda gate: gate.brake == RobotGate.BRAKE_SLOWS,
                                      'the brake to act', PATIENCE_S)
        self.assertTrue(slows.brake_on_robot)
        self.assertGreater(slows.free_way_m, 0.0)
        gap = self.hall.rests()
        print('MEASURED gap to the wall behind the brake of the guard: {:.3f} m, never less than '
              '{:.3f} m'.format(gap, self.hall.least_gap(begun)))
        self.assertGreater(self.hall.least_gap(begun), 0.03)
        self.assertLess(gap, 0.3)
        self.assertGreater(self.state.robot('bot1').sent.linear.x, 0.2, 'the gates do not brake')
        hand.let_go()
        self.mux.say(0.0)
        self.drive_to(10.9, -0.25)
        self.operator.set()
        self.state.wait(lambda state: not state.brake, 'the wish to be taken back')

    def test_of_two_lasers_the_one_that_falls_silent_closes_its_side(self):
        halves = Halves()
        self.addCleanup(halves.close)
        self.guarded('_brake:=true', '_scan:=ahead@-0.064 behind@-0.064')
        self.state.wait_robot('bot1', lambda gate: gate.brake == RobotGate.BRAKE_ON, 'the brake',
                              PATIENCE_S)

        def told(since):
            return [linear for _, linear, _ in self.end.after(since)]
        for half, linear, least in (('behind', -0.2, CRAWL_MPS), ('ahead', 0.2, 0.0)):
            begun = time.monotonic()
            hand = self.hold(linear)
            wait_for(lambda: linear in told(begun), PATIENCE_S, 'the way to be free')
            silent, halves.live[half] = time.monotonic(), False
            wait_for(lambda: told(silent) and abs(told(silent)[-1]) <= least + 1e-6, PATIENCE_S,
                     'the side without a laser to be closed')
            closed = time.monotonic()
            measured('laser {} silent: at most {} m/s'.format(half, least), closed - silent)
            wait_for(lambda: len(told(closed)) > 10, PATIENCE_S, 'more commands')
            self.assertLessEqual(max(map(abs, told(closed))), least + 1e-6)
            hand.let_go()
            self.mux.say(0.0)
            halves.live[half] = True
            self.hall.rests()
            self.centre('bot1', self.end)
        self.drive_to(self.hall.places.last() + 0.1, 0.2)

    def far_robot(self):
        """Drive away from where the robot begins; return where it is then [m], and the hand."""
        self.guarded('_back_after_s:={}'.format(AFTER_S), '_back_speed:=0.2')
        self.state.wait_robot('bot1', lambda gate: gate.back_after_s == AFTER_S,
                              'what it would do', PATIENCE_S)
        start, hand = self.hall.places.last(), self.hold(-0.2)
        return self.hall.places.wait(lambda x: x < start - 0.5, time.monotonic(),
                                     PATIENCE_S).value, hand

    def test_it_goes_back_while_it_is_not_heard_and_stops_when_it_is(self):
        lost, hand = self.far_robot()
        when = self.gates.send(signal.SIGSTOP)
        self.addCleanup(self.gates.send, signal.SIGCONT)
        zero = wait_for(lambda: [entry[0] for entry in self.end.after(when) if entry[1:] == ZERO],
                        PATIENCE_S, 'the end of the lease')[0]
        self.hall.places.wait(lambda x: x > lost + 0.2, when, PATIENCE_S)
        moved = next(entry for entry in self.end.after(zero) if entry[1:] != ZERO)
        # It was heard half a second before at most.
        self.assertGreater(measured('not heard: the way back begins', moved[0] - when),
                           AFTER_S - 0.6)
        heard = self.gates.send(signal.SIGCONT)
        wait_for(lambda: ZERO in [entry[1:] for entry in self.end.after(heard)], PATIENCE_S,
                 'the zero')
        first = next(at for at, *said in self.end.after(heard) if tuple(said) == ZERO)
        measured('heard again: zero', first - heard)
        # The stick was held all the time: it waits for a centred one.
        self.hall.rests()
        self.stays_at_rest(self.end, first, linear=-0.2)
        hand.let_go()
        self.state.wait_robot('bot1', lambda gate: gate.guarded, 'the guard', PATIENCE_S)
        self.centre('bot1', self.end)
        self.drive_to(self.hall.places.last() - 0.1, -0.2)

    def test_it_stays_where_it_is_left_on_purpose(self):
        _, hand = self.far_robot()
        hand.let_go()
        self.mux.say(0.0)
        self.hall.rests()
        left = self.hall.places.last()
        end(GatesCase.gates)
        when = time.monotonic()
        try:
            wait_for(lambda: time.monotonic() > when + 2.0 * AFTER_S, PATIENCE_S, 'some time')
            self.assertLess(abs(self.hall.places.last() - left), 0.02)
            self.assertLessEqual({entry[1:] for entry in self.end.after(when)}, {ZERO})
        finally:
            GatesCase.gates = start_gates()
            self.wait_for_mux()


if __name__ == '__main__':
    rospy.init_node('guard_look_test')
    rostest.rosrun('mhri', 'guard_look', GuardLook)
