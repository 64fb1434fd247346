# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The panel as a whole: what it shows of a view, what it asks for, and how large things are."""
from dataclasses import replace
import json

import pytest
from python_qt_binding.QtCore import QPoint, Qt
from python_qt_binding.QtGui import QColor, QPalette
from python_qt_binding.QtTest import QTest
from python_qt_binding.QtWidgets import QAbstractButton, QComboBox, QLabel, QLineEdit

from mhri.base import views
from mhri.base.brake_view import BrakeView
from mhri.base.gui import theme
from mhri.screen.gui.screen import ScreenWidget


def test_buttons_and_fields_ask(panel, operator, heard, four_robots):
    panel.show_view(four_robots)
    looked, added = heard(panel.look_requested), heard(panel.add_requested)
    removed, selected = heard(panel.remove_requested), heard(panel.selection_requested)
    operator.click(panel.look_button)
    QTest.keyClicks(panel.name_edit, 'bot5')
    operator.click(panel.add_button)
    QTest.keyClick(panel.name_edit, Qt.Key_Return)
    assert (looked, added) == ([()], ['bot5', 'bot5'])
    assert not panel.remove_button.isEnabled(), 'nothing is highlighted'
    operator.click(panel.robot_list.row('bot3'))
    operator.click(panel.remove_button)
    operator.click(panel.all_button)
    operator.click(panel.none_button)
    assert removed == ['bot3']
    assert selected == [['bot1', 'bot2', 'bot3', 'bot4'], []]


def test_a_name_problem_is_told_beside_the_field_until_it_is_edited(panel):
    panel.name_edit.setText('a b')
    panel.show_name_problem('a space is not allowed')
    assert panel.name_problem_label.text() == 'a space is not allowed'
    assert panel.name_problem_sign.sign is not None
    QTest.keyClick(panel.name_edit, Qt.Key_Backspace)
    assert panel.name_problem_label.text() == '' and panel.name_problem_sign.sign is None


def test_looking_says_so_in_place(panel):
    panel.show_look_result('looking ...', busy=True)
    assert panel.look_label.text() == 'looking ...' and not panel.look_button.isEnabled()
    panel.show_look_result('found 2 robots')
    assert panel.look_button.isEnabled()


def test_after_adding_a_robot_the_keys_drive_again(panel, operator):
    operator.click(panel.name_edit)
    QTest.keyClicks(panel.name_edit, 'bot5')
    assert panel.name_edit.hasFocus()
    panel.show_name_problem('no')
    assert panel.name_edit.hasFocus(), 'a name that was refused is typed again'
    panel.clear_name()
    operator.press(panel.focusWidget(), Qt.Key_W, scan=25)
    assert not panel.name_edit.hasFocus() and panel.stick() == (1.0, 0.0)
    operator.release(panel.focusWidget(), Qt.Key_W, scan=25)


def test_the_bottom_line_begins_at_one_place(panel, operator):
    places = set()
    for level in ('calm', 'attention', 'stopped'):
        panel.status_line.show_status('a sentence', level)
        operator.settle()
        places.add(panel.status_line._line.x())
    assert len(places) == 1


def test_escape_after_a_click_on_a_row_takes_its_highlight_away(panel, operator, four_robots):
    panel.show_view(four_robots)
    operator.settle()
    operator.click(panel.robot_list.row('bot2'))
    assert panel.robot_list.current == 'bot2' and panel.remove_button.isEnabled()
    operator.hit(panel.focusWidget() or panel, Qt.Key_Escape)
    assert panel.robot_list.current is None and not panel.remove_button.isEnabled()


def test_a_result_is_news_for_a_while(operator, ui_dir, monkeypatch):
    monkeypatch.setattr('mhri.screen.gui.screen.RESULT_MS', 40)
    panel = operator.show(ScreenWidget(ui_dir))
    panel.show_look_result('looking', busy=True)
    QTest.qWait(80)
    assert panel.look_label.text() == 'looking', 'as long as it looks'
    panel.show_look_result('found bot1')
    assert panel.look_label.text() == 'found bot1'
    operator.wait_until(lambda: panel.look_label.text() == '')


def test_the_drop_down_makes_room_for_the_button_to_talk(panel, operator, four_robots):
    for mode in ('joy', 'voice'):
        panel.show_view(replace(four_robots, mode=mode))
        operator.settle()
        assert panel.width() == 1280 and panel.minimumSizeHint().width() <= 1024
    assert '"stop"' not in panel.drive_note.shown_text(), 'no microphone is open'
    panel.show_view(replace(panel._view, devices=(views.DeviceView('voice', 'the microphone'),)))
    assert panel.drive_note.shown_text().endswith('"stop" is always heard')


