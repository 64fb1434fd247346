# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The event list with real clicks and keys, and the presenter that feeds it and the tones."""
from dataclasses import replace

import pytest
from python_qt_binding.QtCore import QPoint, Qt
from python_qt_binding.QtTest import QTest

from mhri.base import views
from mhri.base.views import RobotView, ScreenView
from mhri.events.events import ALARM, clock_text, EventLog
from mhri.events.gui.event_list import EventList, WHAT
from mhri.events.presenters import event_presenter
from mhri.events.presenters.event_presenter import EventPresenter
from mhri.recording.recording import RecordingStatus

WALL_S = 1.8e9
NOTES = (('drive.checked', 'checked', 'bot1'), ('link.lost', 'lost while driven: silent', 'bot2'),
         ('stop.engaged', 'STOP ALL', ''), ('battery.low', 'battery 29 %: charge it soon', 'bot1'))


def log_of(notes):
    """Return a log with an event of each note, a second apart."""
    log = EventLog()
    for second, (kind, text, robot) in enumerate(notes):
        log.note(kind, text, 100.0 * second, WALL_S + second, robot)
    return log


@pytest.fixture
def shown(operator):
    """Return a list on the screen with four events."""
    widget = EventList()
    widget.resize(700, 300)
    widget.show_robots(('bot1', 'bot2', 'bot3'))
    widget.add(log_of(NOTES).events)
    operator.show(widget)
    operator.settle()
    return widget


def rows(widget, column=WHAT):
    """Return what a column says, from top to bottom."""
    return [widget.filter.index(row, column).data() for row in range(widget.filter.rowCount())]


def many(count, first=0):
    """Return so many events."""
    log = log_of([('screen.note', 'x' * (number % 150) or 'y', 'bot1')
                  for number in range(first + count)])
    return log.events[first:]


def click_line(operator, widget, row):
    """Click on a line."""
    place = widget.lines.visualRect(widget.filter.index(row, WHAT)).center()
    QTest.mouseClick(widget.lines.viewport(), Qt.LeftButton, Qt.NoModifier, place)
    operator.settle()


def at_end(widget):
    """Return whether the newest line is in sight."""
    bar = widget.lines.verticalScrollBar()
    return bar.value() == bar.maximum()


def choose(operator, combo, text):
    """Choose from a drop-down with the keyboard."""
    combo.setFocus()
    place = combo.findText(text)
    while combo.currentIndex() != place:
        operator.hit(combo, Qt.Key_Down if combo.currentIndex() < place else Qt.Key_Up)
    operator.settle()


def test_a_click_on_a_line_asks_for_its_robot(shown, operator, heard):
    asked, seen = heard(shown.robot_requested), heard(shown.seen)
    for row in (1, 2, 0):
        click_line(operator, shown, row)
    assert set(asked) == {'bot1', 'bot2'} and asked[0] == 'bot2' and asked[-1] == 'bot1'
    assert seen


def test_the_list_by_keyboard(shown, operator, application, heard):
    asked = heard(shown.robot_requested)
    shown.robot_combo.setFocus()
    reached = []
    while application.focusWidget() is not shown.lines:
        reached.append(application.focusWidget())
        QTest.keyClick(application.focusWidget(), Qt.Key_Tab)
    assert reached == [shown.robot_combo, shown.severity_combo, shown.sounds]
    QTest.keyClick(shown.lines, Qt.Key_End, Qt.ControlModifier)
    QTest.keyClick(shown.lines, Qt.Key_Up)
    QTest.keyClick(shown.lines, Qt.Key_Up)
    QTest.keyClick(shown.lines, Qt.Key_Return)
    assert asked == ['bot2']


@pytest.mark.parametrize('robot, severity, wanted', [
    ('All robots', 'All events', [0, 1, 2, 3]), ('bot2', 'All events', [1, 2]),
    ('All robots', 'Attention', [1, 2, 3]), ('bot1', 'Alarms', [])])
