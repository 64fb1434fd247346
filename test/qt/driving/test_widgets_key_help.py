# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""F1 shows every key that works and no other; it covers no stop and takes no key."""
import pytest
from python_qt_binding.QtCore import QRect, Qt
from python_qt_binding.QtGui import QKeySequence
from python_qt_binding.QtWidgets import QApplication

from mhri.driving.gui.drive_keys import COMMANDS
from mhri.driving.gui.key_help import COMMAND_WORDS, KEY_ROWS, TITLE

W, SPACE = 25, 65


@pytest.fixture
def shown(panel, operator, four_robots):
    panel.show_view(four_robots)
    panel.stage.setFocus()
    operator.hit(panel.stage, Qt.Key_F1)
    assert panel.key_help.isVisible()
    return panel.key_help


def of(widget, screen):
    return QRect(widget.mapTo(screen, widget.rect().topLeft()), widget.size())


def test_every_key_of_the_screen_has_its_line():
    assert set(COMMAND_WORDS) == set(COMMANDS.values())
    named = dict(KEY_ROWS)
    for key, command in COMMANDS.items():
        assert named[QKeySequence(key).toString()] == COMMAND_WORDS[command]
    assert len(named) == len(KEY_ROWS), 'no key twice'


@pytest.mark.parametrize('key', [Qt.Key_F1, Qt.Key_Escape])
def test_it_goes_again(panel, operator, shown, key):
    operator.hit(QApplication.focusWidget(), key)
    assert not shown.isVisible()
    operator.hit(panel.stage, Qt.Key_F1)
    assert shown.isVisible()


def test_escape_takes_the_list_away_first(panel, operator, shown):
    panel.robot_list.activate('bot2')
    operator.hit(panel, Qt.Key_Escape)
    assert panel.robot_list.current == 'bot2' and not shown.isVisible()
    operator.hit(panel, Qt.Key_Escape)
    assert panel.robot_list.current is None


def test_a_click_takes_it_away(operator, shown):
    operator.click(shown)
    assert not shown.isVisible()


def test_the_keys_work_while_it_shows(panel, operator, heard, shown):
    stopped, moved = heard(panel.stop_requested), heard(panel.stick_moved)
    selected, alone = heard(panel.robot_list.selection_requested), heard(panel.drive_requested)
    operator.press(panel.stage, Qt.Key_W, W)
    operator.release(panel.stage, Qt.Key_W, W)
    operator.hit(panel.stage, Qt.Key_2, 11)
    operator.hit(panel.stage, Qt.Key_3, 12, Qt.ControlModifier)
    operator.hit(panel.stage, Qt.Key_Space, SPACE, Qt.ShiftModifier)
    assert moved == [(1.0, 0.0, 0.0), (0.0, 0.0, 0.0)]
    assert selected == [['bot1', 'bot2']] and alone == ['bot3'] and stopped == [()]
    assert shown.isVisible()


def test_the_other_keys_of_the_screen(panel, operator, heard, four_robots):
    panel.show_view(four_robots)
    panel.stage.setFocus()
    commands = heard(panel.drive_keys.command_pressed)
    shown = (panel.stage.numbers_shown, panel.drawer_button.isChecked(), panel.isFullScreen())
    for key in (Qt.Key_H, Qt.Key_F2, Qt.Key_F11, Qt.Key_P, Qt.Key_R, Qt.Key_N):
        operator.hit(panel.stage, key)
    assert (panel.stage.numbers_shown, panel.drawer_button.isChecked(), panel.isFullScreen()) \
        == tuple(not state for state in shown)
    assert commands == ['numbers', 'drawer', 'full_screen', 'stills', 'record', 'mark']
    operator.hit(panel.stage, Qt.Key_F11)
    assert not panel.isFullScreen()


def test_f6_goes_round(panel, operator, four_robots):
    panel.show_view(four_robots)
    panel.stage.setFocus()
    parts = []
    for _ in range(3):
        operator.hit(QApplication.focusWidget(), Qt.Key_F6)
        focus = QApplication.focusWidget()
        parts.append(next(part.objectName() for part in (panel.foot, panel.drawer, panel.stage)
                          if part is focus or part.isAncestorOf(focus)))
    assert parts == ['drawer', 'foot', 'stage']


@pytest.mark.parametrize('size, larger, drawer', [
    ((1024, 600), 1.0, True), ((794, 700), 2.0, False)])
def test_it_is_whole_and_covers_no_stop(panel, operator, shown, size, larger, drawer):
    font = panel.font()
    font.setPointSizeF(font.pointSizeF() * larger)
    panel.setFont(font)
    panel.drawer_button.setChecked(drawer)
    panel.resize(*size)
    operator.settle()
    assert not of(shown, panel).intersects(of(panel.stop_bar, panel))
    assert panel.rect().contains(of(shown, panel))
    places = shown.places()[1]
    for box, text, _ in places:
        assert shown.rect().contains(box), text
    for index, (box, text, _) in enumerate(places):
        for other, another, _ in places[index + 1:]:
            assert not box.intersects(other), (text, another)
    assert {text for _, text, _ in places} == {TITLE}.union(*KEY_ROWS)
