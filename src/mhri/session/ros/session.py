# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The session of this host: recording, marks and lines."""
from collections import deque
from dataclasses import dataclass, field, replace
from datetime import datetime
import os
import socket
import threading
import time

import rospkg
import rospy

from mhri.base.io.files import text_in
from mhri.graph.ros.master_api import MasterError
from mhri.graph.ros.worker import Worker
from mhri.recording.folder import (
    BAG_S, CAMERA_ALL, CAMERA_RATE, CAMERA_STILLS, ERROR, EVENTS_JSONL, INFO, is_of_mark, marks_of,
    read_events, SessionEvent, SessionInfo, sessions_home, WARNING)
from mhri.recording.recording import PathRefused, RecordingLimits, size_text
from mhri.recording.ros.bag_file import error_text
from mhri.recording.ros.recorder import receipt_clock
from mhri.session.flags import flags_of
from mhri.session.ros.graph_lines import GraphLines
from mhri.session.ros.graph_robots import GraphRobots
from mhri.session.ros.inputs import SessionInputs
from mhri.session.ros.moment import Moment
from mhri.session.ros.session_folder import SessionFolder
from mhri.session.ros.session_writer import SessionWriter
from mhri.session.ros.tap import SessionTap
from mhri.session.topics import PANEL_EVENTS

# The parameter with the folder of the current recording, to continue it after a kill.
RECORDING = '/mhri_session/recording'
# A mark while not recording saves the ring and records for this long after it [s].
RUN_ON_S = 30.0
CLOSE_S = 20.0
LOOK_S = 2.0


@dataclass(frozen=True)
class SessionOptions:
    """Contents and location of the recording.

    ``cameras`` is "all", "stills" or a rate [Hz] as text; with ``out_of_sight`` the recorder
    connects to all cameras directly, including those that no screen shows; ``home`` is the folder
    of all sessions. The ring holds ``ring_s`` [s], at most ``ring_mb`` [MB], with
    ``ring_pictures_hz`` pictures per second and camera. A bag lasts at most ``bag_s`` [s].
    """

    cameras: str = CAMERA_ALL
    out_of_sight: bool = False
    home: str = ''
    ring_s: float = 30.0
    ring_mb: float = 64.0
    ring_pictures_hz: float = 2.0
    bag_s: float = BAG_S
    limits: RecordingLimits = field(default_factory=RecordingLimits)

    @property
    def rate_hz(self):
        """Pictures to record per second and camera; None: all, 0: none."""
        return {CAMERA_ALL: None, CAMERA_STILLS: 0.0}.get(self.cameras) \
            if self.cameras in (CAMERA_ALL, CAMERA_STILLS) else float(self.cameras)


@dataclass(frozen=True)
class SessionStatus:
    """The state of the session, as in ``mhri/SessionState``."""

    recording: bool = False
    folder: str = ''
    since: float = 0.0
    lasts_s: float = 0.0
    messages: int = 0
    bytes: int = 0
    marks: int = 0
    problem: str = ''


