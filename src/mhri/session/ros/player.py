# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Replays a session on a master of its own: what was recorded, when it was, as fast as asked for.

Publishes every recorded topic with the bytes as they were, except velocities and requests
(:func:`mhri.session.foreign.may_be_replayed`): nothing here can drive anything. Further
interfaces: ``/mhri_replay/state`` (``mhri/ReplayState``, latched, 10 Hz while playing, on change),
``/mhri_replay/heard`` (``std_msgs/UInt32``: the number of the state that a screen has heard),
service ``/mhri_replay/control`` (``mhri/ControlReplay``). It serves the services by which a screen
knows the drive and task services, and refuses whatever they are asked: a screen then believes what
they said when it was recorded.
"""
import struct
import threading
import time

import rospy
from std_msgs.msg import UInt32
from std_srvs.srv import SetBool, SetBoolResponse, Trigger, TriggerResponse

from mhri.graph.ros.in_force import STOP_SERVICE, TAKE_SERVICE
from mhri.msg import ReplayState
from mhri.recording.ros.bag_set import DAMAGED
from mhri.session.foreign import may_be_replayed
from mhri.session.playing import age_groups, Playing, RUN_UP_S
from mhri.srv import (
    ControlReplay, ControlReplayRequest, ControlReplayResponse, SetPlace, SetPlaceResponse)
from mhri.tasks.ros.tasks_client import SERVICE as TASKS_SERVICE

NOTHING_DRIVES = 'this is a replay: nothing drives'
STATE_S = 0.1
# While it pauses, what is new is repeated so often, for whoever came meanwhile [s].
REPEAT_S = 0.5
# A message that is older than this is repeated only if it was latched [s].
NEW_S = 2.0
# A large one that is late by more is left out: the next one is due [s].
LATE_S = 0.3
# Messages of a topic may come so much later than the word of a jump [s], to a screen that says
# nothing. One that says what it has heard is awaited for so long, and hears other topics as late.
HEARD_S, MOST_HEARD_S, LEAST_LAG_S = 0.15, 2.0, 0.02
# How much faster than in truth the run-up of a seek goes at most, and how much of the session
# a screen may lag behind meanwhile [s].
RUN_UP_SPEED, RUN_UP_LATE_S = 16.0, 0.3
_LARGE = frozenset(('sensor_msgs/Image', 'sensor_msgs/CompressedImage', 'sensor_msgs/PointCloud2'))
# Screens count the age of these by the session's own time: to repeat them would make them new.
_AGED = frozenset(('nav_msgs/Odometry', 'turtlesim/Pose', 'mhri/GatesState'))
# Velocities are not published; these two are told as numbers in the state.
_ASKED, _LIMITS = '/robot_controller/twist', '/mux/speed_limit'
# A command that was not repeated for so long was over [s].
ASKED_S = 0.3
_TWIST = struct.Struct('<6d')
_NS = 10 ** 9


def raw_class(connection):
    """Return a message class that publishes bytes as the type of a recorded connection."""
    def serialize(self, buff):
        """Write the bytes as they are."""
        buff.write(self._buff)
    return type('Raw', (rospy.AnyMsg,), {
        '_type': connection.kind, '_md5sum': connection.md5sum, '_has_header': False,
        '_full_text': connection.definition, 'serialize': serialize})


class _Newcomer(rospy.SubscribeListener):
    """Gives a new subscriber what a topic said last, unless that is old."""

    def __init__(self, newest):
        super().__init__()
        self._newest = newest

    def peer_subscribe(self, topic_name, topic_publish, peer_publish):
        """Publish to one subscriber (on a ROS thread)."""
        message = self._newest(topic_name)
        if message is not None:
            peer_publish(message)


class Stage:
    """The topics of the session, and what each said last.

    :param connections: :class:`mhri.recording.ros.bag_set.Connection` values; of several types of a
        topic the first counts
    :param prefix: what goes before each topic, '' for nothing
    """

    def __init__(self, connections, prefix=''):
        self._prefix = prefix
        self._topics = {}
        self._newest = {}
        self._at_ns = 0
        listener = _Newcomer(self._still_new)
        for connection in connections:
            if self.plays(connection) and connection.topic not in self._topics:
                kind = raw_class(connection)
                self._topics[connection.topic] = connection, kind, rospy.Publisher(
                    self._name(connection), kind, queue_size=200, subscriber_listener=listener)

    @staticmethod
    def plays(connection):
        """Tell whether a connection's messages are published."""
        return may_be_replayed(connection.topic, connection.kind)

    def _name(self, connection):
        return self._prefix + connection.topic

    def say(self, recorded):
        """Publish a message."""
        known = self._topics.get(recorded.connection.topic)
        if known is None or known[0].md5sum != recorded.connection.md5sum:
            return
        message = known[1]()
        message._buff = recorded.data
        self._newest[self._name(known[0])] = recorded, message, known[2]
        known[2].publish(message)

    def go_to(self, time_ns):
        """Take note of the time of the session."""
        self._at_ns = time_ns

    def forget(self):
        """Forget what was said: the session jumps."""
        self._newest = {}

    def _is_new(self, recorded):
        return recorded.connection.latched or self._at_ns - recorded.time_ns < NEW_S * _NS

    def _still_new(self, topic):
        found = self._newest.get(topic)
        return found[1] if found and self._is_new(found[0]) else None

    def repeat(self):
        """Publish again what is new; not what screens count the age of."""
        for recorded, message, publisher in list(self._newest.values()):
            if self._is_new(recorded) and recorded.connection.kind not in _AGED:
                publisher.publish(message)


