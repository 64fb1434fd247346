# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Replays a session on its own master, with the recorded timing, at the requested speed.

Publishes every recorded topic with the recorded bytes, except velocities and requests
(:func:`mhri.session.foreign.may_be_replayed`) and commands of accessories: a replay cannot drive
anything. Further interfaces:
``/mhri_replay/state`` (``mhri/ReplayState``, latched, 10 Hz while playing, on change),
``/mhri_replay/heard`` (``std_msgs/UInt32``: the number of the state that a screen acknowledges),
service ``/mhri_replay/control`` (``mhri/ControlReplay``). It also provides the services by which a
screen identifies the drive and task services, so that the screen accepts their recorded messages;
all requests to them are refused.
"""
import threading
import time

import rospy
from std_msgs.msg import String, UInt32
from std_srvs.srv import SetBool, SetBoolResponse, Trigger, TriggerResponse

from mhri.graph.ros.service_owner import STOP_SERVICE
from mhri.msg import ReplayState
from mhri.recording.ros.bag_set import DAMAGED
from mhri.session.foreign import may_be_replayed
from mhri.session.playing import age_groups, Playing, RUN_UP_S
from mhri.srv import (
    ControlReplay, ControlReplayRequest, ControlReplayResponse, SetPlace, SetPlaceResponse)
from mhri.tasks.ros.tasks_client import SERVICE as TASKS_SERVICE

NOTHING_DRIVES = 'this is a replay: nothing moves'
STATE_S = 0.1
# While paused, recent messages are repeated at this interval for new subscribers [s].
REPEAT_S = 0.5
# An older message is repeated only if it was latched [s].
NEW_S = 2.0
# A large message later than this is skipped, because the next one is due [s].
LATE_S = 0.3
# Assumed lag of a screen that does not acknowledge states; maximum time to wait for an
# acknowledgement; minimum lag assumed of a screen that acknowledges [s].
HEARD_S, MAX_HEARD_S, MIN_LAG_S = 0.15, 2.0, 0.02
# Maximum speed factor of the run-up before a seek, and the session time [s] by which a screen may
# lag behind meanwhile.
RUN_UP_SPEED, RUN_UP_LATE_S = 16.0, 0.3
_LARGE = frozenset(('sensor_msgs/Image', 'sensor_msgs/CompressedImage', 'sensor_msgs/PointCloud2'))
# Screens derive the age of these from the session time; repeating them would make them look new.
_AGED = frozenset(('nav_msgs/Odometry', 'turtlesim/Pose', 'mhri/DriveState'))
_PICTURES = frozenset(('sensor_msgs/Image', 'sensor_msgs/CompressedImage'))
_NS = 10 ** 9


def raw_class(connection):
    """Return a message class that publishes raw bytes with the type of a connection."""
    def serialize(self, buff):
        """Write the raw bytes."""
        buff.write(self._buff)
    return type('Raw', (rospy.AnyMsg,), {
        '_type': connection.kind, '_md5sum': connection.md5sum, '_has_header': False,
        '_full_text': connection.definition, 'serialize': serialize})


class _Newcomer(rospy.SubscribeListener):
    """Sends the newest message of a topic, if recent, to each new subscriber."""

    def __init__(self, newest):
        super().__init__()
        self._newest = newest

    def peer_subscribe(self, topic_name, topic_publish, peer_publish):
        """Publish to one subscriber (on a ROS thread)."""
        message = self._newest(topic_name)
        if message is not None:
            peer_publish(message)


class Stage:
    """The publishers of the session's topics, with the newest message of each.

    :param connections: :class:`mhri.recording.ros.bag_set.Connection` values; if a topic has
        several types, the first is used
    :param prefix: prefix of each topic, '' for none
    :param commands: further topics that are not published, absolute
    """

    def __init__(self, connections, prefix='', commands=()):
        self._prefix = prefix
        self._topics = {}
        self._newest = {}
        self._at_ns = 0
        listener = _Newcomer(self._still_new)
        for connection in connections:
            if self.plays(connection) and connection.topic not in commands \
                    and connection.topic not in self._topics:
                kind = raw_class(connection)
                self._topics[connection.topic] = connection, kind, rospy.Publisher(
                    self._name(connection), kind, queue_size=200, subscriber_listener=listener)

    @staticmethod
    def plays(connection):
        """Return whether a connection's messages are published."""
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
        """Set the session time."""
        self._at_ns = time_ns

    def forget(self):
        """Drop the newest messages before a jump."""
        self._newest = {}

    def _is_new(self, recorded):
        return recorded.connection.latched or self._at_ns - recorded.time_ns < NEW_S * _NS

    def _still_new(self, topic):
        found = self._newest.get(topic)
        return found[1] if found and self._is_new(found[0]) else None

    def pictures(self):
        """Return the names of the topics with a recent picture."""
        return tuple(sorted(name for name, (recorded, _, _) in list(self._newest.items())
                            if recorded.connection.kind in _PICTURES and self._is_new(recorded)))

    def repeat(self):
        """Republish recent messages, except those whose age screens show."""
        for recorded, message, publisher in list(self._newest.values()):
            if self._is_new(recorded) and recorded.connection.kind not in _AGED:
                publisher.publish(message)


