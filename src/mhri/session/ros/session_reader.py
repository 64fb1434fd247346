# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Reads a session for its report, without a master; its folder is never written to."""
from contextlib import contextmanager
import os
from typing import NamedTuple

import genpy

from mhri.base.config import ConfigError, short
from mhri.base.geometry import Pose
from mhri.base.io.files import text_in
from mhri.base.robot_types import SILENT_AFTER_S
from mhri.graph.ros.messages import MessageMissing
from mhri.map.grid import GridError
from mhri.map.ros.map_source import grid_of_message, TOPIC as MAP_TOPIC
from mhri.msg import RobotDrive
from mhri.recording.folder import (
    bags_of, EVENTS_JSONL, NotASession, read_events, read_info, robots_of, SESSION_YAML)
from mhri.recording.ros.bag_set import BagSet, DAMAGED
from mhri.robots.ros.odometry import MOTIONS
from mhri.session.drill_results import FILE as DRILL_FILE, read_result, rows_of
from mhri.session.report import report_of, sound_events
from mhri.session.survey import RobotSurvey
from mhri.session.timeline import read_time_line
from mhri.session.topics import DRIVE

PLACES = '/mhri_tasks/places'
_HOST = {DRIVE: 'mhri/DriveState', PLACES: 'mhri/Places', MAP_TOPIC: 'nav_msgs/OccupancyGrid'}
# After a stop, every message is read for this long [s].
_DENSE_S = 4.0
_NS = 10 ** 9
_LARGEST_EVENTS = 200 * 10 ** 6
# More nesting than any real line has; a hostile line would overflow the decoder's stack.
_MAX_NESTED = 500


class ThinnedBags(BagSet):
    """Bags read at the reduced rate that a report needs.

    ``step_s`` is the minimum time between two messages of a topic; after each of the times
    ``dense`` [ns] all messages are read for a while.
    """

    step_s, dense = 0.08, ()

    def _row(self, index, number, entries, time_ns):
        due = 0
        for place in super()._row(index, number, entries, time_ns):
            if place.time_ns >= due or any(0 <= place.time_ns - begin < _DENSE_S * _NS
                                           for begin in self.dense):
                due = place.time_ns + round(self.step_s * _NS)
                yield place


class Session(NamedTuple):
    """An opened session; ``bags`` is None if no bag can be read."""

    path: str
    info: object
    events: list
    robots: dict
    bags: object
    problems: list

    @property
    def name(self):
        """The name of the folder."""
        return os.path.basename(self.path)


@contextmanager
def opened(path):
    """Open a session for the duration of the block (blocking); yield a :class:`Session`.

    :raises NotASession: the path is not a session; the text has the path, the reason and the remedy
    """
    path = os.path.abspath(os.path.expanduser(path))
    try:
        session = _open(path)
    except OSError as error:
        raise NotASession('{}: {}'.format(path, error.strerror))
    except NotASession as error:
        raise NotASession('{}: {}'.format(path, error))
    try:
        yield session
    finally:
        if session.bags is not None:
            session.bags.close()


def _open(path):
    if not os.path.isdir(path):
        raise NotASession('a session is a folder' if os.path.exists(path)
                          else 'there is no such folder')
    if not os.path.isfile(os.path.join(path, SESSION_YAML)):
        raise NotASession('it has no {}, so mhri did not record it; bags of other programs can '
                          'be looked at (mhri_run.sh --replay), not reported on'.format(
                              SESSION_YAML))
    problems = []
    info = read_info(_text(os.path.join(path, SESSION_YAML), problems))
    lines = _text(os.path.join(path, EVENTS_JSONL), problems).split('\n')
    events, strange = sound_events(read_events('\n'.join(
        line for line in lines if line.count('[') + line.count('{') < _MAX_NESTED)))
    if strange:
        problems.append('{} lines of {} make no sense'.format(strange, EVENTS_JSONL))
    bags = None
    try:
        bags = ThinnedBags([os.path.join(path, name) for name in bags_of(sorted(os.listdir(path)))],
                           folds=True)
        problems += bags.problems
        events = list(map(bags.folded, events))
    except NotASession as error:
        problems.append('no bag can be read: {}'.format(error))
    return Session(path, info, events, robots_of(info, events), bags, problems)