class Said:
    """What the operator asked for, and the speed limit, at a moment of the session."""

    def __init__(self):
        self._newest = {}

    @staticmethod
    def reads(connection):
        """Tell whether a connection's messages say it."""
        return connection.kind == 'geometry_msgs/Twist' and connection.topic in (_ASKED, _LIMITS)

    def hear(self, recorded):
        """Take in a message."""
        if len(recorded.data) == _TWIST.size:
            twist = _TWIST.unpack(recorded.data)
            self._newest[recorded.connection.topic] = recorded.time_ns, (twist[0], twist[5])

    def forget(self):
        """Forget everything: the session jumps."""
        self._newest = {}

    def asked(self, time_ns):
        """Return (m/s, rad/s) as asked for at a time, () for nothing."""
        at_ns, value = self._newest.get(_ASKED, (None, ()))
        return value if at_ns is not None and 0 <= time_ns - at_ns < ASKED_S * _NS else ()

    def limits(self):
        """Return (m/s, rad/s), () if they are not known."""
        return self._newest.get(_LIMITS, (None, ()))[1]


class Player:
    """Plays a session on the ROS graph, in a thread of its own.

    :param kept: :class:`mhri.recording.ros.bag_set.Kept`
    :param clock: function that returns seconds, monotonic
    """

    def __init__(self, kept, clock=time.monotonic):
        self._kept = kept
        self._bags = kept.bags
        self._clock = clock
        self._start_ns = kept.bags.start_ns
        self._changed = threading.Condition()
        self._playing = Playing((kept.bags.end_ns - self._start_ns) / _NS)
        self._aim = 0.0
        self._jumps = 0
        self._told = None
        self._number, self._lag_s, self._heard = 0, LEAST_LAG_S, threading.Event()
        self._coming = iter(())
        self._next = None
        self._stage, self._said = Stage(kept.bags.connections(), kept.prefix), Said()
        self._state = rospy.Publisher('/mhri_replay/state', ReplayState, queue_size=10, latch=True)
        self._screen = rospy.Subscriber('/mhri_replay/heard', UInt32, self._on_heard,
                                        queue_size=10, tcp_nodelay=True)
        self._services = [
            rospy.Service('/mhri_replay/control', ControlReplay, self._on_control),
            rospy.Service(STOP_SERVICE, SetBool, _no(SetBoolResponse)),
            rospy.Service(TAKE_SERVICE, Trigger, _no(TriggerResponse)),
            rospy.Service('/mhri_tasks/set_place', SetPlace, _no(SetPlaceResponse)),
            rospy.Service(TASKS_SERVICE, Trigger, _no(TriggerResponse))]

    def start(self):
        """Begin, at the start of the session and playing; returns at once."""
        self._playing.play(self._clock())
        threading.Thread(target=self._run, name='player', daemon=True).start()
        return self

    def _on_control(self, request):
        """Take in a request (on a ROS thread)."""
        now, playing = self._clock(), self._playing
        with self._changed:
            if request.action == ControlReplayRequest.PLAY:
                if playing.position_s(now) >= playing.length_s:
                    self._aim = 0.0
                playing.play(now)
            elif request.action == ControlReplayRequest.PAUSE:
                playing.pause(now)
            elif request.action == ControlReplayRequest.SPEED and request.value > 0.0:
                playing.set_speed(request.value, now)
            elif request.action == ControlReplayRequest.SEEK and abs(request.value) < 1e9:
                playing.seek(request.value, now)
                self._aim = playing.position_s(now)
            else:
                return ControlReplayResponse(False, 'cannot {} {}: play, pause, seek or speed with '
                                             'a number'.format(request.action, request.value))
            self._told = None
            self._changed.notify_all()
        return ControlReplayResponse(True, '')

    def _run(self):
        """Play until the node ends."""
        try:
            self._play()
        except (rospy.ROSException, AttributeError):
            # Shutdown closed a topic. In the middle of publish(), rospy fails on a buffer of None.
            if not rospy.is_shutdown():
                raise

    def _play(self):
        repeated_at = 0.0
        while not rospy.is_shutdown():
            with self._changed:
                aim, self._aim = self._aim, None
            if aim is not None:
                self._seek(aim)
            with self._changed:
                now = self._clock()
                position_s, playing = self._playing.position_s(now), self._playing.playing
            wait_s = self._play_until(self._ns(position_s))
            if self._told is None or self._told != playing or playing \
                    and now - self._told_at >= STATE_S:
                self._tell(position_s, self._playing.speed, playing)
            if not playing and now - repeated_at >= REPEAT_S:
                repeated_at = now
                self._stage.repeat()
            with self._changed:
                if self._aim is None and self._told is not None:
                    self._changed.wait(min(wait_s, STATE_S / 2) if playing else REPEAT_S)

    def _ns(self, position_s):
        return self._start_ns + round(position_s * _NS)

    def _play_until(self, time_ns):
        """Publish what is due; return how long the next message can wait [s, real time]."""
        while self._aim is None:
            if self._next is None:
                self._next = self._following()
            if self._next is None:
                break
            if self._next.time_ns > time_ns:
                return (self._next.time_ns - time_ns) / _NS / self._playing.speed
            recorded, self._next = self._next, None
            late_s = (time_ns - recorded.time_ns) / _NS / self._playing.speed
            if late_s < LATE_S or recorded.connection.kind not in _LARGE:
                self._say(recorded)
        self._stage.go_to(time_ns)
        return STATE_S

    def _following(self):
        """Return the next message, None at the end and where the bag is damaged."""
        try:
            return next(self._coming, None)
        except DAMAGED as error:
            self._coming = iter(())
            rospy.logwarn('a bag is damaged, what follows is missing: %s', error)
            return None

    def _seek(self, position_s):
        """Go to a position: what was newest a moment before it, then, fast, what came since.

        A screen hears of the jump first: by its clock everything from before is old then. What is
        older is said as of when it was: its age is shown.
        """
        self._jumps += 1
        begin_s = max(0.0, position_s - RUN_UP_S)
        self._stage.forget()
        self._said.forget()
        aim_ns, plays = self._ns(position_s), self._plays
        self._stage.go_to(aim_ns)
        newest = self._bags.newest(self._ns(begin_s), _small(plays))
        for at_s, places in age_groups([self._as_of(recorded, begin_s) for recorded in newest],
                                       begin_s) or [(begin_s, [])]:
            self._tell_heard(at_s, position_s)
            for place in places:
                self._say(newest[place])
            # By the clock of a screen this was said before what follows, even if it hears it late.
            time.sleep(self._tell_heard(at_s, position_s))
        self._run_up(begin_s, position_s)
        for recorded in self._bags.newest(aim_ns, lambda kind: plays(kind)
                                          and kind.kind in _LARGE):
            self._say(recorded)
        self._coming, self._next = self._bags.after(aim_ns, plays), None
        with self._changed:
            if self._aim is None:
                self._playing.seek(position_s, self._clock())
        self._told = None

    def _as_of(self, recorded, begin_s):
        """Return as of when a message counts that is the newest at the begin of a run-up [s]."""
        if recorded.connection.latched or recorded.connection.kind not in _AGED:
            return begin_s
        return (recorded.time_ns - self._start_ns) / _NS

    def _tell_heard(self, position_s, aim_s):
        """Tell where it stands on its way, and wait until a screen has heard it.

        :returns: how much longer to wait for what was said just before [s]
        """
        begun = self._clock()
        self._heard.clear()
        self._tell(position_s, 1.0, False, aim_s)
        if self._state.get_num_connections() and self._screen.get_num_connections():
            self._heard.wait(MOST_HEARD_S)
            self._lag_s = max(LEAST_LAG_S, self._clock() - begun)
            return self._lag_s
        return HEARD_S

    def _on_heard(self, message):
        """Take in which word a screen has heard (on a ROS thread)."""
        if message.data == self._number:
            self._heard.set()

    def _run_up(self, begin_s, end_s):
        """Play the moment before the aim of a seek, without pictures; slower if screens are."""
        begun = self._clock()
        speed = max(1.0, min(RUN_UP_SPEED, RUN_UP_LATE_S / self._lag_s))
        self._tell(begin_s, speed, True, end_s)
        self._coming = self._bags.after(self._ns(begin_s), _small(self._plays))
        for recorded in iter(self._following, None):
            if recorded.time_ns > self._ns(end_s) or self._aim is not None:
                return
            due_s = ((recorded.time_ns - self._start_ns) / _NS - begin_s) / speed
            wait_s = due_s - (self._clock() - begun)
            if wait_s > 0.002:
                time.sleep(wait_s)
            self._say(recorded)

    def _plays(self, connection):
        return self._stage.plays(connection) or self._said.reads(connection)

    def _say(self, recorded):
        if self._said.reads(recorded.connection):
            self._said.hear(recorded)
        else:
            self._stage.say(recorded)

    def _tell(self, position_s, speed, playing, aim_s=None):
        """Publish the state; ``aim_s`` is where it is on its way to, None while it is there."""
        self._told, self._told_at = playing if aim_s is None else None, self._clock()
        self._number += 1
        self._state.publish(
            number=self._number, session=self._kept.name,
            start=rospy.Time(*divmod(self._start_ns, _NS)),
            length_s=self._playing.length_s, position_s=position_s, speed=speed, playing=playing,
            settled=aim_s is None, until_s=self._playing.length_s if aim_s is None else aim_s,
            jumps=self._jumps, asked=self._said.asked(self._ns(position_s)),
            limits=self._said.limits())


def _small(wanted):
    """Return a filter that leaves out pictures and clouds as well."""
    return lambda connection: wanted(connection) and connection.kind not in _LARGE


def _no(answer):
    """Return the handler of a service that refuses."""
    return lambda request: answer(False, NOTHING_DRIVES)
