# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A robot gets a whole zero whenever the program that drives it ends, at whichever byte."""
import contextlib
import os
import random
import resource
import signal
import socket
import struct
import time

import pytest

from mhri.graph.ros.undertaker import bytes_written, FinalFrames, shared_memory, Undertaker
from support.ros_system import wait_for


def twist(number):
    """Return a ``geometry_msgs/Twist`` with its length before it."""
    return struct.pack('<I6d', 48, number, 0.0, 0.0, 0.0, 0.0, 0.0)


ZERO, STOP = twist(0.0), twist(-0.0)


class Robot:
    """A subscriber as rospy's: it hangs up on what is no message, and keeps its last velocity."""

    def __init__(self):
        self.server = socket.create_server(('127.0.0.1', 0))
        self.end = socket.create_connection(self.server.getsockname())
        self.driver = self.server.accept()[0]
        self.driver.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self.end.setblocking(False)
        self.frames, self._got = [], b''

    def hear(self):
        """Read what there is; return the last whole message, None before the first."""
        with contextlib.suppress(BlockingIOError):
            while True:
                got = self.end.recv(65536)
                if not got:
                    break
                self._got += got
        while len(self._got) >= 52:
            assert self._got[:4] == twist(0)[:4], 'the robot hangs up: garbage'
            self.frames.append(self._got[:52])
            self._got = self._got[52:]
        return self.frames[-1] if self.frames else None

    def close(self):
        for end in (self.server, self.end, self.driver):
            end.close()


class World:
    """A parent, and children that drive."""

    def __init__(self):
        self.shared = shared_memory()
        hears, self.passes = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        hears.setblocking(False)
        self.said = []
        self.parent = FinalFrames(self.shared, hears, self.said.append)
        self.robots = []

    def robot(self):
        self.robots.append(Robot())
        return self.robots[-1]

    def child(self, drive):
        """Let a child call ``drive(undertaker)``; return its number once it has taken its lines."""
        child = os.fork()
        if not child:
            with contextlib.suppress(BaseException):
                self.parent.close()
                drive(Undertaker(self.shared, self.passes))
            os.kill(os.getpid(), signal.SIGKILL)
        for robot in self.robots:
            robot.driver.close()
        return child

    def bury(self, child):
        """Wait for the end of a child, and do what the parent does then."""
        while not os.waitpid(child, os.WNOHANG)[0]:
            self.parent.tick(time.monotonic())
        self.buried_at = time.monotonic()
        return self.parent.stop(self.buried_at)

    def close(self):
        self.parent.close()
        for end in [self.parent.hears, self.passes] + self.robots:
            end.close()


@pytest.fixture
def world():
    made = World()
    yield made
    made.close()


def watched(line):
    wait_for(lambda: line.watched, what='the parent')
    return line


@pytest.mark.parametrize('before', [0, 3])
def test_half_a_frame_is_finished_before_the_zero_at_every_byte(world, before):
    for count in range(53):
        robot = world.robot()

        def drive(undertaker):
            line = watched(undertaker.watch(robot.driver, ZERO, True))
            line.moves()
            for number in range(1, 1 + before):
                line.about_to_send(twist(number))
                line.sent(robot.driver.send(twist(number)))
            line.about_to_send(twist(9.0))
            robot.driver.send(twist(9.0)[:count])

        world.bury(world.child(drive))
        wait_for(lambda: robot.hear() == ZERO, 60.0, 'a zero behind {} bytes'.format(count))
        assert robot.frames[:-1] == [twist(number) for number in range(1, 1 + before)] + (
            [twist(9.0)] if count else [])


def test_killed_at_any_moment_it_leaves_a_whole_zero(world):
    """Also while the robot reads slowly, and its buffer takes a part of a message."""
    for _ in range(30):
        robot = world.robot()
        robot.driver.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, 4608)
        robot.end.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 2304)

        def drive(undertaker):
            line = watched(undertaker.watch(robot.driver, ZERO, True))
            line.moves()
            for number in range(1, 10 ** 9):
                line.about_to_send(twist(number))
                rest = twist(number)
                while rest:  # as if the kernel took a part at a time
                    count = robot.driver.send(rest[:random.randint(1, 52)])
                    line.sent(count)
                    rest = rest[count:]

        child = world.child(drive)
        wait_for(lambda: (world.parent.tick(time.monotonic()), robot.hear())[1], 60.0,
                 'motion')
        until = time.monotonic() + random.uniform(0.0, 0.03)
        while time.monotonic() < until:
            world.parent.tick(time.monotonic())
            time.sleep(0.001)
        os.kill(child, signal.SIGKILL)
        world.bury(child)
        wait_for(lambda: (world.parent.tick(time.monotonic()), robot.hear() == ZERO)[1], 60.0,
                 'the zero')
        moved = [frame for frame in robot.frames if frame != ZERO]
        assert moved == [twist(number) for number in range(1, 1 + len(moved))]


def test_what_the_kernel_was_given_is_known_to_the_byte(world):
    robot = world.robot()
    begun = bytes_written(robot.driver)
    for count in range(1, 200):
        robot.driver.send(bytes(1))
        assert bytes_written(robot.driver) - begun == count
        if count % 3 == 0:
            robot.end.recv(2)
    with socket.socketpair()[0] as end:
        assert bytes_written(end) is None