@pytest.mark.parametrize('pace, slowed, shown', [
    ('all as bot2 and bot3: at most 0.22 m/s, 1.82 rad/s', False, '0.22 m/s, 1.82 rad/s'),
    ('80 % of the speed: the link to bot2 takes 130 ms', True, '80 % of the speed'),
    ('each does its best', False, 'each does its best')])
def test_of_the_pace_the_speed_is_what_matters(panel, operator, four_robots, pace, slowed, shown):
    panel.show_view(replace(four_robots, together=True, pace=pace, slowed=slowed))
    operator.settle()
    assert panel.speed_limits.pace_label.shown_text().endswith(shown)


def test_the_bottom_line_keeps_its_room(
        panel, operator, four_robots):
    text = 'no ROS master at http://host:11311: start roscore there; looking again every second'
    widths = []
    for bits in (0.0, 2e7, 0.0):
        panel._numbers._next = None
        panel.show_view(replace(four_robots, status=text, camera_bits_per_s=bits))
        operator.settle()
        widths.append(panel.status_line.width())
    assert len(set(widths)) == 1, 'nothing beside it jumps'


@pytest.mark.parametrize('state, headline', [
    (views.PROOF_STOPPED, 'STOPPED - all robots'),
    (views.PROOF_WAITING, 'STOP ALL in force \u2013 stopping bot1'),
    (views.PROOF_NOT_CONFIRMED, 'STOP ALL in force \u2013 bot1 NOT CONFIRMED'),
])
def test_the_stop_bar_claims_what_the_rows_prove(panel, four_robots, state, headline):
    robot = replace(four_robots.robots[0], proof=views.ProofView(state, state))
    panel.show_view(replace(four_robots, stop_all=True, robots=(robot,)))
    assert panel.stop_bar._headline.text() == headline


@pytest.mark.parametrize('changes, active, note', [
    ({}, True, 'drag'),
    ({'mode': 'ps3joy'}, False, 'PS3 Controller drives'),
    ({'mode': None}, False, 'not known'),
    ({'stop_all': True}, False, 'stop all is in force'),
])
def test_the_stick_says_whether_anybody_listens(panel, drag, heard, four_robots, changes, active,
                                                note):
    panel.show_view(replace(four_robots, **changes))
    moved = heard(panel.stick_moved)
    drag(panel.joystick, 0.0, 0.9)
    assert panel.joystick._active == active and note in panel.drive_note.text()
    assert moved[-1][0] > 0.8, 'it moves all the same'


@pytest.mark.parametrize('level, sign', [
    ('calm', None), ('attention', (theme.TRIANGLE, theme.ATTENTION)),
    ('stopped', (theme.OCTAGON, theme.STOP))])
def test_the_status_line(panel, four_robots, level, sign):
    panel.show_view(replace(four_robots, status='one thing', status_level=level))
    assert panel.findChild(QLabel, 'status_label').text() == 'one thing'
    assert panel.status_line._sign.sign == sign


def test_what_the_stick_asks_for_is_said_in_units(panel, operator, four_robots):
    panel.show_view(four_robots)
    panel._numbers._next = None
    operator.press(panel, Qt.Key_W, 25)
    assert panel.linear_label.text() == 'forward 0.50 m/s'
    operator.release(panel, Qt.Key_W, 25)
    assert panel.linear_label.text() == '0.00 m/s', 'neutral is told at once'


def test_showing_views_takes_no_focus_and_asks_for_nothing(panel, operator, heard, four_robots):
    panel.name_edit.setFocus()
    operator.wait_until(panel.name_edit.hasFocus)
    said = [heard(getattr(panel, name)) for name in (
        'selection_requested', 'mode_requested', 'limits_requested', 'stick_moved', 'looked_at',
        'stop_requested', 'release_requested')]
    stopped = replace(four_robots, stop_all=True, mode='voice', limits=(0.3, 1.0))
    for view in (four_robots, stopped, views.PanelView(), four_robots):
        panel.show_view(view)
        operator.settle()
        assert panel.name_edit.hasFocus()
    assert all(signal == [] for signal in said)


def test_it_fits_1024x600_and_fingers(panel, operator, four_robots):
    panel.show_view(four_robots)
    operator.settle()
    panel.resize(1024, 600)
    operator.settle()
    hint = panel.minimumSizeHint()
    assert hint.width() <= 1024 and hint.height() <= 600
    assert (panel.width(), panel.height()) == (1024, 600)
    stop = panel.stop_bar.stop_button
    for widget in panel.findChildren((QAbstractButton, QComboBox, QLineEdit)):
        if widget.isVisible():
            assert widget.height() >= 36 and widget.width() >= 36, widget.objectName()
            if isinstance(widget, QAbstractButton) and widget is not stop:
                assert widget.width() * widget.height() < stop.width() * stop.height()
    for label in panel.findChildren(QLabel):
        assert label.font().pointSizeF() >= 11.0, label.text()
    assert panel.rect().contains(stop.rect().translated(stop.mapTo(panel, QPoint(0, 0))))


