# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A robot on a master of its own, linked to the host: driven, stopped, and a side that hangs."""
import time

import pytest

from support import graph
from support.linked import LONG_S, running_linked
from support.ros_system import freeze, thaw, wait_for


@pytest.fixture(scope='module')
def lab():
    yield from running_linked()


@pytest.mark.parametrize('side', ['host', 'robot'])
def test_what_a_side_that_hung_has_kept_is_not_obeyed(lab, side):
    lab.drive(lab.operator)
    process = lab.link_of_host if side == 'host' else lab.node_of_robot()
    since = freeze(process.pid)
    try:
        at = wait_for(lambda: lab.stood_at(since), LONG_S, 'it to stand')
        # From now on the mux sends zeros alone; what they said before is older than 0.3 s then.
        wait_for(lambda: lab.row().stands, LONG_S, 'the mux to keep it standing')
        time.sleep(0.4)
    finally:
        thaw(process.pid)
    wait_for(lab.witness.live, LONG_S, 'the odometry to be back')
    # The stick was never let go.
    time.sleep(1.0)
    assert [row for row in lab.rows() if row[0] > at and abs(row[2]) > 0.02] == []
    lab.drive(lab.operator)
    lab.operator.stick.hold(0.0, 0.0)


def test_a_stop_holds_on_the_robot_until_it_is_released(lab):
    import rospy
    from std_srvs.srv import SetBool
    set_stop = rospy.ServiceProxy(graph.SET_STOP_ALL, SetBool)
    lab.drive(lab.operator)
    assert set_stop(True).success
    wait_for(lambda: lab.row().stop_confirmed, LONG_S, 'the guard to confirm the stop')
    wait_for(lambda: not lab.moves(), LONG_S, 'it to stand')
    lab.operator.stick.hold(0.0, 0.0)
    wait_for(lambda: set_stop(False).success, LONG_S, 'the stop to be released', 0.1)
    wait_for(lambda: not lab.row().stop_confirmed, LONG_S, 'the guard to let go')
    lab.drive(lab.operator)
    lab.operator.stick.hold(0.0, 0.0)
