# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Messages of 100 MB, a selection of 20,000 names, a robot with 2,000 velocity topics.

The operator is killed while it drives: the first zero comes within 50 ms, whatever it had selected.
"""
import os
import signal
import time

import pytest

from support import graph
from support.ros_system import tell, wait_for
from support.under_fire import HERE, ROBOTS, table, UnderFire

NAMES, TOPICS = 20000, 2000
GROWTH_MB = 60.0
OPERATOR = os.path.join(HERE, 'operator_process.py')


@pytest.fixture(scope='module')
def fire():
    with UnderFire() as system:
        system.drive()
        system.wait_loaded()
        system.begun = system.sizes()
        yield system


def test_messages_of_100_mb(fire):
    """Mux and screen do not even read them, and go on with what others say."""
    import rospy
    from mhri.msg import DriveState, RobotSelect, TeamTwist
    for topic, kind, field in ((graph.SELECT, RobotSelect, 'mode'),
                               (graph.DRIVE_STATE, DriveState, 'operator'),
                               (graph.TASK_INPUT, TeamTwist, 'robots')):
        publisher = rospy.Publisher(topic, kind, queue_size=1)
        before = publisher.get_num_connections
        wait_for(before, what='somebody to listen to ' + topic)
        text = 'a' * (100 * 1000 * 1000)
        publisher.publish(**{field: [text] if field == 'robots' else text})
        wait_for(lambda: publisher.impl.message_data_sent > 10 ** 8 or not before(), 10.0,
                 'it to be sent')
        publisher.unregister()
    for name, (memory, _, _) in fire.sizes().items():
        assert memory - fire.begun[name][0] <= GROWTH_MB, name
    fire.drive()
    fire.stop_all()
    fire.check_alive()
    fire.check_straight()


def drive_state():
    import rospy
    from mhri.msg import DriveState
    return rospy.wait_for_message(graph.DRIVE_STATE, DriveState, 60.0)


def test_2000_velocity_topics(fire):
    import rosgraph
    import rospy
    rospy.set_param('/bot1/mhri/command', ['cmd_vel'] + [
        'v{}'.format(number) for number in range(TOPICS - 1)])
    wait_for(lambda: '{} velocity topics'.format(TOPICS) in fire.mux.tail(),
             what='the word that they are too many')
    fire.drive()
    published = [topic for topic, nodes in rosgraph.Master('/attacker').getSystemState()[0]
                 if '/mux' in nodes and topic.startswith('/bot1/')]
    print('\nMEASURED {} velocity topics: {} published'.format(TOPICS, len(published)))
    assert len(published) <= 12, published
    fire.stop_all()
    fire.check_straight()


def test_20000_names_and_the_operator_is_killed(fire):
    names = list(ROBOTS) + ['robot{}'.format(number) for number in range(NAMES - len(ROBOTS))]
    fire.operator.stdin.close()
    fire.operator.wait(60)
    fire.processes.remove(fire.backend)
    # Who speaks while the seat is still that of another one is refused, and stays so.
    wait_for(lambda: not drive_state().operator, what='an empty seat')
    fire.operator = fire.speaker(OPERATOR)
    tell(fire.operator, ' '.join(names))
    state = wait_for(lambda: [state for state in [drive_state()]
                              if state.operator.startswith('/operator_process')],
                     what='the operator to be in control')[0]
    assert len(state.robots) <= 64 and all(len(robot.name) <= 64 for robot in state.robots)
    fire.drive(by_panel=False)
    since = time.monotonic()
    os.kill(fire.operator.pid, signal.SIGKILL)
    took = fire.zeros(since, 'operator of {} names killed: last first zero'.format(NAMES))
    fire.operator.wait(20)
    fire.check_stands(since + took)
    table({name: sizes for name, sizes in fire.begun.items() if name != 'backend'}, fire.sizes())
    fire.check_alive()
    fire.check_straight()
    assert '{} names'.format(NAMES) in fire.mux.tail(), 'nobody says that they are too many'