def test_a_hidden_panel_drives_nothing(panel, operator):
    operator.press(panel, Qt.Key_W, 25)
    panel.hide()
    assert panel.stick() == (0.0, 0.0)


def test_tab_order_is_the_reading_order(panel, operator, application, four_robots):
    panel.show_view(four_robots)
    panel.robot_list.activate('bot1')
    panel.look_button.setFocus(Qt.TabFocusReason)
    seen = ['look_button']
    for _ in range(17):
        operator.hit(application.focusWidget(), Qt.Key_Tab)
        seen.append(application.focusWidget().objectName())
    assert seen == ['look_button', 'doctor_button', 'name_edit', 'add_button', 'robot_list',
                    'check_bot1', 'check_bot2', 'check_bot3', 'check_bot4', 'all_button',
                    'none_button', 'record_button', 'remove_button', 'mode_combo', 'linear_slider',
                    'angular_slider', 'together_box', 'brake_box']


def test_settings_survive_json_and_those_of_another_version_do_no_harm(panel, operator, ui_dir):
    panel.splitter.setSizes([450, 550])
    settings = json.loads(json.dumps(panel.save_settings()))
    other = ScreenWidget(ui_dir)
    other.resize(1024, 600)
    other.restore_settings(settings)
    operator.show(other)
    assert other.splitter.sizes() == panel.splitter.sizes()
    for other_version in ({}, {'splitter': [1, 2, 3]}):
        other.restore_settings(other_version)
        assert other.splitter.sizes() == panel.splitter.sizes()


@pytest.mark.parametrize('ground, text', [('#efefef', '#000000'), ('#2d2f33', '#ebebeb')])
def test_shapes_and_text_stand_out_in_light_and_dark(ground, text):
    palette = QPalette(QColor(ground))
    palette.setColor(QPalette.WindowText, QColor(text))

    def luminance(colour):
        parts = [part / 12.92 if part <= 0.03928 else ((part + 0.055) / 1.055) ** 2.4
                 for part in colour.getRgbF()[:3]]
        return 0.2126 * parts[0] + 0.7152 * parts[1] + 0.0722 * parts[2]

    def contrast(one, other):
        high, low = sorted((luminance(one), luminance(other)), reverse=True)
        return (high + 0.05) / (low + 0.05)
    window = palette.color(QPalette.Window)
    assert contrast(theme.colour(theme.MUTED, palette), window) >= 4.5
    for name in (theme.LIVE, theme.STOP, theme.DRIVE):
        assert contrast(theme.colour(name, palette), window) >= 2.9, name
    for name in (theme.DRIVE, theme.STOP):
        ink = theme.colour(name, palette)
        assert contrast(theme.readable_on(ink), ink) >= 3.0, 'large bold text'


def test_record_selected_asks_for_those_that_are_and_then_for_the_end(
        panel, operator, heard, four_robots):
    recorded, ended = heard(panel.record_requested), heard(panel.stop_record_requested)
    robots = [replace(robot, selected=robot.name in ('bot1', 'bot3'))
              for robot in four_robots.robots]
    panel.show_view(replace(four_robots, robots=tuple(robots)))
    operator.click(panel.record_button)
    assert (recorded, ended) == ([['bot1', 'bot3']], [])
    going = tuple(replace(robot, recording=robot.name in ('bot1', 'bot2')) for robot in robots)
    panel.show_view(replace(four_robots, robots=going))
    assert panel.record_button.text() == 'Stop recording (2)'
    pill = panel.robot_list.row('bot2').recording
    assert pill.word == 'rec'
    assert panel.robot_list.row('bot3').recording.word == ''
    operator.click(panel.record_button)
    assert (recorded, ended) == ([['bot1', 'bot3']], [['bot1', 'bot2']])


def test_nothing_to_record_without_a_selection(panel, four_robots):
    robots = tuple(replace(robot, selected=False) for robot in four_robots.robots)
    panel.show_view(replace(four_robots, robots=robots))
    assert not panel.record_button.isEnabled()


@pytest.mark.parametrize('bits, text', [(0.0, ''), (float('nan'), ''),
                                        (12.34e6, 'cameras 12.3 Mbit/s')])
def test_what_the_cameras_take_of_the_network(panel, operator, four_robots, bits, text):
    def shown():
        panel.show_view(replace(four_robots, camera_bits_per_s=bits))
        return panel.cameras_label.text() == text
    operator.wait_until(shown)