def test_zeros_are_repeated_until_the_next_program_speaks_and_no_robot_that_stood_gets_one(world):
    driven, idle, guarded, next_one = (world.robot() for _ in range(4))

    def drive(undertaker):
        lines = [watched(undertaker.watch(robot.driver, ZERO, robot is not guarded))
                 for robot in (driven, idle, guarded)]
        for line in (lines[0], lines[2]):
            line.moves()
        lines[1].about_to_send(ZERO)
        lines[1].sent(idle.driver.send(ZERO))

    assert world.bury(world.child(drive)) == 2
    for step in range(100):
        world.parent.tick(world.buried_at + 0.005 * step)
        time.sleep(0.001)
    assert driven.hear() == ZERO and 7 <= len(driven.frames) <= 11
    assert guarded.hear() == ZERO and len(guarded.frames) == 1, 'its guard has a lease'
    assert idle.hear() == ZERO and len(idle.frames) == 1, 'its own'
    undertaker = Undertaker(world.shared, world.passes)
    undertaker.watch(next_one.driver, ZERO, True).about_to_send(ZERO)
    world.parent.tick(time.monotonic())
    heard = len(driven.frames)
    for _ in range(30):
        world.parent.tick(time.monotonic())
        time.sleep(0.005)
    driven.hear()
    assert len(driven.frames) - heard <= 1 and driven.end.recv(1) == b'', 'it is closed, too'


def test_zeros_end_after_a_while_without_a_next_program(world):
    robot = world.robot()
    world.bury(world.child(lambda undertaker: watched(undertaker.watch(
        robot.driver, ZERO, True)).moves()))
    for step in range(100):
        world.parent.tick(world.buried_at + 0.05 * step)
    robot.hear()
    assert 30 <= len(robot.frames) <= 62 and not world.parent.busy(), 'three seconds of them'


@pytest.mark.parametrize('moves, pressed, words', [
    (True, False, ZERO), (True, True, STOP), (False, True, STOP), (False, False, None)])
def test_a_guard_is_stopped_while_a_stop_is_in_force_and_else_not(world, moves, pressed, words):
    """A zero without the sign of a stop would release one that the guard holds."""
    robot = world.robot()

    def drive(undertaker):
        line = watched(undertaker.watch(robot.driver))
        line.store_final_frames(twist(7.0), twist(8.0))
        line.store_final_frames(ZERO, STOP)
        undertaker.stop(pressed)
        if moves:
            line.moves()

    world.bury(world.child(drive))
    if words is None:
        wait_for(lambda: robot.hear() is None and world.parent.busy() is False, 5.0, 'nothing')
    else:
        wait_for(lambda: robot.hear() == words, 60.0, 'its words')


def test_a_connection_that_has_ended_is_closed_and_its_slot_used_for_another(world):
    undertaker = Undertaker(world.shared, world.passes)
    for _ in range(1500):
        robot = Robot()
        line = undertaker.watch(robot.driver, ZERO, True)
        assert not line.watched, 'not before the parent says so'
        world.parent.tick(time.monotonic())
        assert line.watched
        line.moves()
        line.forget()
        assert not line.watched
        line.about_to_send(twist(1.0))
        world.parent.tick(time.monotonic())
        robot.close()
    assert world.parent.stop(time.monotonic()) == 0


def test_a_duplicate_for_which_there_was_no_room_is_passed_again(world):
    robot = world.robot()
    line = Undertaker(world.shared, world.passes).watch(robot.driver, ZERO, True)
    limits = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (3, limits[1]))
    try:
        world.parent.tick(time.monotonic())
    finally:
        resource.setrlimit(resource.RLIMIT_NOFILE, limits)
    assert not line.watched and 'no descriptor' in world.said[0]
    wait_for(lambda: (world.parent.tick(time.monotonic()), line.watched)[1], 60.0, 'its turn')
    assert len(world.said) == 1


def test_more_connections_than_there_is_room_for_are_not_watched(world):
    robot = world.robot()
    undertaker = Undertaker(world.shared, world.passes)
    lines = []
    for _ in range(1030):
        lines.append(undertaker.watch(robot.driver, ZERO, True))
        world.parent.tick(time.monotonic())
    found = [line.watched for line in lines]
    assert found.count(True) == 1023 and found[:1023] == [True] * 1023
    lines[5].forget()
    world.parent.tick(time.monotonic())
    line = undertaker.watch(robot.driver, ZERO, True)
    world.parent.tick(time.monotonic())
    assert line.watched


def test_the_child_knows_whether_the_parent_works(world):
    undertaker, begun = Undertaker(world.shared, world.passes), time.monotonic()
    for _ in range(4):
        world.parent.tick(time.monotonic())
        assert undertaker.alive()
    wait_for(lambda: not undertaker.alive(), what='its silence')
    assert time.monotonic() - begun > 1.2
    world.parent.tick(time.monotonic())
    assert undertaker.alive()


def test_without_a_parent_everything_counts_as_watched():
    undertaker = Undertaker()
    robot = Robot()
    with contextlib.closing(robot):
        assert undertaker.watch(robot.driver, ZERO, True).watched and undertaker.alive()


def test_nothing_is_sent_into_a_buffer_that_is_not_nearly_empty(world):
    robot = world.robot()
    line = Undertaker().watch(robot.driver, ZERO)
    robot.end.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 2304)
    assert line.has_room(False) and line.has_room(True)
    with contextlib.suppress(BlockingIOError):
        while line.has_room(True):
            robot.driver.send(twist(1.0), socket.MSG_DONTWAIT)
            if not line.has_room(False):
                assert line.has_room(True) or bytes_written(robot.driver) > 4096
    assert not line.has_room(False)
    with pytest.raises(ValueError):
        line.about_to_send(bytes(256))