class Session:
    """Records, marks and publishes lines; :meth:`record`, :meth:`mark`, :meth:`note` may block.

    :param types: {name: RobotType}
    :param options: :class:`SessionOptions`
    :param publish: called with each :class:`mhri.recording.folder.SessionEvent`, on any thread
    """

    def __init__(self, types, options, publish=lambda event: None):
        self.options = options
        self._publish = publish
        self.robots = GraphRobots(types)
        self.lines = GraphLines(self._append)
        self._clock_ns = receipt_clock()
        self.tap = SessionTap(rospy.get_name() + '_recorder', options.limits, options.ring_s,
                              round(options.ring_mb * 1e6), self.lines.watched, self._clock_ns,
                              options.bag_s)
        self._inputs = SessionInputs(self.tap, self.robots, self.lines.follow,
                                     options.out_of_sight)
        self._moment = Moment(self.tap, self.robots)
        self._worker = Worker('session', self._look, LOOK_S)
        self._life = threading.RLock()
        # Guards the lines: each earlier line goes into a new recording exactly once.
        self._saying = threading.Lock()
        self._recent = deque()
        self._folder = None
        self._writer = None
        self._until_s = None
        self._begun_s = 0.0
        self._marks = 0
        # The lines about marks of this session, or of the last one.
        self._of_marks = []
        self._status = SessionStatus()

    def start(self):
        """Join the graph; continue a recording that was killed recently.

        :raises OSError: no address is available
        """
        self.tap.start()
        self.lines.start()
        self._set_pictures()
        gone_on = threading.Event()
        self._worker.start()
        for job in (self._go_on, gone_on.set, self._look):
            self._worker.do(job)
        # An earlier request would begin a second session, or find none to end.
        while not gone_on.wait(0.1) and not rospy.is_shutdown():
            pass

    @property
    def pictures_hz(self):
        """The rate at which screens relay pictures [1/s]; -1: all, 0: none."""
        if self.options.out_of_sight:
            return 0.0
        rate_hz = self.options.rate_hz
        if self._folder is None or rate_hz == 0.0:
            return self.options.ring_pictures_hz
        return -1.0 if rate_hz is None else rate_hz

    def status(self):
        """Return the current :class:`SessionStatus`; cheap."""
        writer, status = self._writer, self._status
        if writer is None:
            return status
        messages, size = writer.written
        return replace(status, messages=messages, bytes=size, marks=self._marks,
                       lasts_s=time.monotonic() - self._begun_s,
                       problem=writer.failure or writer.warning or status.problem)

    def record(self, on):
        """Start or stop recording; return (success, a sentence)."""
        with self._life:
            try:
                if on:
                    self._until_s = None
                    return True, 'recording to ' + (self._folder or self._begin()).path
                return (True, self._end()) if self._folder else (True, 'nothing was recorded')
            except (PathRefused, OSError) as error:
                text = 'not recorded: {}'.format(error_text(error))
                self._status = replace(self._status, problem=text)
                rospy.logerr('%s', text)
                return False, text

    def mark(self, text=''):
        """Mark this moment; return (success, a sentence, the mark's name)."""
        with self._life:
            try:
                if self._folder is None:
                    self._begin()
                    self._until_s = time.monotonic() + RUN_ON_S
                elif self._until_s is not None:
                    self._until_s = time.monotonic() + RUN_ON_S
                self._marks += 1
                name = 'm{}'.format(self._marks)
                poses, stills = self._moment.poses(), self._keep_stills(name)
                # At the robot that is driven, unless a screen reports which one it showed.
                robot = next(iter(self.lines.watch.state()['selected'] or ()), '')
                self._write('mark', INFO, robot, text.strip() or 'mark {}'.format(self._marks),
                            {'id': name, 'poses': poses, 'stills': stills})
            except (PathRefused, OSError) as error:
                return False, 'not marked: {}'.format(error_text(error)), ''
            return True, 'mark {}, {} still{}'.format(
                self._marks, len(stills), '' if len(stills) == 1 else 's'), name

    def flags(self):
        """Return (the frame of the map, the flags in it) of this session, or of the last one."""
        frame = self._moment.frame()
        return frame, flags_of(marks_of(list(self._of_marks)), frame)

    def note(self, name, text):
        """Save the text of a mark (name '': the newest); return (success, a sentence)."""
        with self._life:
            name = name or 'm{}'.format(self._marks)
            if self._folder is None or not any(name == 'm{}'.format(number + 1)
                                               for number in range(self._marks)):
                return False, 'there is no mark {} in a session under way'.format(name)
            try:
                self._write('note', INFO, '', text.strip(), {'mark': name})
            except OSError as error:
                return False, 'not noted: {}'.format(error_text(error))
            return True, 'noted at mark {}'.format(name[1:])

    def still(self):
        """Save a still of every active camera; return (success, a sentence)."""
        with self._life:
            if self._folder is None:
                return False, 'no session is recorded'
            try:
                stem = '{:%H-%M-%S}-{:03d}'.format(datetime.now(), int(time.time() * 1e3) % 1000)
                stills = self._keep_stills(stem)
                if not stills:
                    return False, 'no camera is in sight'
                self._write('still', INFO, '', '{} stills'.format(len(stills)),
                            {'stills': stills, 'poses': self._moment.poses()})
            except OSError as error:
                return False, 'no still: {}'.format(error_text(error))
            return True, '{} stills saved in {}'.format(len(stills), self._folder.path)

    def update(self):
        """Handle failures, timeouts and silent robots; call it a few times a second."""
        writer = self._writer
        if writer is not None and writer.failure:
            self._worker.do(self._end_failed, writer)
        elif self._until_s is not None and time.monotonic() > self._until_s:
            self._worker.do(self._end_run_on)
        if PANEL_EVENTS in self.robots.published:
            return  # a screen reports it itself
        self.lines.silence(self._inputs.silence_s(self._clock_ns()), time.monotonic(),
                           self._clock_ns() * 1e-9)

    def close(self):
        """End the recording and leave the graph."""
        with self._life:
            if self._folder is not None:
                self._end()
        self._worker.stop()
        self.tap.close()

    def _keep_stills(self, stem):
        """Write a still of every active camera; return their paths in the folder.

        :raises OSError: the disk failed
        """
        stills = []
        for name, jpeg in self._moment.stills(stem):
            self._folder.keep(name, jpeg)
            stills.append(name)
        return stills

    def _info(self):
        options = self.options
        recorded = options.cameras if options.rate_hz in (None, 0.0) else CAMERA_RATE
        return SessionInfo(time.time(), _version(), socket.gethostname(), self._moment.frame(),
                           recorded, options.rate_hz or 0.0, dict(self.robots.entries))

    def _begin(self):
        """Create a folder and record into it.

        :raises PathRefused, OSError: the folder cannot be written
        """
        usual = sessions_home(os.environ)
        home, note = self.options.home or usual, ''
        try:
            folder = SessionFolder.make(home, datetime.now(), self._info())
        except PathRefused as error:
            if home == usual:
                raise
            folder = SessionFolder.make(usual, datetime.now(), self._info())
            note = '{}; recording to {} instead'.format(error, folder.path)
        self._open(folder, 0, note)
        self._write('start', INFO, '', 'recording begins', self.lines.watch.state())
        if note:
            self._write('record', WARNING, '', note)
        return folder

    def _open(self, folder, number, note=''):
        writer = SessionWriter(folder.path, number, self.options.limits, lambda: None)
        with self._saying:
            for event in self._recent:
                folder.append(event)
            self._folder, self._writer, self._marks = folder, writer, 0
        self._begun_s = time.monotonic()
        self._status = SessionStatus(True, folder.path, time.time(), problem=note)
        writer.start()
        self._set_pictures()
        self.tap.record_to(writer)
        self._worker.do(self._note_folder, folder.path)
        rospy.loginfo('recording to %s', folder.path)

    def _go_on(self):
        """Continue the recording interrupted by a kill of this node."""
        path = rospy.get_param(RECORDING, '')
        folder = SessionFolder.go_on(path) if isinstance(path, str) and path else None
        if folder is None:
            return
        with self._life:
            if self._folder is not None:
                return
            try:
                self._of_marks = list(filter(is_of_mark, read_events(
                    text_in(os.path.join(path, EVENTS_JSONL)))))
                self._open(folder, folder.next_bag())
                self._marks = len(marks_of(self._of_marks))
                # The kill may have cut off the last line.
                folder.end_line()
                self._write('record', WARNING, '',
                            'the recorder was killed: a moment is missing', {'lost': True})
            except OSError as error:
                rospy.logerr('the recording cannot go on: %s', error_text(error))

    @staticmethod
    def _note_folder(path):
        """Store the folder of the recording on the master, '' for none (blocking)."""
        rospy.set_param(RECORDING, path)

    def _end(self, reason=''):
        """End the recording, close its files, and return a summary (under the lock)."""
        folder, writer = self._folder, self._writer
        try:
            self._write('end', ERROR if reason else INFO, '', reason or 'recording ends')
        except OSError as error:
            rospy.logdebug('no last line: %s', error)
        self.tap.stop_recording()
        writer.finish()
        closed = writer.closed.wait(CLOSE_S)
        messages, size = writer.written
        folder.close()
        said = '{} messages, {}: {}'.format(messages, size_text(size), folder.path)
        problem = writer.failure if closed else 'the disk does not answer'
        text = 'recording stopped, {}; saved {}'.format(problem, said) if problem else \
            'saved ' + said
        self._status = replace(self.status(), recording=False, problem=text if problem else '')
        self._writer = self._until_s = None
        self._set_pictures()
        self._worker.do(self._note_folder, '')
        (rospy.logerr if problem else rospy.loginfo)('%s', text)
        return text

    def _end_failed(self, writer):
        with self._life:
            if self._writer is writer:
                self._end('recording stops: ' + writer.failure)

    def _end_run_on(self):
        with self._life:
            if self._until_s is not None and time.monotonic() > self._until_s:
                self._end()

    def _set_pictures(self):
        """Set the tap's picture rate for the ring or the recording."""
        rate_hz = self.options.rate_hz
        idle_hz = self.options.ring_pictures_hz
        if self._folder is None and rate_hz != 0.0:
            rate_hz = idle_hz if rate_hz is None else min(rate_hz, idle_hz)
        self.tap.keep_pictures(rate_hz)

    def _look(self):
        """Find robots and topics, and subscribe them (blocking)."""
        try:
            new = self.robots.scan()
        except MasterError as error:
            rospy.logdebug('%s', error)
            return
        self._inputs.update()
        for robot in new:
            self._append('found', INFO, robot, 'joins the session', self.robots.entries[robot])

    def _append(self, *line):
        """Call :meth:`_write` with a line; log a failure of the disk."""
        try:
            self._write(*line)
        except OSError as error:
            rospy.logerr_throttle(10.0, 'a line is not kept: {}'.format(error_text(error)))

    def _write(self, kind, severity, robot, text, data=None, wall_s=None, ros_s=None):
        """Publish and write a line; while not recording, keep it as long as the ring lasts.

        :raises OSError: the disk failed
        """
        event = SessionEvent(wall_s or time.time(), ros_s or self._clock_ns() * 1e-9, kind, text,
                             severity, robot, data or {})
        if kind == 'start':
            self._of_marks = []
        elif is_of_mark(event):
            self._of_marks.append(event)
        self._publish(event)
        with self._saying:
            folder = self._folder
            if folder is not None:
                if kind == 'end':
                    # No line may follow the last one.
                    self._folder = None
                    self._recent.clear()
                folder.append(event)
                return
            self._recent.append(event)
            while self._recent[0].wall < event.wall - self.options.ring_s:
                self._recent.popleft()


def _version():
    try:
        return rospkg.RosPack().get_manifest('mhri').version
    except rospkg.ResourceNotFound:
        return ''
