# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""On the host: fetches the robot's recordings of a link outage, and joins them into one bag."""
import collections
import contextlib
from datetime import datetime
import os
import threading
import time

import rosbag
import rospy
from std_msgs.msg import String
from std_srvs.srv import SetBool, SetBoolResponse

from mhri.base.text import tidy_text
from mhri.graph.ros.messages import installed_class
from mhri.link.carried import GUARD_COMMAND
from mhri.link.records import (
    ASK, Fetch, IN_SESSIONS, OFFER, pack_ask, PART, PICTURES, piece_of, RECORD,
    unpack_offer, unpack_part)
from mhri.link.robot_claims import fits, OwnFrames, recorded_name
from mhri.link.ros.keeper import crc_of_file, folder_of
from mhri.msg import SessionState
from mhri.recording.folder import NotASession
from mhri.recording.recording import ros_home
from mhri.recording.ros.bag_set import BagSet, DAMAGED
from mhri.robots.figures import FETCHING

WAIT_S = 0.1
# Pieces overlap a little: this many recent messages are checked for duplicates.
REMEMBERED = 5000
# Pause of this duration after this many messages, to let other threads run [s].
AT_ONCE, REST_S = 50, 0.005
_NS = 10 ** 9


def join(robot, paths, target, topics):
    """Join pieces into one bag, with the names used on the host.

    Pieces are not trusted: topics that do not belong to the robot, and types that are not installed
    here, are omitted.

    :param topics: carried topics of the robot, as in :class:`mhri.link.carried.Stream`
    :returns: sentences about omitted parts
    :raises OSError: the bag cannot be written
    """
    frames = OwnFrames(robot)
    recent, written, strange, problems = collections.OrderedDict(), 0, set(), []
    with rosbag.Bag(target, 'w') as bag:
        for recorded in _messages(paths, problems):
            kind, data = recorded.connection.kind, recorded.data
            name = recorded_name(robot, recorded.connection.topic, kind, topics)
            if not name or not fits(kind, data):
                strange.add(recorded.connection.topic)
                continue
            # A hash, not the message: that many pictures would take gigabytes.
            key = name, len(data), hash(data)
            if key in recent:
                continue
            recent[key] = None
            if len(recent) > REMEMBERED:
                recent.popitem(last=False)
            written += 1
            if written % AT_ONCE == 0:
                # This process also forwards commands.
                time.sleep(REST_S)
            try:
                data = frames.of(name, kind, data)
            except ValueError:
                continue
            found = installed_class(kind, recorded.connection.md5sum)
            bag.write(name, (kind, data, found._md5sum, found),
                      rospy.Time(*divmod(recorded.time_ns, _NS)), raw=True)
    return problems + ['topics that are not of {}: {}'.format(
        robot, ', '.join(sorted(strange)[:5]))] * bool(strange)


def _messages(paths, problems):
    """Yield the readable messages of pieces; append the problems with unreadable ones."""
    for path in paths:
        try:
            with contextlib.closing(BagSet([path])) as piece:
                problems.extend(piece.problems)
                yield from piece.after(piece.start_ns - 1)
        except (NotASession,) + DAMAGED as error:
            problems.append('{}: {}'.format(os.path.basename(path), error))


