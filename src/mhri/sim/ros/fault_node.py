# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The faults of a simulated robot on ROS: the service to set them, and their effects.

Serves ``/<robot>/base/set_fault`` (``mhri/SetFault``) with the faults of :mod:`mhri.sim.faults`.
A fault that does not apply to the robot, e.g. of a missing battery, is refused. Publishes the
active faults on ``/<robot>/base/faults`` (``std_msgs/String``, latched, on change), a phrase a
line, which no fault affects.
"""
import copy
import functools
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
# Name of the person's slot in the shared world; not a valid name of a robot.
PERSON_NAME = 'person {}'
# Longer than any client's timeout for a frozen computer.
FROZEN_S = 60.0


class Person:
    """A person in the way of one robot, visible to all robots.

    :param path: of the shared world
    """

    def __init__(self, robot, path, clock):
        self._world = World(path, PERSON_NAME.format(robot)[:64], PERSON, clock)
        self._place = None

    def stand(self, x, y):
        """Place the person at x, y [m]."""
        self._place = x, y
        self.stay()

    def stay(self):
        """Refresh the pose, which would otherwise expire."""
        self._world.publish(*self._place, 0.0)

    def leave(self):
        """Remove the person."""
        self._world.leave()


class Healthy:
    """A robot without faults."""

    def stamp(self):
        """Return the time of its clock."""
        return rospy.Time.now()

    def send(self, publisher, message, kind=''):
        """Publish a message."""
        publisher.publish(message)


class Failing:
    """The faults of one robot; all its messages and commands pass through this object.

    :param name: the robot
    :param template: :class:`mhri.base.robot_types.RobotType`
    :param body: :class:`mhri.sim.body.Body`
    :param world_path: of the building's shared world
    :param distance: function (x, y) -> metres to the nearest fixed obstacle
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
        """Start the service and the topic; to be called after ``rospy.init_node``."""
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
            self._name, '; '.join(self._book.words(self._clock())) or 'no faults active'))

    def _change(self, request):
        """Start or end a fault.

        :raises FaultRefused: the request is invalid, or does not apply to this robot
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
                # Delayed until the caller has received the response.
                threading.Timer(0.2, self._die, [checked_duration(fault, request.duration_s)]
                                ).start()

    def _put_person(self, ahead):
        """Put a person in front of the robot, at a distance [m] from its front.

        :raises FaultRefused: an obstacle is there
        """
        x, y = self._body.ahead(ahead + self._body.type.radius_m + PERSON.radius_m)
        if self._distance(x, y) < PERSON.radius_m:
            self._book.end('person')
            raise FaultRefused('person: there is no room {:g} m before {}: choose another '
                               'distance, or turn it'.format(ahead, self._name))
        self._person = self._person or Person(self._name, self._world_path, self._clock)
        self._person.stand(x, y)

    def _die(self, duration_s):
        """Exit like a crashed driver, without notice; restart later, at this pose."""
        body = self._body
        place = ['_{}:={!r}'.format(key, getattr(body, key)) for key in ('x', 'y', 'yaw')]
        arguments = [word for word in sys.argv
                     if word.partition(':=')[0] not in ('_x', '_y', '_yaw')]
        waiting = command('mhri.sim.come_back', repr(duration_s), *arguments, *place)
        os.execv(waiting[0], waiting)

    def _wait_for_link(self):
        """Wait for the delay of a request and its answer."""
        delay_s = self._book.value('delay', self._clock()) or 0.0
        given_up = self._clock() + FROZEN_S
        time.sleep(2.0 * delay_s)
        while self.has('computer_frozen') and self._clock() < given_up:
            time.sleep(0.02)

    def has(self, key):
        """Return whether the robot has a fault now."""
        return self._book.has(key, self._clock())

    def stamp(self):
        """Return the time of its clock, which may be off, as a ``rospy.Time``."""
        off_s = self._book.value('clock_off', self._clock())
        return rospy.Time.now() + rospy.Duration(off_s) if off_s else rospy.Time.now()

    def battery_per_s(self):
        """Return the extra loss of charge per second."""
        return (self._book.value('battery_falling', self._clock()) or 0.0) / 100.0 / 60.0

    def send(self, publisher, message, kind=''):
        """Publish a message, delayed or dropped by faults; thread-safe.

        :param kind: 'odometry', 'camera' or 'scan' for streams that can fail alone
        """
        now = self._clock()
        if kind and self._book.has(kind + '_silent', now) or self.has('computer_frozen'):
            return
        delay_s, loss = self._book.link(now)
        if not (delay_s or loss or self._out):
            publisher.publish(message)
            return
        with self._lock:
            # A copy, since the caller reuses the message.
            kept = functools.partial(publisher.publish, copy.deepcopy(message))
            if not self._out.put(kept, now, delay_s, loss):
                skip_number(publisher)

    def command(self, velocity):
        """Pass a command to the body, subject to faults; return whether it is accepted."""
        self.receive(lambda now: self._body.command(
            velocity.linear_mps, velocity.angular_rad_s, now, velocity.lateral_mps))
        return velocity.is_finite()

    def receive(self, act):
        """Call a function of the time [s] for a message that came; delayed or dropped by faults."""
        now = self._clock()
        if self.has('computer_frozen'):
            return
        delay_s, loss = self._book.link(now)
        if not (delay_s or loss or self._in):
            act(now)
            return
        with self._lock:
            self._in.put(act, now, delay_s, loss)

    def step(self):
        """Advance the faults; to be called before each step of the body."""
        now, body = self._clock(), self._body
        with self._lock:
            messages = [] if self.has('computer_frozen') else self._out.take(now)
            received = self._in.take(now)
            if self._person is not None:
                self._care_for_person(now)
            fails = self._book.phrases(now)
        if fails != self._told:
            self._told = fails
            self._publisher.publish('\n'.join(fails))
        for act in received:
            act(now)
        self._book.weaken(body, now)
        for send in messages:
            send()

    def _care_for_person(self, now):
        if self._book.has('person', now):
            self._person.stay()
        else:
            self._person.leave()
            self._person = None

    def close(self):
        """Remove the person."""
        with self._lock:
            if self._person is not None:
                self._person.leave()
                self._person = None
