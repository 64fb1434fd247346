# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Lists, replays and reports the sessions on this computer's disk, without blocking the screen.

A replay is a separate program with its own master and screen, which outlives this screen. A report
is a separate process, too, which ends with this screen.
"""
import os
import queue
import signal
import subprocess
import tempfile
import threading

import rospkg

from mhri.base.io.files import text_in
from mhri.base.text import tidy_text
from mhri.devices.io import child
from mhri.graph.ros.worker import Worker
from mhri.recording.folder import EVENTS_JSONL, is_folder_name, SESSION_YAML, sessions_home
from mhri.session.catalogue import newest, progress_of, row_of, SessionRow
from mhri.session.ros.report_files import folder_for, PAGE

# Limits of reading a folder for the list: file sizes [bytes], and the number of files counted.
_LARGEST_INFO, _LARGEST_EVENTS, _MAX_FILES = 10 ** 6, 5 * 10 ** 6, 5000
# A failure of a replay is reported if it happens within this time [s].
_SOON_S = 60.0


def replay_command(path):
    """Return the command that replays a session with its own master and screen.

    :raises rospkg.ResourceNotFound: the workspace with mhri is not sourced
    """
    top = os.path.realpath(rospkg.RosPack().get_path('mhri'))
    return [os.path.join(top, 'utils', 'host', 'mhri_run.sh'), '--replay', path]


class SessionLibrary:
    """The sessions; every method returns at once and puts its results into the queue ``news``.

    Results are ("rows", [:class:`mhri.session.catalogue.SessionRow`]), ("message", a sentence),
    ("progress", percent) and ("report", path of the page, or '' after a sentence with the reason).

    :param env: environment, for ``ROS_HOME``
    :param command: function of a session's path that returns the command to replay it
    """

    def __init__(self, env=os.environ, command=replay_command):
        self._env = dict(env)
        self._command = command
        self.home = sessions_home(env)
        self.news = queue.Queue()
        self._worker = Worker('sessions').start()
        self._lock = threading.Lock()
        self._report = None
        self._cancelled = False

    def refresh(self):
        """Read the list of sessions."""
        self._worker.do(self._look)

    def _look(self):
        self.news.put(('rows', self.rows()))

    def rows(self):
        """Return a :class:`SessionRow` of each session, the newest first (blocking)."""
        try:
            names = newest(filter(is_folder_name, os.listdir(self.home)))
        except OSError as error:
            names = ()
            if not isinstance(error, FileNotFoundError):
                self.news.put(('message', 'cannot read {}: {}'.format(self.home, error.strerror)))
        rows = []
        for name in names:
            path = os.path.join(self.home, name)
            if os.path.isdir(path):
                rows.append(self._row(name, path))
        return rows

    @staticmethod
    def _row(name, path):
        try:
            info, events = (text_in(os.path.join(path, part), most) or '' for part, most in (
                (SESSION_YAML, _LARGEST_INFO), (EVENTS_JSONL, _LARGEST_EVENTS)))
            return row_of(name, info, events, _sizes(path))
        except OSError as error:
            return SessionRow(name, problem='it cannot be read: {}'.format(error.strerror))
        except (ValueError, RecursionError):
            return SessionRow(name, problem='{} is damaged'.format(SESSION_YAML))

    def replay(self, name):
        """Replay a session on its own screen."""
        threading.Thread(target=self._replay, args=(os.path.join(self.home, name),),
                         name='replay', daemon=True).start()

    def _replay(self, path):
        env = {key: value for key, value in self._env.items()
               if key not in ('ROS_MASTER_URI', 'ROS_IP', 'ROS_HOSTNAME', 'ROS_NAMESPACE')}
        with tempfile.TemporaryFile() as said:
            try:
                process = subprocess.Popen(self._command(path), env=env, stdin=subprocess.DEVNULL,
                                           stdout=said, stderr=said, start_new_session=True)
            except (OSError, rospkg.ResourceNotFound) as error:
                self.news.put(('message', 'cannot replay: {}'.format(error)))
                return
            self.news.put(('message', 'the replay opens in a window of its own, in a moment'))
            try:
                failed = process.wait(_SOON_S) not in (0, -signal.SIGINT, 130, 143)
            except subprocess.TimeoutExpired:
                # It plays, possibly for hours; wait to reap the process.
                process.wait()
                return
            if failed:
                self.news.put(('message', 'the replay failed: {}'.format(_last_line(said))))

    def report(self, name):
        """Make the report of a session; ignored while another one is being made."""
        threading.Thread(target=self._make, args=(name,), name='report', daemon=True).start()

    def _make(self, name):
        with self._lock:
            if self._report is not None:
                return
            self._cancelled = False
            try:
                self._report = subprocess.Popen(
                    # Lower the priority, so that driving is not disturbed.
                    ['nice'] + child.command('mhri.nodes.mhri_report',
                                             os.path.join(self.home, name)),
                    env=self._env, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                    stderr=subprocess.PIPE, start_new_session=True)
            except OSError as error:
                self.news.put(('message', 'no report: {}'.format(error.strerror)))
                self.news.put(('report', ''))
                return
            process = self._report
        self._follow(process, name)

    def _follow(self, process, name):
        """Put the progress of a report, then its outcome, into the queue."""
        said = ''
        for line in process.stderr:
            said = line.decode('utf-8', 'replace').strip() or said
            percent = progress_of(said)
            if percent is not None:
                self.news.put(('progress', percent))
        code = process.wait()
        with self._lock:
            self._report, cancelled = None, self._cancelled
        if code == 0:
            self.news.put(('report', os.path.join(folder_for(name, self._env), PAGE)))
            return
        self.news.put(('message', 'report cancelled' if cancelled else
                       'no report: {}'.format(tidy_text(said) or 'it failed')))
        self.news.put(('report', ''))

    def cancel(self):
        """Cancel the report being made."""
        with self._lock:
            if self._report is not None:
                self._cancelled = True
                self._report.send_signal(signal.SIGTERM)

    def close(self):
        """Cancel the report being made; replays go on."""
        self.cancel()
        self._worker.stop()


def _sizes(path):
    """Return {name: bytes} of the files in a folder."""
    found = {}
    with os.scandir(path) as entries:
        for entry in entries:
            if len(found) >= _MAX_FILES:
                break
            if entry.is_file(follow_symlinks=False):
                found[entry.name] = entry.stat(follow_symlinks=False).st_size
    return found


def _last_line(stream):
    """Return the last line of a process's output."""
    size = stream.seek(0, os.SEEK_END)
    stream.seek(max(0, size - 2000))
    lines = stream.read().decode('utf-8', 'replace').strip().splitlines()
    return tidy_text(lines[-1]) if lines else 'no output'