class HostRecord:
    """Requests recordings, writes them, and publishes the progress, on its own thread.

    Publishes ``/<robot>/mhri_link/fetching`` (``std_msgs/String``, latched), serves
    ``/<robot>/mhri_link/keep`` (``std_srvs/SetBool``): whether the robot records outages for this
    host. It always does while a session is recorded (``/mhri_session/state``,
    ``mhri/SessionState``). The bag is ``<robot>_missed_<date-time>.bag`` in the folder of the
    session, or in ``$ROS_HOME``.

    :param side: the host side of the link
    :param topics: returns the carried topics of the robot
    :param keep: when the robot records, see :mod:`mhri.link.records`
    """

    def __init__(self, side, topics, keep=IN_SESSIONS):
        self._side = side
        self._topics = topics
        self._folder = folder_of(side.name, 'fetched')
        self._part = os.path.join(self._folder, 'part')
        self._asked = os.path.join(self._folder, 'asked')
        self._came = collections.deque()
        self._work = threading.Event()
        self._fetch = None
        self._keep, self._pictures = keep != IN_SESSIONS, keep == PICTURES
        self._said = None
        self.text = ''
        self._session = None
        self._publisher = rospy.Publisher('/{}/{}'.format(side.name, FETCHING), String,
                                          queue_size=1, latch=True)
        self._service = rospy.Service('/{}/mhri_link/keep'.format(side.name), SetBool,
                                      self._on_keep)
        self._subscriber = rospy.Subscriber('/mhri_session/state', SessionState, self._on_session,
                                            queue_size=1)

    def _on_session(self, message):
        self._session = message

    def _on_keep(self, request):
        self._keep = request.data
        self._work.set()
        return SetBoolResponse(True, 'the robot records during outages' if request.data
                               else 'the robot does not record during outages')

    def start(self):
        """Start the thread."""
        threading.Thread(target=self._run, name='record', daemon=True).start()

    def on_frame(self, topic, body):
        """Handle a message if it concerns recordings; return whether it does."""
        if topic not in (OFFER, PART):
            return False
        self._came.append((topic, body))
        self._work.set()
        return True

    def _run(self):
        while not rospy.is_shutdown():
            self._work.wait(WAIT_S)
            self._work.clear()
            try:
                self._tick(self._side.clock())
            except Exception as error:  # a full disk, malformed bytes: the link continues
                if not rospy.is_shutdown():
                    rospy.logwarn_throttle(10.0, '{}: cannot fetch what was recorded: {!r}'.format(
                        self._side.name, error))

    def _tick(self, now):
        if self._fetch is None:
            os.makedirs(self._folder, exist_ok=True)
            # Pieces of an earlier run; a file is named like a piece once it is complete.
            self._fetch = Fetch(done=[piece for piece in map(piece_of, os.listdir(self._folder))
                                      if piece is not None],
                                asked=os.path.exists(self._asked))
        fetch = self._fetch
        fetch.pictures = self._pictures
        fetch.keep = self._keep or self._session is not None and self._session.recording
        while self._came:
            topic, body = self._came.popleft()
            if topic == OFFER:
                fetch.on_offer(unpack_offer(body), now)
            else:
                self._on_part(*unpack_part(body), now)
        whole = fetch.whole()
        if whole is not None:
            self._check(whole)
        done = fetch.finished()
        if done:
            self._finish(done)
        self._say(fetch.words(self._side.name) or self.text)
        ask = fetch.ask(now) if self._side.peer.is_live(now) else None
        self._remember(fetch)
        if ask is not None:
            self._side.send(ASK, RECORD, pack_ask(ask))

    def _remember(self, fetch):
        """Store the request of recordings across restarts, before it is sent."""
        if fetch.asked != os.path.exists(self._asked):
            if fetch.asked:
                open(self._asked, 'wb').close()
            else:
                os.unlink(self._asked)
        if fetch.unasked:
            rospy.logwarn_throttle(60.0, '{}: {} recordings are not fetched: this host has not '
                                   'asked for any'.format(self._side.name, fetch.unasked))

    def _path(self, piece):
        return os.path.join(self._folder, piece.name)

    def _on_part(self, number, offset, data, now):
        if self._fetch.on_part(number, offset, data, now):
            with open(self._part, 'r+b' if offset else 'wb') as file:
                file.seek(offset)
                file.write(data)

    def _check(self, piece):
        good = crc_of_file(self._part) == piece.crc
        if good:
            os.rename(self._part, self._path(piece))
        else:
            rospy.logwarn('%s: %s arrived damaged: fetched again', self._side.name, piece.name)
        self._fetch.checked(piece, good)

    def _finish(self, pieces):
        """Join the fetched pieces into one bag."""
        begun = datetime.fromtimestamp(1e-3 * pieces[0].begun_ms)
        folder = self._session.folder if self._session is not None else ''
        target = os.path.join(
            folder if os.path.isdir(folder) else ros_home(os.environ),
            '{}_missed_{:%Y-%m-%d-%H-%M-%S}.bag'.format(self._side.name, begun))
        paths = [self._path(piece) for piece in pieces]
        # Never overwrite a file.
        os.close(os.open(target, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o666))
        left_out = join(self._side.name, paths, target,
                        list(self._topics()) + [GUARD_COMMAND])
        for sentence in left_out:
            # The sentence contains names chosen by the robot.
            rospy.logwarn('%s: left out: %s', os.path.basename(target), tidy_text(sentence, 500))
        for path in paths:
            os.unlink(path)
        self.text = 'fetched {:.0f} s from {}: {}'.format(
            1e-3 * sum(piece.lasts_ms for piece in pieces), self._side.name, target)
        rospy.loginfo('%s', self.text)

    def _say(self, text):
        if text != self._said:
            self._said = text
            self._publisher.publish(text)
