# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The sessions' replays and reports: one that cannot be started stands in nobody's way."""
import subprocess
import sys

import pytest

from mhri.ros.session.session_shelf import SessionShelf

PATIENCE_S = 60.0


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
