# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The recording row: what is asked for, and that it tells what really happens."""
from dataclasses import replace

import pytest
from python_qt_binding.QtCore import QEvent, Qt
from python_qt_binding.QtTest import QTest
from python_qt_binding.QtWidgets import QApplication, QLineEdit

from mhri.base.gui import theme
from mhri.recording.gui.recording_row import clock_text, recording_text, RecordingRow
from mhri.recording.recording import RecordingStatus

PATH = '/home/op/.ros/bot1_2026-11-21-14-02-11.bag'


LIVE = RecordingStatus('recording', PATH, 12.3, 2400, 812345, 199.7)
SAVED = replace(LIVE, state='ended', note='saved 2400 messages, 0.8 MB: ' + PATH)
REFUSED = RecordingStatus('failed', note='no IMU topic', attention=True)
OFF = RecordingStatus()
NOT_THERE = ('cannot write to "/proc/x.bag": /proc belongs to the system; '
             'saving to {} instead'.format(PATH))
ELSEWHERE = replace(SAVED, note=NOT_THERE + '; ' + SAVED.note)


@pytest.fixture
def row(operator):
    widget = RecordingRow()
    widget.resize(760, 90)
    operator.show(widget)
    widget.show_recording(OFF)
    return widget


@pytest.mark.parametrize('status, text', [
    (OFF, ''),
    (LIVE, 'recording 00:12   2,400 messages   0.8 MB   200 Hz'),
    (replace(LIVE, note='the disk is nearly full: 0.8 GB free', attention=True),
     'recording 00:12   2,400 messages   0.8 MB   200 Hz   the disk is nearly full: 0.8 GB free'),
    (SAVED, 'saved 2400 messages, 0.8 MB: ' + PATH),
    (replace(LIVE, note=NOT_THERE, attention=True),
     'recording 00:12   2,400 messages   0.8 MB   200 Hz   saving elsewhere, /proc belongs to the '
     'system'),
    (ELSEWHERE,
     'saved elsewhere, /proc belongs to the system: 2400 messages, 0.8 MB: ' + PATH),
    (REFUSED, 'no IMU topic'),
])
def test_the_line(row, status, text):
    row._numbers._next = None
    row.show_recording(status)
    assert recording_text(status) == text == row.recording_label.text()


@pytest.mark.parametrize('duration_s, text', [
    (0.0, '00:00'), (59.99, '00:59'), (61.0, '01:01'), (3599.0, '59:59'), (3661.0, '1:01:01')])
def test_durations(duration_s, text):
    assert clock_text(duration_s) == text


@pytest.mark.parametrize('status, shape', [
    (OFF, None), (LIVE, theme.DISC), (replace(LIVE, attention=True), theme.TRIANGLE),
    (SAVED, theme.TICK), (ELSEWHERE, theme.TRIANGLE), (REFUSED, theme.TRIANGLE)])
def test_every_state_has_a_shape(row, status, shape):
    row._numbers._next = None
    row.show_recording(status)
    sign = row.recording_sign.sign
    assert (sign and sign[0]) == shape


@pytest.mark.parametrize('status, important', [
    (SAVED, 'saved 2400 messages, 0.8 MB'),
    (ELSEWHERE, 'saved elsewhere, /proc belongs to the system: 2400 messages, 0.8 MB')])
def test_in_a_narrow_window_the_folder_gives_way_first(row, operator, status, important):
    row._numbers._next = None
    row.show_recording(status)
    widths = [row.recording_label.fontMetrics().horizontalAdvance(text) for text in (
        recording_text(status).replace('/home/op/.ros/', ''), important)]
    for width, text in zip(widths, (important + ': ' + PATH.rpartition('/')[2], important)):
        row.recording_label.resize(width + 1, 20)
        assert row.recording_label.shown_text() == text