def test_filters(shown, operator, robot, severity, wanted):
    choose(operator, shown.robot_combo, robot)
    choose(operator, shown.severity_combo, severity)
    assert rows(shown) == [NOTES[row][1] for row in wanted]
    shown.add(log_of([*NOTES, ('link.lost', 'again', 'bot1')]).events[4:])
    assert ('again' in rows(shown)) == (robot in ('All robots', 'bot1'))


def test_the_marks_alone(shown, operator):
    shown.add(log_of([*NOTES, ('session.mark', 'mark m1 saved', 'bot1')]).events[4:])
    choose(operator, shown.severity_combo, 'Marks')
    assert rows(shown) == ['mark m1 saved']
    choose(operator, shown.robot_combo, 'bot2')
    assert rows(shown) == []


def test_it_follows_the_newest_until_somebody_scrolls_up(shown, operator, heard):
    shown.add(many(50))
    operator.settle()
    assert at_end(shown) and not shown.newest_button.isVisible()
    shown.lines.verticalScrollBar().setValue(40)
    operator.settle()
    top = shown.lines.indexAt(QPoint(5, 5)).row()
    shown.add(many(7, 50))
    operator.settle()
    assert shown.lines.indexAt(QPoint(5, 5)).row() == top, 'what is read does not jump'
    assert '(7)' in shown.newest_button.text() and shown.newest_button.isVisible()
    seen = heard(shown.seen)
    operator.click(shown.newest_button)
    operator.settle()
    assert at_end(shown) and not shown.newest_button.isVisible() and seen
    shown.add(many(5, 57))
    operator.settle()
    assert at_end(shown)


def test_lines_that_came_while_it_was_hidden_are_there_with_the_newest_in_sight(shown, operator):
    shown.hide()
    shown.add(many(80))
    shown.show()
    operator.wait_until(lambda: shown.isVisible() and at_end(shown))
    shown.resize(700, 200)
    operator.settle()
    assert at_end(shown)


def test_a_repeat_takes_the_place_of_the_line_that_it_counts(shown):
    log = EventLog()
    for second, kind in enumerate(('link.silent', 'link.back') * 3):
        shown.add([log.note(kind, kind, second, WALL_S + second, 'bot3')])
    assert len(rows(shown)) == 6
    for first, row in enumerate(rows(shown)[4:]):
        assert ('link.silent', 'link.back')[first] in row and '3' in row
        assert clock_text(WALL_S + first) in row


def test_a_text_that_looks_like_html_stays_text(shown):
    shown.add(log_of([('screen.note', '<img src="/etc/passwd"> <b>bold</b>', 'bot1')]).events)
    index = shown.filter.index(4, WHAT)
    assert index.data() == '<img src="/etc/passwd"> <b>bold</b>'
    assert '<img' not in index.data(Qt.ToolTipRole)


class Tones:
    """Stands in for the speaker."""

    def __init__(self, on_absent):
        self.on_absent, self.played, self.state = on_absent, [], 'made'

    def start(self):
        self.state = 'started'

    def play(self, tone):
        self.played.append(tone)

    def close(self):
        self.state = 'closed'


BOT = RobotView('bot1', link=views.LIVE, age_s=0.1, battery=0.8)
VIEW = ScreenView(ros=views.ROS_CONNECTED, mode='joy', robots=(BOT,))


@pytest.fixture
def presenter(panel, operator):
    """Return a presenter on a screen, with its tones."""
    made = []
    made_presenter = EventPresenter(
        lambda name: made_presenter.status, panel,
        lambda on_absent: made.append(Tones(on_absent)) or made[0], lambda: 0.0, lambda: WALL_S)
    made_presenter.status, made_presenter.tones = RecordingStatus(), made[0]
    made_presenter.start()
    made_presenter.show_view(VIEW)
    panel.show_view(VIEW)
    yield made_presenter
    made_presenter.close()
    assert made_presenter.tones.state == 'closed'


