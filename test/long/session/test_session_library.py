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

from mhri.recording.folder import EVENTS_JSONL, SessionEvent
from mhri.session.ros.session_folder import SessionFolder
from mhri.session.ros.session_library import SessionLibrary
from support import made_session as made

TIMEOUT_S = 120.0


@pytest.fixture
def library(tmp_path):
    made = SessionLibrary(dict(os.environ, ROS_HOME=str(tmp_path)),
                          lambda path: [sys.executable, '-c', ''])
    yield made
    made.close()


def news(library, key):
    """Return the next news of a kind."""
    while True:
        kind, value = library.news.get(timeout=TIMEOUT_S)
        if kind == key:
            return value


@pytest.fixture
def short_of_processes(monkeypatch):
    """Let none be started until what this returns undoes it."""
    def refuse(*words, **options):
        raise BlockingIOError(11, 'Resource temporarily unavailable')
    monkeypatch.setattr(subprocess, 'Popen', refuse)
    return monkeypatch


def test_what_cannot_be_started_can_be_asked_for_again(library, short_of_processes):
    library.report('x')
    news(library, 'message')
    assert news(library, 'report') == ''
    library.replay('x')
    refused = news(library, 'message')
    short_of_processes.undo()
    library.replay('x')
    assert news(library, 'message') != refused
    library.report('x')
    assert 'mhri/sessions/x' in news(library, 'message')


def test_a_report_of_the_panel_is_that_of_the_terminal(library, tmp_path):
    """This process has imported mhri, and in a devel space has its sources first, as the panel."""
    name = '2026-01-02-03-04-05'
    folder = tmp_path / 'mhri' / 'sessions' / name
    made.write_session(folder)
    library.report(name)
    with open(news(library, 'report'), encoding='utf-8') as page:
        by_panel = page.read()
    done = subprocess.run(['rosrun', 'mhri', 'mhri_report', str(folder)], timeout=TIMEOUT_S,
                          env=dict(os.environ, ROS_HOME=str(tmp_path)), stderr=subprocess.PIPE)
    assert done.returncode == 0, done.stderr
    path = tmp_path / 'mhri' / 'reports' / name / 'report.html'
    assert 'not installed' not in by_panel and path.read_text(encoding='utf-8') == by_panel


@pytest.mark.parametrize('left', ['', '{"a": 1}\n{"b'])
def test_a_recording_that_goes_on_leaves_no_empty_line(tmp_path, left):
    (tmp_path / EVENTS_JSONL).write_text(left)
    folder = SessionFolder(str(tmp_path))
    folder.end_line()
    folder.append(SessionEvent(1.0, 1.0, 'record', 'it goes on'))
    folder.close()
    lines = (tmp_path / EVENTS_JSONL).read_text().split('\n')
    assert '' not in lines[:-1] and lines[-1] == ''
    assert json.loads(lines[-2])['text'] == 'it goes on'