def test_the_menu_stays_open_while_entries_are_ticked(row, operator):
    row.offer_extras(('odometry', 'scan'))
    menu = row.extras_menu
    menu.popup(row.mapToGlobal(row.rect().bottomLeft()))
    operator.wait_until(menu.isVisible)
    for key in ('odometry', 'scan'):
        QTest.mouseClick(menu, Qt.LeftButton, Qt.NoModifier,
                         menu.actionGeometry(row.extras[key]).center())
        assert menu.isVisible() and key in row.chosen_extras()
    assert row.extras_button.text() == 'IMU + 2'
    menu.setActiveAction(row.extras['scan'])
    QTest.keyClick(menu, Qt.Key_Space)
    assert menu.isVisible() and row.chosen_extras() == ('odometry',)
    QTest.keyClick(menu, Qt.Key_Escape)
    assert not menu.isVisible()


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


def test_a_box_that_is_not_answered_goes_back(row, operator):
    row._answer.setInterval(30)
    row._asked.timeout_s = 0.01
    operator.click(row.record_check)
    assert row.record_check.isChecked()
    operator.wait_until(lambda: not row.record_check.isChecked())


def test_the_path_comes_when_the_file_is_open(row):
    row.show_recording(replace(LIVE, path=''))
    assert row.path_edit.text() == ''
    row.show_recording(LIVE)
    assert row.path_edit.text() == PATH


def test_a_refused_recording_is_told_at_once(row, operator):
    operator.click(row.record_check)
    row._asked.drop()
    row.show_recording(REFUSED)
    assert not row.record_check.isChecked() and row.recording_label.text() == 'no IMU topic'


@pytest.mark.parametrize('key', [Qt.Key_Return, Qt.Key_Escape])
def test_the_keyboard_leaves_the_path(row, operator, key):
    operator.click(row.path_edit)
    assert row.path_edit.hasFocus()
    operator.hit(row.path_edit, key)
    assert not row.path_edit.hasFocus()


def test_extras_are_chosen_in_the_menu(row, operator, heard):
    asked = heard(row.record_requested)
    assert row.extras_button.text() == 'IMU only'
    # The menu of a button runs a loop of its own while it is open; so it is opened by itself.
    row.extras_menu.popup(row.mapToGlobal(row.rect().center()))
    for key in ('depth', 'odometry'):
        place = row.extras_menu.actionGeometry(row.extras[key]).center()
        QTest.mouseClick(row.extras_menu, Qt.LeftButton, Qt.NoModifier, place)
        row.extras_menu.popup(row.mapToGlobal(row.rect().center()))
    row.extras_menu.hide()
    assert row.extras_button.text() == 'IMU + 2'
    operator.click(row.record_check)
    assert asked == [('', ('odometry', 'depth'))]


def test_what_the_robot_has_not_is_not_recorded_but_remembered(row):
    row.restore_settings({'extras': ['scan', 'rgb', 'gone']})
    row.offer_extras(('odometry', 'scan'))
    assert row.chosen_extras() == ('scan',)
    assert row.save_settings() == {'extras': ['scan', 'rgb']}


def test_browse_blocks_nothing_and_hides_nothing(row, operator):
    operator.click(row.browse_button)
    dialog = row._dialog
    operator.wait_until(dialog.isVisible)
    assert not dialog.isModal() and QApplication.activeModalWidget() is None
    assert dialog.parentWidget() is None, 'or its lists would drive the robots'
    operator.click(row.browse_button)
    assert row._dialog is dialog
    name = dialog.findChild(QLineEdit, 'fileNameEdit')
    name.setText('/tmp/chosen')
    dialog.accept()
    assert row.path_edit.text() == '/tmp/chosen.bag' and not dialog.isVisible()
    operator.click(row.browse_button)
    row.hide()
    assert not dialog.isVisible()
    dialog.deleteLater()
    QApplication.sendPostedEvents(None, QEvent.DeferredDelete)
    row.show()
    operator.click(row.browse_button)
    assert row._dialog is not dialog and row._dialog.isVisible()


def test_numbers_change_four_times_a_second_at_most(row):
    row._numbers._next = None
    row.show_recording(LIVE)
    row.show_recording(replace(LIVE, messages=9999))
    assert '2,400' in row.recording_label.text()


def test_the_default_path_is_shown_where_nothing_is_typed(row):
    row.set_default_path('~/.ros/bot1_<date-time>.bag')
    assert row.path_edit.placeholderText() == '~/.ros/bot1_<date-time>.bag' and row.path == ''