def test_in_a_narrow_dock_the_name_is_the_last_to_give_way(panel, operator, four_robots):
    panel.resize(640, 480)
    panel.show_view(four_robots)
    operator.settle()
    title = panel.robot_list.row('bot1').title
    assert title.toolTip() == '' and title.width() >= title.fontMetrics().horizontalAdvance('bot1')


def test_push_to_talk_by_button_and_key_and_only_with_the_voice(panel, heard, four_robots):
    talked = heard(panel.talk_requested)
    panel.show_view(four_robots)
    assert not panel.talk_button.isVisible()
    QTest.keyPress(panel, Qt.Key_T)
    QTest.keyRelease(panel, Qt.Key_T)
    assert True not in talked, 'another source drives'
    panel.show_view(replace(four_robots, mode='voice'))
    assert panel.talk_button.isVisible()
    talked.clear()
    QTest.mousePress(panel.talk_button, Qt.LeftButton)
    QTest.mouseRelease(panel.talk_button, Qt.LeftButton)
    assert talked == [True, False]
    talked.clear()
    QTest.keyPress(panel, Qt.Key_T)
    assert talked[-1] is True and panel.talk_button.isDown()
    panel.drive_keys.release()
    assert talked[-1] is False and not panel.talk_button.isDown(), 'focus lost, ear closed'


@pytest.mark.parametrize('heard_view, words', [
    (None, 'wake word'),
    (views.HeardView('robot forward', 'forward 0.5', True), 'heard "robot forward": forward 0.5'),
    (views.HeardView('forward', 'forward 0.5', False, 'no wake word'), 'no wake word'),
    (views.HeardView('well', '', False, ''), 'not a command')])
def test_what_was_heard_is_told_while_the_voice_drives(panel, four_robots, heard_view, words):
    panel.show_view(replace(four_robots, mode='voice', heard=heard_view))
    assert words in panel.drive_note.text()
    panel.show_view(replace(four_robots, mode='joy', heard=heard_view))
    assert words not in panel.drive_note.text()


def test_staying_together_is_asked_for_and_shown(panel, operator, heard, four_robots):
    asked = heard(panel.together_requested)
    box, label = panel.speed_limits.together_box, panel.speed_limits.pace_label
    panel.show_view(replace(four_robots, pace='each does its best'))
    assert not box.isChecked() and label.text() == 'each does its best'
    operator.click(box)
    assert asked == [True]
    panel.show_view(replace(four_robots, together=True, pace='all as bot2: at most 0.22 m/s'))
    assert box.isChecked() and '0.22 m/s' in label.text()
    operator.click(box)
    assert asked == [True, False]
    panel.show_view(replace(four_robots, pace='50 % of the speed', slowed=True))
    assert label.text() == '50 % of the speed'


def test_the_brake_is_asked_for_and_shown(panel, operator, heard, four_robots):
    asked = heard(panel.speed_limits.brake_requested)
    box = panel.speed_limits.brake_box
    panel.show_view(four_robots)
    assert not box.isChecked()
    operator.click(box)
    panel.show_view(replace(four_robots, brake=True))
    assert asked == [True] and box.isChecked()
    operator.click(box)
    assert asked == [True, False]


def test_a_row_says_what_the_guard_does_by_itself(panel, four_robots):
    first, *others = four_robots.robots
    guarded = replace(first, guarded=True,
                      brake=BrakeView('on', on_robot=True, back_after_s=10.0))
    panel.show_view(replace(four_robots, robots=(guarded, *others)))
    row = panel.robot_list.row(first.name)
    assert 'brakes by itself, goes back alone after 10 s' in row.toolTip()


def test_a_row_warns_of_its_link_and_tells_the_figures(panel, operator, four_robots):
    figures = views.LinkFigures(0.38, -0.4, 0.07)
    first, *others = four_robots.robots
    warned = replace(first, link=views.LIVE, figures=figures, slow=True, guarded=True,
                     note='slow link: 380 ms round trip')
    panel.splitter.setSizes([600, 680])
    panel.show_view(replace(four_robots, robots=(warned, *others)))
    row = panel.robot_list.row(first.name)
    assert row.trouble.text() == 'slow link: 380 ms round trip'
    assert row.trouble.isVisible() and row.trouble_sign.sign[0] == theme.TRIANGLE
    shown = row.trouble.fontMetrics().horizontalAdvance(row.trouble.text())
    assert shown <= row.trouble.width(), 'it can be read in full'
    assert row.pill.isVisible() and row.battery.isVisible()
    assert row.kind.text() == 'guarded ' + first.type_label
    assert row.toolTip() == 'link 380 ms   clock -0.40 s   lost 7 %'
