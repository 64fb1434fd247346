# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Sends the acts that the drive orders to the accessories of one robot, and reads what they report.

A moving part is ended like the robot itself: the process that stands by holds a duplicate of every
connection to one (:mod:`mhri.graph.ros.undertaker`), and writes its neutral value, its reported
position or the cancel of its goals when the drive is killed or hangs.
"""
from functools import partial
import io
import math
import struct
import threading
import time
import uuid

from actionlib_msgs.msg import GoalID
import genpy
import rospy

from mhri.base.accessories import ACTION, HELD, POSITION, READOUT, SERVICE, STOP, TOPIC
from mhri.base.names import topic_of
from mhri.base.reasons import NO_LISTENER, Reason
from mhri.driving.accessory_rule import choice_of
from mhri.graph.ros.messages import message_class, MessageMissing, read_field, with_field
from mhri.graph.ros.non_blocking import NonBlockingPublisher
from mhri.graph.ros.rospy_inside import field_type, listeners, unsubscribe
from mhri.graph.ros.undertaker import MAX_FRAME
from mhri.robots.listeners import obeying

# Maximum number of calls of a service without an answer: more are dropped.
MAX_CALLS = 3
# For how long an accessory says why its last act had no effect [s]; then it may be tried again.
ANSWER_S = 3.0
#: prefix of the goal ids of this program
PREFIX = 'mhri:'


def filled(message, pairs):
    """Return a message with fields set by their dotted names, converted to the fields' types.

    :raises MessageMissing: a field is missing, or does not take its value
    """
    for name, value in pairs:
        try:
            with_field(message, name, _of_type(message, name, value))
        except (AttributeError, TypeError, ValueError):
            raise MessageMissing('{} has no field {} for {!r}'.format(
                message._type, name, value)) from None
    return message


def _of_type(message, name, value):
    """Return a value as the type of a field."""
    if name.endswith(']'):
        outer, _, inner = name.partition('[')[0].rpartition('.')
        kind = field_type(read_field(message, outer) if outer else message, inner)
        return value if kind.startswith('float') else round(value)
    kind = type(read_field(message, name))
    if isinstance(value, tuple) != (kind in (list, bytes)):
        raise TypeError('one is an array, the other is not')
    if kind is int:
        return round(value)
    return kind(value) if kind in (bool, float, list, bytes) else value


def packed(message):
    """Return a message as bytes after their length, as TCPROS sends it.

    :raises MessageMissing: a field does not take its value
    """
    buffer = io.BytesIO()
    try:
        message.serialize(buffer)
    except (genpy.SerializationError, TypeError, ValueError) as error:
        raise MessageMissing('{}: {}'.format(message._type, error)) from None
    return struct.pack('<I', buffer.tell()) + buffer.getvalue()


def _is_heard(publisher, robot):
    """Return whether any node of a robot subscribes; a recorder does not count."""
    return any(obeying(robot, [listeners(publisher.links())]))


def _check_listener(publisher, robot):
    """Check that a node of a robot would get a message that is sent only once.

    :raises MessageMissing: none would
    """
    publisher.drop_ended()
    if not _is_heard(publisher, robot):
        raise MessageMissing('not delivered: ' + Reason(NO_LISTENER).sentence)


class _Topic:
    """An accessory behind a topic."""

    def __init__(self, spec, robot, topic, watch):
        self._spec, self._robot, self._kind = spec, robot, message_class(spec.type)
        for word, _ in spec.choices:
            self._frame(word, ())
        self._final = b''
        if spec.kind in HELD:
            frame = self._frame('', spec.neutral)
            self._final = b'' if spec.mode == POSITION else frame
            if len(frame) > MAX_FRAME:
                raise MessageMissing('{} is longer than {} bytes'.format(spec.type, MAX_FRAME))
        # What is held ends with the drive, a lamp as well.
        options = {'watch': partial(self._watch, watch)} if spec.kind in HELD else {}
        self._publisher = NonBlockingPublisher(topic, self._kind, **options)

    def _watch(self, watch, end):
        return watch(end, zero=self._final, repeats=self._spec.mode != POSITION)

    def _frame(self, choice, value):
        return packed(filled(self._kind(), zip(self._spec.fields, value) if value
                             else dict(self._spec.choices)[choice]))

    def send(self, act):
        """Publish an act.

        :raises MessageMissing: nobody would get it, and it will not be repeated
        """
        if self._spec.kind not in HELD:
            _check_listener(self._publisher, self._robot)
        self._publisher.publish_packed(self._frame(act.choice, act.value), urgent=act.ends)

    def on_report(self, value):
        """Let the process that stands by end the motion at the position reported now."""
        if self._spec.mode != POSITION or self._spec.on_stop != STOP:
            return
        self._final = self._frame('', value) if all(map(math.isfinite, value)) else b''
        for link in self._publisher.links():
            link.line.store_final_frames(self._final)

    def heard(self):
        """Return whether any node of the robot subscribes; a recorder does not count."""
        return _is_heard(self._publisher, self._robot)

    def close(self):
        self._publisher.unregister()


class _Action:
    """An accessory behind an action: goals out, cancels out, and the end of the last goal."""

    def __init__(self, spec, robot, topic, watch, on_finished):
        self._spec, self._robot, self._on_finished = spec, robot, on_finished
        self._kind = message_class(spec.type + 'ActionGoal')
        for word, _ in spec.choices:
            self._goal(word)
        self._id = ''
        self._publisher = NonBlockingPublisher(topic + '/goal', self._kind)
        # Without an id and a time it ends every goal.
        self._cancel = NonBlockingPublisher(
            topic + '/cancel', GoalID, watch=partial(watch, zero=packed(GoalID()), repeats=False))
        self._results = rospy.Subscriber(
            topic + '/result', message_class(spec.type + 'ActionResult'), self._on_result,
            queue_size=10, tcp_nodelay=True)

    def _goal(self, choice, name=''):
        message = self._kind()
        message.goal_id.id = name
        filled(message.goal, dict(self._spec.choices)[choice])
        packed(message)
        return message

    def send(self, act):
        """Send a goal, or cancel them all; no goal before the cancel is in safe hands.

        :raises MessageMissing: the goal was not sent
        """
        if act.ends:
            self._cancel.publish(GoalID(), urgent=True)
            return
        links = self._cancel.links()
        try:
            _check_listener(self._publisher, self._robot)
            if self._spec.moves and not (links and all(link.line.watched for link in links)):
                raise MessageMissing('nobody could cancel it yet: try again')
        except MessageMissing:
            self._on_finished()
            raise
        for link in links:
            link.line.moves()
        self._id = PREFIX + uuid.uuid4().hex
        message = self._goal(act.choice, self._id)
        message.header.stamp = message.goal_id.stamp = rospy.Time.now()
        self._publisher.publish(message)

    def _on_result(self, message):
        if message.status.goal_id.id == self._id:
            self._on_finished()

    def heard(self):
        """Return whether any node of the robot subscribes; a recorder does not count."""
        return _is_heard(self._publisher, self._robot)

    def close(self):
        for end in (self._publisher, self._cancel):
            end.unregister()
        unsubscribe(self._results)


class _Service:
    """An accessory behind a service: each call on its own thread, since a server may hang."""

    def __init__(self, spec, name, on_answer):
        self._spec, self._name, self._on_answer = spec, name, on_answer
        self._kind = message_class(spec.type, 'srv')
        for word, _ in spec.choices:
            packed(self._request(self._proxy(), word))
        self._calls = threading.BoundedSemaphore(MAX_CALLS)

    def _proxy(self):
        return rospy.ServiceProxy(self._name, self._kind)

    def _request(self, proxy, choice):
        return filled(proxy.request_class(), dict(self._spec.choices)[choice])

    def send(self, act):
        """Call the service; return at once.

        :raises MessageMissing: it has not answered the last calls
        """
        if not self._calls.acquire(blocking=False):
            raise MessageMissing('{} does not answer'.format(self._name))
        threading.Thread(target=self._call, args=(act,), daemon=True,
                         name='accessory ' + self._spec.key).start()

    def _call(self, act):
        """Call the service, and pass on what is wrong, '' for nothing."""
        try:
            proxy = self._proxy()
            answer = proxy(self._request(proxy, act.choice))
            problem = '' if getattr(answer, 'success', True) else (
                getattr(answer, 'message', '') or 'refused')
        except (rospy.ServiceException, rospy.ROSException) as error:
            problem = str(error)
        finally:
            self._calls.release()
        self._on_answer(problem)

    @staticmethod
    def heard():
        """Return True: only a call shows whether a service answers."""
        return True

    def close(self):
        pass


class AccessoryLines:
    """The connections to the accessories of one robot; not thread-safe but for its callbacks.

    :param name: the robot
    :param robot_type: :class:`mhri.base.robot_types.RobotType`
    :param watch: see :class:`NonBlockingPublisher`
    :param on_report: called with (key, values, choice), on a thread of ROS
    :param on_finished: called with a key once its goal has ended, on a thread of ROS
    :param clock: function that returns monotonic seconds
    """

    def __init__(self, name, robot_type, watch, on_report, on_finished, clock=time.monotonic):
        self._name, self._clock = name, clock
        self._on_report = on_report
        self._ways, self._reports, self._ears = {}, [], []
        # {key: (why it cannot be used or did not act, as a sentence; until when that counts)}
        self._problems = {}
        for spec in robot_type.accessories:
            if spec.kind == READOUT:
                continue  # nothing is sent to it, and its readers subscribe it themselves
            topic = topic_of(name, spec.name)
            try:
                make = {TOPIC: partial(_Topic, spec, name, topic, watch),
                        ACTION: partial(_Action, spec, name, topic, watch,
                                        partial(on_finished, spec.key)),
                        SERVICE: partial(_Service, spec, topic, partial(self._answer, spec.key))}
                self._ways[spec.key] = make[spec.way]()
                if spec.state is not None:
                    self._reports.append((spec, message_class(spec.state.kind)))
            except MessageMissing as error:
                if not spec.optional:
                    self._note(spec.key, str(error))

    def _note(self, key, problem, until=math.inf):
        """Store why an accessory cannot be used or did not act, '' for nothing."""
        if problem and problem != self._problem(key):
            rospy.logwarn('%s: %s: %s', self._name, key, problem)
        self._problems[key] = problem, until

    def _answer(self, key, problem):
        """Store why the last act had no effect, '' if it had one; it may be tried again."""
        self._note(key, problem, self._clock() + ANSWER_S)

    def _problem(self, key):
        """Return what was stored, '' for nothing."""
        problem, until = self._problems.get(key, ('', math.inf))
        return problem if self._clock() < until else ''

    def listen(self):
        """Subscribe what accessories report, once the drive has the robot (blocking).

        A report before that would be lost, and many are published only once, latched.
        """
        self._ears = [rospy.Subscriber(
            topic_of(self._name, spec.state.name), kind, partial(self._on_state, spec),
            queue_size=1, tcp_nodelay=True) for spec, kind in self._reports]

    def _on_state(self, spec, message):
        try:
            found = [read_field(message, name) for name in spec.state.fields]
            value = tuple(map(float, found))
        except (AttributeError, TypeError, ValueError) as error:
            self._note(spec.key, 'its state cannot be read: {}'.format(error))
            return
        self._on_report(spec.key, value, choice_of(spec, found))

    def on_report(self, key, value):
        """Update the last words about an accessory by its reported position; hold the lock."""
        if hasattr(self._ways[key], 'on_report'):
            self._ways[key].on_report(value)

    def send(self, act):
        """Send an act that the drive orders."""
        way = self._ways.get(act.key)
        if way is None:
            return
        try:
            way.send(act)
            if self._problem(act.key) and not isinstance(way, _Service):
                self._answer(act.key, '')
        except MessageMissing as error:
            self._answer(act.key, str(error))

    def stands(self, key):
        """Return why nothing obeys an act: a code or a sentence, '' if somebody does."""
        way = self._ways.get(key)
        return self._problem(key) or (
            '' if way is not None and way.heard() else NO_LISTENER)

    def close(self):
        """Unregister everything (blocking: calls the master)."""
        for way in self._ways.values():
            way.close()
        for ear in self._ears:
            unsubscribe(ear)
