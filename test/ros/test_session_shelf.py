# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The sessions' replays and reports: one that cannot be started stands in nobody's way.

And the folder of one that was killed, and goes on.
"""
import json
import os
import subprocess
import sys

import pytest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..'))

from mhri.recording.folder import EVENTS_JSONL, SessionEvent  # noqa: E402
from mhri.session.ros.session_folder import SessionFolder  # noqa: E402
from mhri.session.ros.session_shelf import SessionShelf  # noqa: E402
from support import made_session as made  # noqa: E402

PATIENCE_S = 120.0


@pytest.fixture
def shelf(tmp_path):
    made = SessionShelf({'ROS_HOME': str(tmp_path)}, lambda path: [sys.executable, '-c', ''])
    yield made
    made.close()


def news(shelf, key):
    """Return the next news of a kind."""
    while True:
        kind, value = shelf.news.get(timeout=PATIENCE_S)
        if kind == key:
            return value


@pytest.fixture
def short_of_processes(monkeypatch):
    """Let none be started until what this returns undoes it."""
    def refuse(*words, **options):
        raise BlockingIOError(11, 'Resource temporarily unavailable')
    monkeypatch.setattr(subprocess, 'Popen', refuse)
    return monkeypatch


def test_a_replay_that_cannot_be_started_can_be_asked_for_again(shelf, short_of_processes):
    shelf.replay('x')
    assert news(shelf, 'told').startswith('cannot replay: ')
    short_of_processes.undo()
    shelf.replay('x')
    assert news(shelf, 'told').startswith('the replay opens')


def test_a_report_that_cannot_be_started_can_be_asked_for_again(shelf, short_of_processes):
    shelf.report('x')
    assert news(shelf, 'told') == 'no report: Resource temporarily unavailable'
    assert news(shelf, 'report') == ''
    short_of_processes.undo()
    shelf.report('x')
    assert 'mhri/sessions/x' in news(shelf, 'told'), 'the word of the program that looked for it'
    assert news(shelf, 'report') == ''


def test_a_report_of_the_panel_is_that_of_the_terminal(shelf, tmp_path):
    """This process has imported mhri, and in a devel space has its sources first, as the panel."""
    name = '2026-01-02-03-04-05'
    folder = tmp_path / 'mhri' / 'sessions' / name
    made.write_session(folder)
    shelf.report(name)
    with open(news(shelf, 'report'), encoding='utf-8') as page:
        by_panel = page.read()
    done = subprocess.run(['rosrun', 'mhri', 'mhri_report', str(folder)], timeout=PATIENCE_S,
                          env=dict(os.environ, ROS_HOME=str(tmp_path)), stderr=subprocess.PIPE)
    assert done.returncode == 0, done.stderr
    path = tmp_path / 'mhri' / 'reports' / name / 'report.html'
    assert 'not installed' not in by_panel and path.read_text(encoding='utf-8') == by_panel


@pytest.mark.parametrize('left', ['', '{"a": 1}\n', '{"a": 1}\n{"b'])
def test_a_recording_that_goes_on_leaves_no_empty_line(tmp_path, left):
    (tmp_path / EVENTS_JSONL).write_text(left)
    folder = SessionFolder(str(tmp_path))
    folder.end_line()
    folder.tell(SessionEvent(1.0, 1.0, 'record', 'it goes on'))
    folder.close()
    lines = (tmp_path / EVENTS_JSONL).read_text().split('\n')
    assert '' not in lines[:-1] and lines[-1] == ''
    assert json.loads(lines[-2])['text'] == 'it goes on'
