# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Host and two robots on computers of their own, for real: deployed over ssh, driven, link cut.

The computers are network namespaces (``support/machines.py``); a robot's own packages are stand-ins
that start simulated robots.
"""
import time

import pytest

from support import machines
from support.lab import (
    await_quiet, first_standstill, GUARDED, left, LONG_S, Operator, path_m, running_lab, START_S,
    STRAYED_M)
from support.ros_system import wait_for

WHY_NOT = machines.why_not()
pytestmark = [pytest.mark.skipif(WHY_NOT is not None, reason=str(WHY_NOT))]

# What a robot needs to stand still, at most: the smoother's 0.5 s of patience and its ramp, or the
# watchdog's 0.5 s; the rest is for a machine under load.
STOP_S = {'bot1': 1.5, 'bot2': 1.0}
# A stick of a process that stood still for longer may be centred before robots drive on.
STALE_S = 0.4


@pytest.fixture(scope='module')
def lab(request, tmp_path_factory):
    yield from running_lab(request, tmp_path_factory.mktemp('lab'), True)


@pytest.fixture(scope='module')
def operator(lab):
    """Return the operator's end: a node in this process, with a stick and an eye on each robot."""
    built = Operator(lab)
    yield built
    built.close()


@pytest.fixture(scope='module')
def started(lab, operator):
    """Have the files on both robots, and start them; return {name: terminal}."""
    return operator.start_robots()


def test_both_robots_are_started_found_and_driven(lab, operator, started):
    from mhri.robots.ros.graph_scan import look_for_robots, shipped_ignore_list
    for name, terminal in started.items():
        assert 'ROS_IP={}'.format(lab.robots[name].ip) in terminal.text(), \
            'not that of its other network'
    assert 'model:=burger' in ' '.join(lab.robots['bot2'].processes('mhri_turtlebot3.launch'))
    found = look_for_robots('/lab', shipped_ignore_list())
    assert {'bot1', 'bot2'} <= {getattr(robot, 'name', robot) for robot in found.live}
    operator.drive('bot1', 'bot2')


def latencies_ms(operator, rows, turns=30):
    """Return how long each of so many changes of the stick took to a robot's command topic [ms].

    A change that is not there when the next one is due counts as of the time until then.
    """
    sent, operator.stick.longest_gap_s = [], 0.0
    for turn in range(turns + 1):
        sent.append(time.monotonic())
        operator.stick.hold(0.2, 0.5 + 0.3 * (turn % 2))
        time.sleep(0.04)
    operator.stick.hold(0.2, 0.6)
    wait_for(lambda: rows(3)[-1][0] > sent[-1] + 0.1 or operator.stick.longest_gap_s > STALE_S, 20,
             lambda: 'the last change; {!r}'.format(operator.state), poll_s=0.05)
    times = []
    for begin, end in zip(sent, sent[1:]):
        before = [row for row in rows(3) if row[0] < begin][-1]
        after = [row[0] for row in rows(3) if begin <= row[0] < end and row[2] != before[2]]
        times.append(1e3 * ((after[0] if after else end) - begin))
    return sorted(times)


def say_latencies(name, when, times):
    print('MEASURED stick to {}, {}: p50 {:.1f} ms, longest {:.1f} ms, {} changes'.format(
        name, when, times[len(times) // 2], times[-1], len(times)))


@pytest.mark.parametrize('name, other', [('bot1', 'bot2'), ('bot2', 'bot1')])
def test_robot_stops_without_its_link_and_is_usable_with_it(lab, operator, started, name, other):
    from support.node_tools import measured
    robot = lab.robots[name]
    rows, others = lab.observer(name), lab.observer(other)
    operator.drive(name, other)
    say_latencies(other, 'all links up', latencies_ms(operator, others))
    cut = time.monotonic()
    robot.unplug()
    try:
        wait_for(lambda: first_standstill(rows(), cut), 20, name + ' to stop', poll_s=0.05)
        stopped = first_standstill(rows(), cut) - cut
        during = latencies_ms(operator, others)
        say_latencies(other, 'link of {} cut'.format(name), during)
        # A robot that is held would wait for a centred stick for ever.
        wait_for(lambda: operator.witnesses[other].moving()
                 or operator.stick.longest_gap_s > STALE_S, 20, other + ' to go on', poll_s=0.02)
        operator.stick.hold(0.0, 0.0)
        wait_for(operator.witnesses[other].at_rest, 20, other + ' to rest', poll_s=0.05)
    finally:
        robot.plug()
    mended = time.monotonic()
    wait_for(operator.witnesses[name].live, START_S, 'word of ' + name, poll_s=0.05)
    back = time.monotonic() - mended
    # What was kept on the way has come by then, or never does.
    wait_for(lambda: time.monotonic() > mended + back + 2.0, 20, 'the rest of the backlog')
    strayed = path_m(rows(), mended)
    operator.drive(name)
    print('MEASURED link of {} ({}) cut for {:.1f} s: stands still after {:.0f} ms; mended: heard '
          'of again after {:.1f} s, moved {:.3f} m by itself, then driven again'.format(
              name, 'guarded' if name in GUARDED else 'no guard', mended - cut, stopped * 1e3,
              back, strayed))
    measured(name + ' without its link: stands', stopped, STOP_S[name])
    assert strayed < STRAYED_M[name], 'a stale command moved it'
    assert during[len(during) // 2] < 50.0, other + ' goes by the stick as before'
    assert all(terminal.process.poll() is None for terminal in started.values())
    operator.stick.hold(0.0, 0.0)
    wait_for(operator.witnesses[name].at_rest, 20, name + ' to rest', poll_s=0.05)


def test_ctrl_c_on_the_host_ends_the_robot(lab, started):
    terminal = started['bot1']
    assert left(lab.robots['bot1'])
    terminal.press(b'\x03')
    assert terminal.process.wait(LONG_S) == 130, terminal.text()
    await_quiet(lab.robots['bot1'])