def lose(presenter, **values):
    """Show that the robot is silent."""
    presenter.show_view(replace(VIEW, robots=(
        replace(BOT, link=views.SILENT, note='nothing', **values),)))


def test_changes_are_shown_and_heard(presenter, heard):
    told = heard(presenter.changed)
    lose(presenter)
    assert [event.kind for event in presenter.log.events] == ['link.found', 'link.silent']
    assert len(rows(presenter.page)) == 2
    assert presenter.tones.played == ['attention']
    assert [event.kind for event in told[0]] == ['link.silent']
    presenter.show_view(VIEW)
    assert len(told) == 1


@pytest.mark.parametrize('selected, played', [(False, []), (True, ['lost'])])
def test_silenced_only_a_robot_lost_while_driven_is_heard(presenter, operator, selected, played):
    operator.click(presenter.page.sounds)
    presenter.show_view(replace(VIEW, robots=(replace(BOT, selected=selected),)))
    lose(presenter, selected=selected)
    assert presenter.tones.played == played
    assert presenter.save_settings() == {'sounds': False}


def test_the_switch_is_kept(presenter, operator):
    presenter.restore_settings({'sounds': False})
    assert not presenter.page.sounds.isChecked()
    operator.click(presenter.page.sounds)
    assert presenter.save_settings() == {'sounds': True}
    presenter.restore_settings({})
    assert presenter.page.sounds.isChecked()


def test_without_a_sound_device_a_line_says_so(presenter):
    presenter.tones.on_absent('none')
    presenter.show_view(VIEW)
    presenter.show_view(VIEW)
    line, = rows(presenter.page)[1:]
    assert line.endswith(': none')


def test_the_bottom_line_names_the_worst_and_a_click_opens_the_list(presenter, panel, operator):
    button = panel.events_button
    presenter.log.mark_seen()
    assert not presenter.page.isVisible()
    lose(presenter, selected=True)
    presenter.note('request.refused', 'no bot9')
    assert (button.text(), button.severity) == presenter.log.headline()[:2]
    assert button.severity == ALARM and 'bot1' in button.text()
    operator.click(button.look_button)
    assert panel.stage.looked_at == 'bot1' and not presenter.page.isVisible()
    operator.click(button)
    operator.settle()
    assert presenter.page.isVisible() and rows(presenter.page)[-1] == 'no bot9'
    assert presenter.log.unseen == 0


def test_a_click_on_a_line_looks_at_the_robot(presenter, panel, operator, heard):
    looked = heard(panel.looked_at)
    presenter.note('screen.note', 'a robot that has left', 'bot7')
    operator.click(panel.events_button)
    operator.settle()
    click_line(operator, presenter.page, 1)
    click_line(operator, presenter.page, 0)
    assert set(looked) == {'bot1'} and panel.stage.looked_at == 'bot1'


def test_tones_are_made_ready_a_while_after_the_start(panel, operator, monkeypatch):
    monkeypatch.setattr(event_presenter, 'START_MS', 1)
    tones = Tones(None)
    presenter = EventPresenter(lambda name: RecordingStatus(), panel, lambda on_absent: tones)
    presenter.start()
    assert tones.state == 'made'
    operator.wait_until(lambda: tones.state == 'started')
    presenter.close()


def test_the_whole_text_of_the_current_line_is_below_and_moves_nothing(shown, operator):
    long_text = 'nothing received for 3.2 s: it is switched off or out of reach of the radio'
    shown.resize(380, 400)
    shown.add(log_of([*NOTES, ('link.lost', long_text, 'bot3')]).events[4:])
    operator.settle()
    last = shown.filter.rowCount() - 1
    before = shown.lines.visualRect(shown.filter.index(last, WHAT))
    assert before.height() == pytest.approx(28, abs=4) and shown.whole_line.text() == ''
    click_line(operator, shown, last)
    assert long_text in shown.whole_line.text()
    assert shown.whole_line.shown_text() == shown.whole_line.text()
    assert shown.lines.visualRect(shown.filter.index(last, WHAT)) == before
