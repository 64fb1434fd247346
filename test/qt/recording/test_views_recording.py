# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The recording row: what is asked for, and that it tells what really happens."""
from dataclasses import replace
import time

import pytest
from python_qt_binding.QtCore import QEvent, Qt
from python_qt_binding.QtTest import QTest
from python_qt_binding.QtWidgets import QApplication, QFileDialog, QLineEdit

from mhri.base.gui import theme
from mhri.recording.gui.recording_row import recording_text, RecordingRow
from mhri.recording.recording import duration_text, RecordingStatus

PATH = '/home/op/.ros/bot1_2026-11-21-14-02-11.bag'


LIVE = RecordingStatus('recording', PATH, 12.3, 2400, 812345, 199.7)
SAVED = replace(LIVE, state='ended', note='saved 2400 messages, 0.8 MB: ' + PATH)
REFUSED = RecordingStatus('failed', note='no IMU topic', attention=True)
OFF = RecordingStatus()
REASON = '/proc belongs to the system'
ELSEWHERE = replace(SAVED, elsewhere=REASON)


@pytest.fixture
def row(operator):
    widget = RecordingRow()
    widget.resize(760, 90)
    operator.show(widget)
    widget.show_recording(OFF)
    return widget


FIGURES = ('00:12', '2,400', '0.8 MB', '200 Hz')


@pytest.mark.parametrize('status, parts, shape', [
    (OFF, (), None), (LIVE, FIGURES, theme.DISC),
    (replace(LIVE, note='the disk is nearly full', attention=True),
     (*FIGURES, 'the disk is nearly full'), theme.TRIANGLE),
    (SAVED, (SAVED.note,), theme.TICK), (ELSEWHERE, (SAVED.note, REASON), theme.TRIANGLE),
    (replace(LIVE, elsewhere=REASON, attention=True), (*FIGURES, REASON), theme.TRIANGLE),
    (REFUSED, (REFUSED.note,), theme.TRIANGLE)])
def test_the_line_and_its_sign(row, status, parts, shape):
    row.show_recording(status)
    assert bool(row.recording_label.text()) == bool(parts)
    assert all(part in row.recording_label.text() for part in parts)
    sign = row.recording_sign.sign
    assert (sign and sign[0]) == shape


@pytest.mark.parametrize('duration_s, text', [
    (-1.0, '00:00'), (0.0, '00:00'), (59.99, '00:59'), (61.0, '01:01'), (3599.0, '59:59'),
    (3661.0, '1:01:01')])
def test_durations(duration_s, text):
    assert duration_text(duration_s) == text


@pytest.mark.parametrize('status', [SAVED, ELSEWHERE])
def test_in_a_narrow_window_the_folder_gives_way_first(row, status):
    row.show_recording(status)
    whole = recording_text(status)
    name, important = whole.replace('/home/op/.ros/', ''), whole.rpartition(': ')[0]
    for text in (name, important):
        row.recording_label.resize(
            row.recording_label.fontMetrics().horizontalAdvance(text) + 1, 20)
        assert row.recording_label.shown_text() == text


def test_the_menu_stays_open_while_entries_are_ticked(row, operator, heard):
    row.offer_extras(('odometry', 'scan'))
    menu = row.extras_menu
    menu.popup(row.mapToGlobal(row.rect().bottomLeft()))
    operator.wait_until(menu.isVisible)
    for key in ('odometry', 'scan'):
        QTest.mouseClick(menu, Qt.LeftButton, Qt.NoModifier,
                         menu.actionGeometry(row.extras[key]).center())
        assert menu.isVisible() and key in row.chosen_extras()
    asked = heard(row.record_requested)
    menu.setActiveAction(row.extras['scan'])
    QTest.keyClick(menu, Qt.Key_Space)
    assert menu.isVisible() and row.chosen_extras() == ('odometry',)
    QTest.keyClick(menu, Qt.Key_Escape)
    assert not menu.isVisible()
    operator.click(row.record_check)
    assert asked == [('', ('odometry',))]


def test_a_click_asks_and_a_second_one_ends(row, operator, heard):
    asked, ended = heard(row.record_requested), heard(row.stop_record_requested)
    operator.click(row.record_check)
    assert asked == [('', ())] and ended == []
    row.show_recording(LIVE)
    assert row.record_check.isChecked() and row.path_edit.text() == PATH
    assert row.path_edit.isReadOnly() and not row.browse_button.isEnabled()
    operator.click(row.record_check)
    assert len(ended) == 1
    row.show_recording(SAVED)
    assert not row.record_check.isChecked() and row.path_edit.text() == ''
    assert row.browse_button.isEnabled() and not row.path_edit.isReadOnly()


def test_what_was_typed_is_asked_for_and_comes_back(row, operator, heard):
    asked = heard(row.record_requested)
    operator.click(row.path_edit)
    QTest.keyClicks(row.path_edit, ' /tmp/run one.bag ')
    operator.click(row.record_check)
    assert asked == [('/tmp/run one.bag', ())]
    row.show_recording(LIVE)
    row.show_recording(REFUSED)
    assert row.path_edit.text() == '/tmp/run one.bag'


@pytest.mark.parametrize('key', [Qt.Key_Return, Qt.Key_Escape])
def test_the_keyboard_leaves_the_path(row, operator, key):
    operator.click(row.path_edit)
    assert row.path_edit.hasFocus()
    operator.hit(row.path_edit, key)
    assert not row.path_edit.hasFocus()


def test_what_the_robot_has_not_is_not_recorded_but_remembered(row):
    row.restore_settings({'extras': ['scan', 'rgb', 'gone']})
    row.offer_extras(('odometry', 'scan'))
    assert row.chosen_extras() == ('scan',)
    assert row.save_settings() == {'extras': ['scan', 'rgb']}


def dialogs():
    """Return the file dialogs that are open."""
    return [widget for widget in QApplication.topLevelWidgets()
            if isinstance(widget, QFileDialog) and widget.isVisible()]


def test_browse_blocks_nothing_and_hides_nothing(row, operator, tmp_path):
    operator.click(row.browse_button)
    operator.wait_until(dialogs)
    dialog, = dialogs()
    assert not dialog.isModal() and QApplication.activeModalWidget() is None
    assert dialog.parentWidget() is None, 'or its lists would drive the robots'
    operator.click(row.browse_button)
    assert dialogs() == [dialog]
    name = dialog.findChild(QLineEdit, 'fileNameEdit')
    name.setText(str(tmp_path / 'chosen'))
    dialog.accept()
    assert row.path_edit.text() == str(tmp_path / 'chosen.bag') and not dialog.isVisible()
    operator.click(row.browse_button)
    row.hide()
    assert not dialog.isVisible()
    dialog.deleteLater()
    QApplication.sendPostedEvents(None, QEvent.DeferredDelete)
    row.show()
    operator.click(row.browse_button)
    assert len(dialogs()) == 1 and dialogs() != [dialog]


def test_numbers_change_four_times_a_second_at_most(row):
    begun, shown = time.monotonic(), set()
    for number in range(200):
        row.show_recording(replace(LIVE, messages=number))
        shown.add(row.recording_label.text())
    assert len(shown) <= 2 + 4.0 * (time.monotonic() - begun)
