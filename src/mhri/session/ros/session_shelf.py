# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The sessions on this computer's disk: read, replayed and reported on, each beside the screen.

A replay is a program of its own with a master and a screen of its own: it is started, and left to
itself. A report is a process of its own, too, which ends with the screen.
"""
import os
import queue
import signal
import subprocess
import tempfile
import threading

import rospkg

from mhri.base.text import tidy_text
from mhri.devices.io import child
from mhri.graph.ros.worker import Worker
from mhri.recording.folder import EVENTS_JSONL, is_folder_name, SESSION_YAML, sessions_home
from mhri.session.catalogue import newest, progress_of, row_of, SessionRow
from mhri.session.ros.report_files import folder_for, PAGE

# What is larger is not read for a row of a list [bytes]; nor are more files of a folder counted.
_LARGEST_INFO, _LARGEST_EVENTS, _MOST_FILES = 10 ** 6, 5 * 10 ** 6, 5000
# A replay that ends sooner has failed, and says why [s].
_SOON_S = 60.0


def replay_command(path):
    """Return the command that replays a session on a master and a screen of its own.

    :raises rospkg.ResourceNotFound: the workspace with mhri is not sourced
    """
    top = os.path.realpath(rospkg.RosPack().get_path('mhri'))
    return [os.path.join(top, 'utils', 'host', 'mhri_run.sh'), '--replay', path]


class SessionShelf:
    """Every method returns at once; what comes of it is in ``news``, a queue.

    Of ("rows", [:class:`mhri.session.catalogue.SessionRow`]), ("told", a sentence),
    ("progress", percent) and ("report", path of the page, or '' if there is none: told why before).

    :param env: environment, for ``ROS_HOME``
    :param command: function of a session's path that returns the command which replays it
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

    def look(self):
        """Read which sessions there are."""
        self._worker.do(self._look)

    def _look(self):
        try:
            names = newest(filter(is_folder_name, os.listdir(self.home)))
        except OSError as error:
            names = ()
            if not isinstance(error, FileNotFoundError):
                self.news.put(('told', 'cannot read {}: {}'.format(self.home, error.strerror)))
        rows = []
        for name in names:
            path = os.path.join(self.home, name)
            if os.path.isdir(path):
                rows.append(self._row(name, path))
        self.news.put(('rows', rows))

    @staticmethod
    def _row(name, path):
        try:
            return row_of(name, _text(os.path.join(path, SESSION_YAML), _LARGEST_INFO),
                          _text(os.path.join(path, EVENTS_JSONL), _LARGEST_EVENTS), _sizes(path))
        except OSError as error:
            return SessionRow(name, problem='it cannot be read: {}'.format(error.strerror))
        except (ValueError, RecursionError):
            return SessionRow(name, problem='{} makes no sense'.format(SESSION_YAML))

    def replay(self, name):
        """Show a session on a screen of its own."""
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
                self.news.put(('told', 'cannot replay: {}'.format(error)))
                return
            self.news.put(('told', 'the replay opens in a window of its own, in a moment'))
            try:
                failed = process.wait(_SOON_S) not in (0, -signal.SIGINT, 130, 143)
            except subprocess.TimeoutExpired:
                # It plays. Somebody has to await its end, hours later.
                process.wait()
                return
            if failed:
                self.news.put(('told', 'the replay failed: {}'.format(_last_line(said))))

    def report(self, name):
        """Make the report of a session; one at a time."""
        threading.Thread(target=self._make, args=(name,), name='report', daemon=True).start()

    def _make(self, name):
        with self._lock:
            if self._report is not None:
                return
            self._cancelled = False
            try:
                self._report = subprocess.Popen(
                    # Whoever drives meanwhile comes first.
                    ['nice'] + child.command('mhri.nodes.mhri_report',
                                             os.path.join(self.home, name)),
                    env=self._env, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                    stderr=subprocess.PIPE, start_new_session=True)
            except OSError as error:
                self.news.put(('told', 'no report: {}'.format(error.strerror)))
                self.news.put(('report', ''))
                return
            process = self._report
        self._follow(process, name)

    def _follow(self, process, name):
        """Pass on how far a report is, and what has become of it."""
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
        self.news.put(('told', 'report cancelled' if cancelled else
                       'no report: {}'.format(tidy_text(said) or 'it failed')))
        self.news.put(('report', ''))

    def cancel(self):
        """End the report under way."""
        with self._lock:
            if self._report is not None:
                self._cancelled = True
                self._report.send_signal(signal.SIGTERM)

    def close(self):
        """End the report under way; replays go on."""
        self.cancel()
        self._worker.stop()


def _text(path, most):
    """Return the text of a file; '' of none, of a pipe, and of what is too large [bytes]."""
    if not os.path.isfile(path) or os.path.getsize(path) > most:
        return ''
    with open(path, encoding='utf-8', errors='replace') as stream:
        return stream.read()


def _sizes(path):
    """Return {name: bytes} of the files in a folder."""
    found = {}
    with os.scandir(path) as entries:
        for entry in entries:
            if len(found) >= _MOST_FILES:
                break
            if entry.is_file(follow_symlinks=False):
                found[entry.name] = entry.stat(follow_symlinks=False).st_size
    return found


def _last_line(stream):
    """Return the last line that a process said."""
    size = stream.seek(0, os.SEEK_END)
    stream.seek(max(0, size - 2000))
    lines = stream.read().decode('utf-8', 'replace').strip().splitlines()
    return tidy_text(lines[-1]) if lines else 'it said nothing'
