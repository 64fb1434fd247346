# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Reads a recorded session for the page, in a process of its own: a hostile or long one slows no
live viewer, and no stick.

A request is a line of JSON on the standard input: ``["sessions"]``, ``["timeline"]``, ``["map"]``
or ``["picture", robot, seconds from the start]``. An answer is a line of JSON, with the ``kind``
of the bytes ('' for a problem) and their ``size``, then the bytes.
"""
import json
import os
import sys

from mhri.base.geometry import composed, Pose
from mhri.base.robot_colours import colour_of
from mhri.events.events import ALARM, ATTENTION, CALM
from mhri.map.grid import GridError
from mhri.map.ros.map_source import grid_of_message, TOPIC as MAP
from mhri.recording.folder import ERROR, NotASession, WARNING
from mhri.recording.ros.bag_set import DAMAGED
from mhri.session.film import cameras_of
from mhri.session.ros.session_library import SessionLibrary
from mhri.session.ros.session_reader import opened, ReportBuilder
from mhri.web.ros.feed import map_picture
from mhri.web.said import picture_of

# Time between two places of a robot [s]; a picture may be this much older than asked for.
STEP_S = 0.5
MAX_EVENTS = 5000
_PICTURE, _NS = 'sensor_msgs/CompressedImage', 10 ** 9
_SEVERITIES = {WARNING: ATTENTION, ERROR: ALARM}
#: kind of an answer that is JSON
JSON = 'json'


def _json(value):
    return JSON, json.dumps(value, separators=(',', ':')).encode()


def sessions():
    """Return the list of recorded sessions as an answer, the newest first."""
    library = SessionLibrary()
    rows = library.rows()
    library.close()
    return _json([{'name': row.name, 'title': row.title, 'figures': row.figures,
                   'words': row.words, 'problem': row.problem} for row in rows])


class Recording:
    """An opened session.

    :param session: :class:`mhri.session.ros.session_reader.Session`
    """

    def __init__(self, session):
        self._session, self._bags = session, session.bags
        self._builder = ReportBuilder(session)
        named = {name: robot.get('number') for name, robot in session.robots.items()}
        self._numbers = {name: number if type(number) is int and 0 < number < 256 else 0
                         for name, number in named.items()}
        recorded = [] if self._bags is None else self._bags.connections()
        self._topics = {camera.robot: camera.topic for camera in cameras_of(
            session.robots, self._numbers,
            [connection.topic for connection in recorded if connection.kind == _PICTURE])}

    def timeline(self):
        """Return everything but pictures and map as an answer (blocking: reads all bags)."""
        line, start = self._builder.line, self._builder.start
        tracks = {} if self._bags is None else self._tracks()
        return _json({
            'name': self._session.name, 'start': start, 'length_s': line.length_s,
            'robots': [{
                'name': name, 'number': number, 'colour': colour_of(number, True),
                'picture': self._topics.get(name, ''), 'track': tracks.get(name, [])}
                for name, number in sorted(self._numbers.items(), key=lambda item: item[1])],
            'events': [{
                'at_s': round(min(max(event.ros - start, 0.0), line.length_s), 2),
                'time_s': event.wall, 'kind': event.kind, 'robot': event.robot,
                'severity': _SEVERITIES.get(event.severity, CALM), 'text': event.text}
                for event in line.events[:MAX_EVENTS]],
            'driven': [[span.begin_s, span.end_s, span.robot] for span in line.driven],
            'stopped': [[span.begin_s, span.end_s] for span in line.stopped],
            'map': self._map_place(), 'problems': self._session.problems[:20]})

    def _tracks(self):
        """Return {robot: [[seconds, x, y, yaw, forward m/s, turn rad/s]]}, as far as known.

        x, y, yaw [m, rad] are on the map, None while not placed; if no robot ever was, by their
        odometry. A row of seconds alone repeats the one before.
        """
        builder, bags = self._builder, self._bags
        robots = {builder.odometry_topic(name): name for name in self._numbers}
        places, tracks, origins = {}, {name: [] for name in self._numbers}, {}
        bags.step_s = STEP_S
        try:
            for recorded in bags.after(bags.start_ns - 1, lambda connection: builder.is_odometry(
                    connection) or builder.is_places(connection)):
                if builder.is_places(recorded.connection):
                    places.update({name: pose for name, pose in builder.origins(recorded).items()
                                   if pose is not None})
                    continue
                name, motion = robots[recorded.connection.topic], builder.motion(recorded)
                if motion is not None and motion.pose is not None:
                    tracks[name].append((recorded.time_ns, motion, places.get(name)))
        except DAMAGED as error:
            self._session.problems.append('a bag is damaged: {}'.format(error))
        if not places:
            origins = dict.fromkeys(tracks, Pose(0.0, 0.0, 0.0))
        return {name: list(self._rows(rows, origins.get(name))) for name, rows in tracks.items()}

    def _rows(self, readings, origin):
        before = None
        for time_ns, motion, placed in readings:
            at_s = round((time_ns - self._bags.start_ns) / _NS, 2)
            placed = placed or origin
            row = [None] * 3 if placed is None else _rounded(composed(
                placed, motion.pose))
            row += [round(motion.linear_mps, 2), round(motion.angular_rad_s, 2)]
            yield [at_s] if row == before else [at_s, *row]
            before = row

    def _grid(self):
        """Return the last map, None if the session has none."""
        for recorded in () if self._bags is None else self._bags.newest(
                self._bags.end_ns, lambda connection: connection.topic == MAP
                and connection.kind == 'nav_msgs/OccupancyGrid'):
            message = self._builder.message(recorded)
            try:
                return None if message is None else grid_of_message(message)
            except GridError:
                return None
        return None

    def _map_place(self):
        """Return where the map is, as the socket says it; None without a map."""
        grid = self._grid()
        return None if grid is None else {
            'version': 0, 'width': grid.cells.shape[1], 'height': grid.cells.shape[0],
            'resolution_m': grid.resolution_m, 'x': grid.origin.x_m, 'y': grid.origin.y_m,
            'yaw': grid.origin.heading_rad}

    def map(self):
        """Return the picture of the map as an answer."""
        grid = self._grid()
        return ('', b'no map is recorded') if grid is None else ('png', map_picture(grid))

    def picture(self, robot, at_s):
        """Return the newest picture of a robot at a time as an answer, with its own time."""
        topic = self._topics.get(robot)
        found = self._bags.newest(
            self._bags.start_ns + round(at_s * _NS), lambda connection: connection.kind == _PICTURE
            and connection.topic == topic) if topic else ()
        picture = picture_of(found[-1].data) if found else None
        if picture is None:
            return '', b'no picture is recorded of it until then'
        return (*picture, {'at_s': (found[-1].time_ns - self._bags.start_ns) / _NS})


def _rounded(pose):
    return [round(pose.x_m, 2), round(pose.y_m, 2), round(pose.heading_rad, 3)]


def serve(answer, requests, out):
    """Answer requests until there are no more.

    :param answer: function of the parts of a request that returns (kind, bytes) and, if it likes,
        a dict with more of the line in front of them
    """
    for line in requests:
        try:
            kind, body, *more = answer(*json.loads(line.decode()))
        except (NotASession, *DAMAGED) as error:
            kind, body, more = '', str(error).encode(), ()
        out.write(json.dumps({'kind': kind, 'size': len(body), **(more[0] if more else {})}
                             ).encode() + b'\n' + body)
        out.flush()


def main():
    """Serve the session in a folder; without one, the list of sessions."""
    out = os.fdopen(os.dup(1), 'wb')
    # Nothing that a library prints may come between.
    os.dup2(2, 1)
    requests, paths = sys.stdin.buffer, sys.argv[1:]
    if not paths:
        serve(lambda _: sessions(), requests, out)
        return
    try:
        with opened(paths[0]) as session:
            recording = Recording(session)
            serve(lambda what, *words: {
                'timeline': recording.timeline, 'map': recording.map,
                'picture': recording.picture}[what](*words), requests, out)
    except NotASession as error:
        said = str(error).encode()
        serve(lambda *_: ('', said), requests, out)
