# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What the guard does by itself: it brakes, and goes back to where it was heard."""
import time

from mhri.msg import RobotDrive
from support.drive_case import ZERO
from support.drive_tools import HallCase
from support.own_node import own_node
from support.ros_system import freeze, thaw, wait_for
from support.node_tools import measured
from support.velocity import VelocityEnd

system = own_node('guard_look', 'guard_look.launch')

AFTER_S = 2.0
# A robot on its way back has to stand so soon after somebody is heard again.
HEARD_WITHIN_S = 1.0


class GuardLook(HallCase):

    radius_m = 0.22

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.end = VelocityEnd('/bot1/cmd_vel')

    def guarded(self, *options):
        """Select bot1, with a guard that was started with some options, and centre the stick."""
        guard = self.start_guard(*options)
        self.operator.check('bot1')
        self.wait_robot('bot1', lambda robot: robot.guarded, 'the guard')
        self.ready('bot1')
        return guard

    def test_it_brakes_before_a_wall_and_the_drive_says_so(self):
        self.guarded('_brake:=true')
        self.wait_robot('bot1', lambda robot: robot.brake_on_robot
                        and robot.brake == RobotDrive.BRAKE_ON, 'its word')
        self.addCleanup(self.operator.set)
        # Asked for here as well: the one on the robot is enough.
        self.operator.set(brake=True)
        self.state.wait(lambda state: state.settings.brake, 'the wish')
        begun = time.monotonic()
        slows = self.keep_on(lambda: self.state.robot('bot1').brake == RobotDrive.BRAKE_SLOWS
                             and self.state.robot('bot1'), 'the brake to act', 0.25)
        self.assertTrue(slows.brake_on_robot)
        self.assertGreater(slows.free_way_m, 0.0)
        gap = self.push_to_rest(0.25)
        print('MEASURED gap to the wall behind the brake of the guard: {:.3f} m, never less than '
              '{:.3f} m'.format(gap, self.hall.least_gap(begun)))
        self.assertGreater(self.hall.least_gap(begun), 0.03)
        self.assertLess(gap, 0.3)
        self.keep_on(lambda: self.state.robot('bot1').sent.linear.x > 0.2,
                     'the drive, which does not brake', 0.25)
        self.operator.centre()
        self.drive_to(10.9, -0.25)
        self.operator.set()
        self.state.wait(lambda state: not state.settings.brake, 'the wish to be taken back')

    def far_robot(self):
        """Drive away from where the robot begins; return where it is then [m]."""
        self.guarded('_back_after_s:={}'.format(AFTER_S), '_back_speed:=0.2')
        self.wait_robot('bot1', lambda robot: robot.back_after_s == AFTER_S, 'what it would do')
        start = self.hall.places.last()
        return self.drive_past(start - 0.5, -0.2)

    def test_it_goes_back_while_it_is_not_heard_and_stops_when_it_is(self):
        lost = self.far_robot()
        numbers = self.drive_process.number, self.worker()
        when = freeze(*numbers)
        self.addCleanup(thaw, *numbers)
        wait_for(lambda: ZERO in [entry[1:] for entry in self.end.after(when)],
                 what='the end of the lease')
        self.hall.places.wait(lambda x: x > lost + 0.2, when)
        # It was driven backwards: the way back is ahead.
        moved = next(entry for entry in self.end.after(when) if entry[1] > 0.0)
        # It was heard half a second before at most.
        self.assertGreater(measured('not heard: the way back begins', moved[0] - when),
                           AFTER_S - 0.6)
        heard = thaw(*numbers)
        wait_for(lambda: time.monotonic() > heard + HEARD_WITHIN_S, what='some time')
        # A zero may be older than that: the way back waits where a scan is late.
        moved = [entry[0] for entry in self.end.after(heard) if entry[1:] != ZERO]
        last = max(moved, default=heard)
        self.assertLess(measured('heard again: last motion', last - heard), HEARD_WITHIN_S)
        self.assertEqual(self.end.after(heard)[-1][1:], ZERO)
        # The stick was held all the time: it waits for a centred one.
        self.hall.rests()
        self.stays_at_rest(self.end, heard + HEARD_WITHIN_S, linear=-0.2)
        self.operator.centre()
        self.wait_robot('bot1', lambda robot: robot.guarded, 'the guard')
        self.ready('bot1')
        self.drive_to(self.hall.places.last() - 0.1, -0.2)

    def test_it_stays_where_it_is_left_on_purpose(self):
        self.far_robot()
        self.operator.centre()
        self.hall.rests()
        left = self.hall.places.last()
        self.end_drive()
        when = time.monotonic()
        try:
            wait_for(lambda: time.monotonic() > when + 2.0 * AFTER_S, what='some time')
            self.assertLess(abs(self.hall.places.last() - left), 0.02)
            self.assertLessEqual({entry[1:] for entry in self.end.after(when)}, {ZERO})
        finally:
            self.start_drive()
