# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A host and a robot on masters of their own, linked by mhri_link, and an operator of the test's.

The robot is witnessed on its own master, by a process there: what the host sees proves nothing
while the link is down.
"""
import collections
import sys
import threading
import time

from support import graph
from support.paths import SUPPORT
from support.ros_system import child_processes, free_port, System, wait_for

# Slow computers start slowly.
LONG_S = 90.0


class Operator:
    """Selects bot1 and holds a stick, on threads of its own."""

    def __init__(self):
        import rospy
        from mhri.msg import ControlMode, RobotSelect
        from support.robots import Stick
        self.stick = Stick()
        self._mode = rospy.Publisher(graph.MODE_SELECT, ControlMode, queue_size=1, latch=True)
        self._select = rospy.Publisher(graph.SELECT, RobotSelect,
                                       queue_size=1, latch=True)
        self._mode.publish('pedal')
        threading.Thread(target=self._run, args=(rospy.is_shutdown,), daemon=True).start()

    def _run(self, ended):
        while not ended():
            self._select.publish(robots=['bot1'])
            time.sleep(0.3)


class Linked:
    """The two systems.

    :param protocol: such as ``tcp`` or ``tls``
    :param call: called with the robot's endpoint, returns that which the host calls
    :param robot_keys: a folder with keys, or ``off``; so ``host_keys``
    """

    def __init__(self, protocol='tcp', robot_keys='off', host_keys='off', call=lambda end: end):
        self._states = collections.deque(maxlen=1)
        self._host_keys = str(host_keys)
        self.host = System()
        self.robot = System(adopt=False)
        self.endpoint = '{}/127.0.0.1:{}'.format(protocol, free_port())
        self._called = call(self.endpoint)
        for system in (self.host, self.robot):
            system.start_master()
        self.robot.launch('turtlebot.launch', 'name:=bot1', 'type:=turtlebot3_waffle', 'x:=2.0',
                          'y:=1.5')
        self.link_of_robot = self.robot.launch(
            'link.launch', 'side:=robot', 'name:=bot1', 'listen:=' + self.endpoint,
            'keys:={}'.format(robot_keys))
        self.observer = self.robot.start(sys.executable, str(SUPPORT / 'observer.py'), 'bot1')
        self.host.node('mux', '__name:=mux')
        self.link_of_host = self.start_host_side()

    def start_host_side(self, *more):
        """Start the host's side; it is one process, so that it can be killed."""
        self.link_of_host = self.host.node('mhri_link', '--side', 'host', '--name', 'bot1',
                                           '--connect', self._called, '--keys', self._host_keys,
                                           '--host', 'host:lab', '__ns:=/bot1', *more)
        return self.link_of_host

    def node_of_robot(self):
        """Return the process of the robot's side, which roslaunch starts again if it is killed."""
        return wait_for(lambda: child_processes('/mhri_link', self.link_of_robot.pid), LONG_S,
                        'the side of the robot')[0]

    def join(self, name):
        """Be a node of the host, with an operator and an eye on the robot."""
        import rospy
        from mhri.graph.ros.master_watch import MasterWatch
        from mhri.msg import DriveState
        from support.robots import Witness
        rospy.init_node(name, disable_signals=True)
        MasterWatch().start()
        rospy.Subscriber(graph.DRIVE_STATE, DriveState, self._states.append, queue_size=1)
        self.operator, self.witness = Operator(), Witness('bot1')

    def row(self):
        """Return what the mux said last of bot1."""
        return wait_for(lambda: next((drive for drive in (
            self._states[-1].robots if self._states else ()) if drive.name == 'bot1'), None),
            LONG_S, 'the mux to know bot1')

    def rows(self):
        """Return what the robot did, by its own odometry: (time, m/s, rad/s) in a list."""
        with open(self.observer.log) as log:
            rows = [line.split() for line in log.read().splitlines()[-400:]]
        return [tuple(map(float, row[:3])) for row in rows if len(row) == 5]

    def moves(self):
        """Return whether the robot moves now."""
        rows = self.rows()
        return bool(rows) and time.monotonic() - rows[-1][0] < 0.5 and abs(rows[-1][2]) > 0.05

    def stood_at(self, since):
        """Return when it began to stand still for three readings in a row, None if it moves."""
        rows = [row for row in self.rows() if row[0] >= since]
        for index in range(len(rows) - 2):
            if all(abs(row[1]) < 0.01 and abs(row[2]) < 0.02 for row in rows[index:index + 3]):
                return rows[index][0]
        return None

    def drive(self, operator, timeout_s=LONG_S):
        """Turn the robot on the spot, from rest; the mux asks for neutral first."""
        self.let_stand(operator)
        operator.stick.drive(0.0, 0.4, self.moves, timeout_s, 'bot1 to move')

    def let_stand(self, operator):
        """Centre the stick, and wait until the robot stands."""
        operator.stick.hold(0.0, 0.0)
        wait_for(lambda: not self.moves(), LONG_S, 'bot1 to stand', 0.01)

    def close(self):
        """End both systems."""
        self.robot.close()
        self.host.close()


def running_linked():
    """Yield a :class:`Linked` that has joined, for a fixture."""
    import rospy
    from mhri.link.ros.carrier import load_library
    # Without it, this says the remedy.
    load_library()
    built = Linked()
    try:
        built.join('link_test')
        wait_for(built.witness.live, LONG_S, 'the odometry of bot1 on the host')
        yield built
    finally:
        built.close()
        rospy.signal_shutdown('done')
