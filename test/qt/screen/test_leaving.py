# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Closing asks in place while anything drives or records, and never whom a signal ends."""
import os
import signal

import pytest
from python_qt_binding.QtCore import Qt
from python_qt_binding.QtWidgets import QApplication

from mhri.standalone import Standalone

QUESTION = 'bot1 is driven: close anyway?'


@pytest.fixture
def program(tmp_path, operator):
    made = Standalone(['panel'], str(tmp_path / 'panel.json'))
    operator.show(made.window)
    made.presenter.asks_before_closing = lambda: QUESTION
    yield made
    made.window.close_now()


def test_it_asks_over_the_foot_and_stays(program, operator):
    bar = program.presenter.screen.leave_bar
    assert not bar.isVisible()
    for _ in range(2):
        program.window.close()
        assert program.window.isVisible() and bar.question == QUESTION
    assert QApplication.activeModalWidget() is None
    assert program.presenter.screen.arrangement.passing.isAncestorOf(bar)
    assert program.presenter.screen.stop_bar.stop_button.isVisible()
    assert bar.stay_button.hasFocus()
    operator.hit(bar.stay_button, Qt.Key_Return, 36)
    assert not bar.isVisible() and program.window.isVisible()


def test_close_closes(program, operator):
    program.window.close()
    operator.click(program.presenter.screen.leave_bar.close_button)
    assert not program.window.isVisible()


def test_nothing_is_asked_while_nothing_drives_or_records(program):
    program.presenter.asks_before_closing = lambda: ''
    program.window.close()
    assert not program.window.isVisible()


@pytest.mark.parametrize('number', [signal.SIGTERM, signal.SIGINT])
def test_a_signal_is_not_asked(program, operator, number):
    os.kill(os.getpid(), number)
    operator.wait_until(lambda: not program.window.isVisible())
