# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The faults of a simulated robot on ROS: the service that asks for them, and what they keep back.

``/<robot>/base/set_fault`` (``mhri/SetFault``); the table is :mod:`mhri.sim.faults`. A robot
that has no such fault, e.g. no battery to fall, refuses it. ``/<robot>/base/faults``
(``std_msgs/String``, latched, on change) says what fails now, a phrase a line, and never fails.
"""
import copy
import functools
import math
import os
import random
import sys
import threading
import time

import rospy
from std_msgs.msg import String

from mhri.base.config import short
from mhri.devices.io.child import command
from mhri.graph.ros.rospy_inside import answer_late, skip_number
from mhri.sim.body import BodyType
from mhri.sim.delay_line import DelayLine
from mhri.sim.faults import ALL, checked_duration, fault_named, FaultBook, FaultRefused
from mhri.sim.world import World, WorldFull, WorldRefused
from mhri.srv import SetFault, SetFaultResponse

PERSON = BodyType(0.25, 1.7, 1.0, 1.0, 1.0, 1.0, 1.0, 0.1, 1.0, colour=(60, 90, 160))
# How the person's place in the shared world is called: no robot can have such a name.
PERSON_NAME = 'person {}'
# Whoever waits for a frozen computer gives up sooner.
FROZEN_S = 60.0


class Person:
    """Somebody who stands in the way of one robot, and whom all others see, too.

    :param path: of the shared world
    """

    def __init__(self, robot, path, clock):
        self._world = World(path, PERSON_NAME.format(robot)[:64], PERSON, clock)
        self._place = None

    def stand(self, x, y):
        """Stand at x, y [m]."""
        self._place = x, y
        self.stay()

    def stay(self):
        """Say again where, as whoever is still there does."""
        self._world.publish(*self._place, 0.0)

    def leave(self):
        """Go away."""
        self._world.leave()


class Healthy:
    """A robot of which nothing ever fails."""

    def stamp(self):
        """Return the time of its clock."""
        return rospy.Time.now()

    def send(self, publisher, message, kind=''):
        """Publish a message."""
        publisher.publish(message)


class Failing:
    """Whatever fails of one robot: what it sends and is sent goes through here.

    :param name: the robot
    :param template: :class:`mhri.base.robot_types.RobotType`
    :param body: :class:`mhri.sim.body.Body`
    :param world_path: of the building's shared world
    :param distance: function (x, y) -> metres to the nearest fixed thing
    """

    def __init__(self, name, template, body, world_path, distance, clock=time.monotonic):
        self._name = name
        self._lacks = {key: what for key, what, topics in (
            ('camera_silent', 'camera', template.rgb or template.depth),
            ('scan_silent', 'laser', template.scan),
            ('battery_falling', 'battery that reports', template.battery)) if not topics}
        self._body = body
        self._world_path = world_path
        self._distance = distance
        self._clock = clock
        self._book = FaultBook()
        self._lock = threading.Lock()
        self._out, self._in = DelayLine(random.random), DelayLine(random.random)
        self._person = None
        self._told, self._publisher = None, None

    def serve(self):
        """Offer service and topic; call it after ``rospy.init_node``."""
        self._publisher = rospy.Publisher('~faults', String, queue_size=10, latch=True)
        answer_late(self._wait_for_link)
        rospy.Service('~set_fault', SetFault, self._on_call)

    def _on_call(self, request):
        try:
            if request.fault:
                self._change(request)
        except (FaultRefused, WorldFull, WorldRefused, OSError) as error:
            return SetFaultResponse(False, short(error))
        return SetFaultResponse(True, '{}: {}'.format(
            self._name, '; '.join(self._book.words(self._clock())) or 'nothing fails'))

    def _change(self, request):
        """Begin or end a fault.

        :raises FaultRefused: see there
        """
        key = request.fault
        with self._lock:
            if request.duration_s < 0.0:
                self._book.end(key)
                return
            if key == ALL:
                raise FaultRefused('all: a duration below 0 ends all faults; name one to begin it')
            fault = fault_named(key)
            if key in self._lacks:
                raise FaultRefused('{}: {} has no {}'.format(key, self._name, self._lacks[key]))
            now = self._clock()
            self._book.begin(key, request.value, request.duration_s, now)
            rospy.logwarn('%s fails on request: %s', self._name,
                          fault.words(self._book.value(key, now)))
            if key == 'person':
                self._put_person(self._book.value(key, now))
            elif key == 'node_dead':
                # Not before the caller has its answer.
                threading.Timer(0.2, self._die, [checked_duration(fault, request.duration_s)]
                                ).start()

    def _put_person(self, ahead):
        """Put somebody before the robot, so many metres from its front.

        :raises FaultRefused: a wall is there
        """
        body, away = self._body, ahead + self._body.type.radius_m + PERSON.radius_m
        x, y = body.x + away * math.cos(body.yaw), body.y + away * math.sin(body.yaw)
        if self._distance(x, y) < PERSON.radius_m:
            self._book.end('person')
            raise FaultRefused('person: there is no room {:g} m before {}: choose another '
                               'distance, or turn it'.format(ahead, self._name))
        self._person = self._person or Person(self._name, self._world_path, self._clock)
        self._person.stand(x, y)

    def _die(self, duration_s):
        """End as a crashed driver does, without a word; come back after a while, standing here."""
        body = self._body
        place = ['_{}:={!r}'.format(key, getattr(body, key)) for key in ('x', 'y', 'yaw')]
        arguments = [word for word in sys.argv
                     if word.partition(':=')[0] not in ('_x', '_y', '_yaw')]
        waiting = command('mhri.sim.come_back', repr(duration_s), *arguments, *place)
        os.execv(waiting[0], waiting)

    def _wait_for_link(self):
        """Wait as long as a question and its answer are under way."""
        delay_s = self._book.value('delay', self._clock()) or 0.0
        given_up = self._clock() + FROZEN_S
        time.sleep(2.0 * delay_s)
        while self.has('computer_frozen') and self._clock() < given_up:
            time.sleep(0.02)

    def has(self, key):
        """Tell whether the robot has a fault now."""
        return self._book.has(key, self._clock())

    def stamp(self):
        """Return the time of its clock, which may be off, as a ``rospy.Time``."""
        off_s = self._book.value('clock_off', self._clock())
        return rospy.Time.now() + rospy.Duration(off_s) if off_s else rospy.Time.now()

    def battery_per_s(self):
        """Return how much of its charge it loses beyond what is usual, each second."""
        return (self._book.value('battery_falling', self._clock()) or 0.0) / 100.0 / 60.0

    def send(self, publisher, message, kind=''):
        """Publish a message, unless a fault keeps it; call it on any thread.

        :param kind: 'odometry', 'camera' or 'scan' for what falls silent by itself
        """
        now = self._clock()
        if kind and self._book.has(kind + '_silent', now) or self.has('computer_frozen'):
            return
        delay_s, loss = self._link(now)
        if not (delay_s or loss or self._out):
            publisher.publish(message)
            return
        with self._lock:
            # Its owner fills the same message again.
            kept = functools.partial(publisher.publish, copy.deepcopy(message))
            if not self._out.put(kept, now, delay_s, loss):
                skip_number(publisher)

    def _link(self, now):
        """Return delay [s] and share of loss of the link, each way."""
        return (self._book.value('delay', now) or 0.0,
                (self._book.value('loss', now) or 0.0) / 100.0)

    def command(self, linear, angular):
        """Hand a command to the body as soon as a fault lets it; return whether it is accepted."""
        now = self._clock()
        if self.has('computer_frozen'):
            return True
        delay_s, loss = self._link(now)
        if not (delay_s or loss or self._in):
            return self._body.command(linear, angular, now)
        with self._lock:
            self._in.put((linear, angular), now, delay_s, loss)
        return math.isfinite(linear) and math.isfinite(angular)

    def step(self):
        """Carry on with what takes time; call it before each step of the body."""
        now, body = self._clock(), self._body
        with self._lock:
            messages = [] if self.has('computer_frozen') else self._out.take(now)
            commands = self._in.take(now)
            if self._person is not None:
                self._care_for_person(now)
            fails = self._book.phrases(now)
        if fails != self._told:
            self._told = fails
            self._publisher.publish('\n'.join(fails))
        for linear, angular in commands:
            body.command(linear, angular, now)
        slow = self._book.value('wheel_slow', now)
        body.left_share = 0.0 if self.has('motor_stuck') else 1.0 if slow is None else slow / 100.0
        body.slip = math.radians(self._book.value('drift', now) or 0.0)
        for send in messages:
            send()

    def _care_for_person(self, now):
        if self._book.has('person', now):
            self._person.stay()
        else:
            self._person.leave()
            self._person = None

    def close(self):
        """Let the person go with the robot."""
        with self._lock:
            if self._person is not None:
                self._person.leave()
                self._person = None
