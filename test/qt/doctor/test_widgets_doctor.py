# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The window of the doctor: findings in words and shapes, and the report on the clipboard."""
import pytest
from python_qt_binding.QtGui import QGuiApplication

from mhri.doctor.facts import FAULT, Finding, FINE, WARNING
from mhri.doctor.gui.doctor_page import DoctorPage

FOUND = [
    Finding(FAULT, 'dead_node', '/bot1/base', 'is registered, but refuses connections',
            'bot1 stays "gone"', 'rosnode cleanup', ''),
    Finding(WARNING, 'clock', 'bot2', 'its clock is 2.0 s <ahead>', 'odd ages',
            'apt install chrony', 'to about 10 ms'),
    Finding(FINE, 'variables', 'this computer', 'the ROS variables fit the interfaces'),
]


@pytest.fixture
def window(operator):
    made = DoctorPage()
    operator.show(made)
    yield made
    made.close()
    made.deleteLater()


def test_each_finding_says_what_how_it_shows_and_how_to_mend_it(window):
    window.show_findings(FOUND, 1.2)
    text = window.text.toPlainText()
    for item in FOUND:
        for words in (item.about, item.problem, item.symptom, item.remedy, item.confidence):
            assert words in text
    assert window.summary.text() == '1 fault, 1 warning'
    assert all(mark in text for mark in '\u2612\u25b2\u25cf'), 'shapes, not colours alone'
    assert text.index('/bot1/base') < text.index('bot2') < text.index('this computer')


def test_nothing_wrong_is_said_so(window):
    window.show_findings(FOUND[2:], 0.4)
    assert window.summary.text() == 'nothing is wrong'


def test_it_is_asked_again_and_the_old_report_stays_meanwhile(window, operator, heard):
    asked = heard(window.examine_requested)
    window.show_findings(FOUND, 1.2)
    operator.click(window.again_button)
    assert asked == [()]
    window.show_busy()
    assert not window.again_button.isEnabled() and 'rosnode cleanup' in window.text.toPlainText()
    operator.click(window.again_button)
    assert asked == [()], 'not twice at once'
    window.show_failure('the examination failed: no memory')
    assert window.again_button.isEnabled() and 'no memory' in window.summary.text()


def test_the_report_goes_to_the_clipboard(window, operator):
    assert not window.isModal()
    window.show_busy()
    assert not window.copy_button.isEnabled()
    window.show_findings(FOUND, 1.2)
    operator.click(window.copy_button)
    copied = QGuiApplication.clipboard().text()
    assert 'rosnode cleanup' in copied and '1 faults, 1 warnings' in copied


def test_where_there_is_little_room_the_worst_can_be_read_whole(window, operator):
    """In a narrow drawer on a small screen."""
    window.resize(400, 420)
    window.show_findings(FOUND, 1.2)
    operator.settle()
    for item in FOUND[:2]:
        found = window.text.document().find(item.remedy)
        assert window.text.viewport().rect().contains(window.text.cursorRect(found)), item.remedy