class Player:
    """Plays a session on the ROS graph, in its own thread.

    :param kept: :class:`mhri.recording.ros.bag_set.OpenSession`
    :param commands: topics that command accessories, absolute: they are not published
    """

    def __init__(self, kept, commands=()):
        self._kept = kept
        self._bags = kept.bags
        self._start_ns = kept.bags.start_ns
        self._changed = threading.Condition()
        self._playing = Playing((kept.bags.end_ns - self._start_ns) / _NS)
        self._aim = 0.0
        self._jumps = 0
        self._published = None
        self._number, self._lag_s, self._heard = 0, MIN_LAG_S, threading.Event()
        self._coming = iter(())
        self._next = None
        self._stage = Stage(kept.bags.connections(), kept.prefix, commands)
        self._state = rospy.Publisher('/mhri_replay/state', ReplayState, queue_size=10, latch=True)
        self._pictures = rospy.Publisher('/mhri_replay/pictures', String, queue_size=1, latch=True)
        self._with_pictures = None
        self._screen = rospy.Subscriber('/mhri_replay/heard', UInt32, self._on_heard,
                                        queue_size=10, tcp_nodelay=True)
        self._services = [
            rospy.Service('/mhri_replay/control', ControlReplay, self._on_control),
            rospy.Service(STOP_SERVICE, SetBool, _no(SetBoolResponse)),
            rospy.Service('/mhri_tasks/set_place', SetPlace, _no(SetPlaceResponse)),
            rospy.Service(TASKS_SERVICE, Trigger, _no(TriggerResponse))]

    def start(self):
        """Start to play from the beginning; return at once."""
        self._playing.play(time.monotonic())
        threading.Thread(target=self._run, name='player', daemon=True).start()
        return self

    def _on_control(self, request):
        """Handle a request (on a ROS thread)."""
        now, playing = time.monotonic(), self._playing
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
            self._published = None
            self._changed.notify_all()
        return ControlReplayResponse(True, '')

    def _run(self):
        """Play until the node ends."""
        try:
            self._play()
        except (rospy.ROSException, AttributeError):
            # Shutdown closed a topic; within publish(), rospy then fails on a buffer of None.
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
                now = time.monotonic()
                position_s, playing = self._playing.position_s(now), self._playing.playing
            wait_s = self._play_until(self._ns(position_s))
            if self._published is None or self._published != playing or playing \
                    and now - self._published_at >= STATE_S:
                self._publish_state(position_s, self._playing.speed, playing)
            self._publish_pictures()
            if not playing and now - repeated_at >= REPEAT_S:
                repeated_at = now
                self._stage.repeat()
            with self._changed:
                if self._aim is None and self._published is not None:
                    self._changed.wait(min(wait_s, STATE_S / 2) if playing else REPEAT_S)

    def _ns(self, position_s):
        return self._start_ns + round(position_s * _NS)

    def _play_until(self, time_ns):
        """Publish all due messages; return the real time until the next one is due [s]."""
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
                self._stage.say(recorded)
        self._stage.go_to(time_ns)
        return STATE_S

    def _following(self):
        """Return the next message, None at the end or if the bag is damaged."""
        try:
            return next(self._coming, None)
        except DAMAGED as error:
            self._coming = iter(())
            rospy.logwarn('a bag is damaged, what follows is missing: %s', error)
            return None

    def _seek(self, position_s):
        """Go to a position: publish the newest messages before a run-up, then the run-up, fast.

        The jump is announced first, so that by the screen's clock all earlier messages are old.
        Older messages are published as of their recorded time, because screens show their age.
        """
        self._jumps += 1
        begin_s = max(0.0, position_s - RUN_UP_S)
        self._stage.forget()
        aim_ns, plays = self._ns(position_s), self._stage.plays
        self._stage.go_to(aim_ns)
        newest = self._bags.newest(self._ns(begin_s), _small(plays))
        for at_s, places in age_groups([self._as_of(recorded, begin_s) for recorded in newest],
                                       begin_s) or [(begin_s, [])]:
            self._announce(at_s, position_s)
            for place in places:
                self._stage.say(newest[place])
            # Let late messages arrive before the screen's clock advances to the next group.
            time.sleep(self._announce(at_s, position_s))
        self._run_up(begin_s, position_s)
        for recorded in self._bags.newest(aim_ns, lambda kind: plays(kind)
                                          and kind.kind in _LARGE):
            self._stage.say(recorded)
        self._coming, self._next = self._bags.after(aim_ns, plays), None
        with self._changed:
            if self._aim is None:
                self._playing.seek(position_s, time.monotonic())
        self._published = None

    def _as_of(self, recorded, begin_s):
        """Return the time [s] at which to publish the newest message before a run-up."""
        if recorded.connection.latched or recorded.connection.kind not in _AGED:
            return begin_s
        return (recorded.time_ns - self._start_ns) / _NS

    def _announce(self, position_s, aim_s):
        """Publish the position, and wait until a screen acknowledges it.

        :returns: time to wait for the arrival of other messages [s]
        """
        begun = time.monotonic()
        self._heard.clear()
        self._publish_state(position_s, 1.0, False, aim_s)
        if self._state.get_num_connections() and self._screen.get_num_connections():
            self._heard.wait(MAX_HEARD_S)
            self._lag_s = max(MIN_LAG_S, time.monotonic() - begun)
            return self._lag_s
        return HEARD_S

    def _on_heard(self, message):
        """Handle a screen's acknowledgement (on a ROS thread)."""
        if message.data == self._number:
            self._heard.set()

    def _run_up(self, begin_s, end_s):
        """Play the run-up to a seek without pictures, more slowly if a screen lags."""
        begun = time.monotonic()
        speed = max(1.0, min(RUN_UP_SPEED, RUN_UP_LATE_S / self._lag_s))
        self._publish_state(begin_s, speed, True, end_s)
        self._coming = self._bags.after(self._ns(begin_s), _small(self._stage.plays))
        for recorded in iter(self._following, None):
            if recorded.time_ns > self._ns(end_s) or self._aim is not None:
                return
            due_s = ((recorded.time_ns - self._start_ns) / _NS - begin_s) / speed
            wait_s = due_s - (time.monotonic() - begun)
            if wait_s > 0.002:
                time.sleep(wait_s)
            self._stage.say(recorded)

    def _publish_pictures(self):
        """Publish on change which topics have pictures now."""
        names = self._stage.pictures()
        if names != self._with_pictures:
            self._with_pictures = names
            self._pictures.publish(' '.join(names))

    def _publish_state(self, position_s, speed, playing, aim_s=None):
        """Publish the state; ``aim_s`` is the target of a seek in progress, else None."""
        self._published, self._published_at = playing if aim_s is None else None, time.monotonic()
        self._number += 1
        self._state.publish(
            number=self._number, session=self._kept.name,
            start=rospy.Time(*divmod(self._start_ns, _NS)),
            length_s=self._playing.length_s, position_s=position_s, speed=speed, playing=playing,
            settled=aim_s is None, until_s=self._playing.length_s if aim_s is None else aim_s,
            jumps=self._jumps)


def _small(wanted):
    """Return a filter that also excludes pictures and clouds."""
    return lambda connection: wanted(connection) and connection.kind not in _LARGE


def _no(answer):
    """Return a service handler that refuses every request."""
    return lambda request: answer(False, NOTHING_DRIVES)