def _text(path, problems):
    """Return the text of a file; '' if it does not exist or is too large."""
    text = text_in(path, _LARGEST_EVENTS)
    if text is None:
        problems.append('{} is larger than {} MB and was not read'.format(
            os.path.basename(path), _LARGEST_EVENTS // 10 ** 6))
    return text or ''


class ReportBuilder:
    """Reads a :class:`Session` once and makes its report.

    ``grid`` is the last map, None if the session has none.
    """

    def __init__(self, session):
        self._session = session
        self._refused = set()
        bags = session.bags
        self.start = bags.start_ns / _NS if bags else min(
            [session.info.started] + [event.ros for event in session.events])
        end = bags.end_ns / _NS if bags else max(
            [self.start] + [event.ros for event in session.events])
        self.line = read_time_line(session.events, self.start, end - self.start)
        self._surveys = {name: RobotSurvey(self.line.stopped, _silent_after_s(robot))
                         for name, robot in session.robots.items()}
        recorded = {connection.topic: connection.kind
                    for connection in bags.connections()} if bags else {}
        self._topics = {name: _odometry_of(name, robot, recorded)
                        for name, robot in session.robots.items()}
        self._odometry = {topic: name for name, topic in self._topics.items()}
        self.grid = None

    def read(self, progress=lambda done, count: None):
        """Read all bags (blocking: up to a minute for an hour); return the :class:`Report`.

        :param progress: called with (seconds read, all seconds)
        """
        session = self._session
        if session.bags is not None:
            session.bags.dense = [round((self.start + span.begin_s - 1.0) * _NS)
                                  for span in self.line.stopped[:20]]
            try:
                for recorded in session.bags.after(session.bags.start_ns - 1, self._wanted):
                    self._take(recorded)
                    progress((recorded.time_ns - session.bags.start_ns) // _NS,
                             max(1, round(self.line.length_s)))
            except DAMAGED as error:
                session.problems.append('a bag is damaged, what follows is missing: {}'.format(
                    error))
        for survey in self._surveys.values():
            survey.end(self.line.length_s)
        impossible = sum(survey.impossible for survey in self._surveys.values())
        if impossible:
            session.problems.append('{} impossible odometry readings were ignored'.format(
                impossible))
        try:
            return report_of(session.name, session.info, self.line, session.robots, self._surveys,
                             drills=tuple(self._drills()), problems=tuple(session.problems))
        except NotASession as error:
            raise NotASession('{}: {}'.format(session.path, error))

    def is_odometry(self, connection):
        """Return whether a connection is the odometry of one of the robots."""
        return connection.topic in self._odometry and connection.kind in MOTIONS

    def odometry_topic(self, robot):
        """Return the recorded topic of a robot's odometry, '' if none."""
        return self._topics[robot]

    @staticmethod
    def is_places(connection):
        """Return whether a connection has the places of the robots on the map."""
        return connection.topic == PLACES and connection.kind == _HOST[PLACES]

    def origins(self, recorded):
        """Return {robot: :class:`Pose` of its odometry's origin on the map, None if not placed}.

        :param recorded: a message of :meth:`is_places`; {} if unreadable
        """
        message = self.message(recorded)
        poses = {} if message is None else {
            row.robot: _pose(row.odometry) for row in message.robots}
        return {name: pose for name, pose in poses.items() if pose is None or pose.is_finite()}

    def motion(self, recorded):
        """Return the :class:`Motion` of an odometry message, None if unreadable."""
        message = self.message(recorded)
        return None if message is None else MOTIONS[recorded.connection.kind](message)

    def _wanted(self, connection):
        return connection.kind == _HOST.get(connection.topic) or self.is_odometry(connection)

    def _take(self, recorded):
        message = self.message(recorded)
        if message is None:
            return
        topic = recorded.connection.topic
        if topic in self._odometry:
            self._surveys[self._odometry[topic]].on_motion(
                recorded.time_ns / _NS - self.start, MOTIONS[recorded.connection.kind](message))
        elif topic == MAP_TOPIC:
            self._take_map(message)
        else:
            self._take_robots(topic, recorded.time_ns / _NS - self.start, message.robots)

    def _take_map(self, message):
        try:
            self.grid = grid_of_message(message)
        except GridError as error:
            self._refuse('{}: no map: {}'.format(MAP_TOPIC, error))

    def _take_robots(self, topic, at_s, rows):
        """Handle a message with the drive's state or the places of robots."""
        for row in rows:
            survey = self._surveys.get(row.name if topic == DRIVE else row.robot)
            if survey is not None and topic == DRIVE:
                survey.on_drive(at_s, row.obeys == RobotDrive.TASK)
                survey.on_round_trip(row.round_trip_s)
                survey.on_witness(row.odometry_follows)
            elif survey is not None:
                survey.on_place(_pose(row.odometry))

    def message(self, recorded):
        """Return a recorded message; None if unreadable, which is reported once."""
        try:
            return recorded.message()
        except (MessageMissing, genpy.DeserializationError, ValueError) as error:
            self._refuse('{} cannot be read: {}'.format(recorded.connection.topic, error))
            return None

    def _refuse(self, sentence):
        if sentence not in self._refused and len(self._refused) < 20:
            self._refused.add(sentence)
            self._session.problems.append(sentence)

    def _drills(self):
        """Yield (title, rows) of the drill results in the session."""
        stem, _, ending = DRILL_FILE.partition('.')
        for name in sorted(os.listdir(self._session.path)):
            if not (name.startswith(stem) and name.endswith('.' + ending)):
                continue
            try:
                result = read_result(_text(
                    os.path.join(self._session.path, name), self._session.problems), name)
            except (ConfigError, OSError) as error:
                self._refuse(short(error))
                continue
            yield result['title'], [('driven by', result['operator']), ('ended', result['ended']),
                                    *rows_of([result])]


def _silent_after_s(robot):
    """Return the time after which a robot counts as silent [s], from the session if valid."""
    said = robot.get('silent_after_s')
    return said if type(said) in (int, float) and 0.0 <= said <= 60.0 else SILENT_AFTER_S


def _odometry_of(name, robot, recorded):
    """Return the topic of a robot's odometry: as named by the session, else a recorded one.

    :param recorded: {topic: type} of the bags
    """
    topics = robot.get('topics')
    named = topics.get('odometry') if isinstance(topics, dict) else None
    others = sorted(topic for topic, kind in recorded.items()
                    if kind in MOTIONS and topic.startswith('/{}/'.format(name)))
    return named if isinstance(named, str) and named in recorded else (others or [''])[0]


def _pose(place):
    """Return a place of ``mhri/Place`` as a :class:`Pose`, None for NaN."""
    return Pose(place.x, place.y, place.theta) if place.x == place.x else None
