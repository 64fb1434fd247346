# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The event list with real clicks and keys, and the host that feeds it and the tones."""
from dataclasses import replace

import pytest
from python_qt_binding.QtCore import QPoint, Qt
from python_qt_binding.QtTest import QTest

from mhri.base import views
from mhri.base.views import PanelView, RobotView
from mhri.events.events import ALARM, CALM, clock_text, EventLog, Headline, MOST
from mhri.events.gui.event_button import EventButton, SEVERITY_SIGNS
from mhri.events.gui.event_list import EventList, ROBOT, SEVERITY, TIME, WHAT
from mhri.recording.recording import FAILED, RecordingStatus
from mhri.screen.presenters.event_host import EventHost

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
    """Tell whether the newest line is in sight."""
    bar = widget.lines.verticalScrollBar()
    return bar.value() == bar.maximum()


def choose(operator, combo, text):
    """Choose from a drop-down with the keyboard."""
    combo.setFocus()
    place = combo.findText(text)
    while combo.currentIndex() != place:
        operator.hit(combo, Qt.Key_Down if combo.currentIndex() < place else Qt.Key_Up)
    operator.settle()


def test_a_line_says_when_how_bad_who_and_what(shown):
    assert rows(shown, TIME) == [clock_text(WALL_S + second) for second in range(4)]
    assert rows(shown, SEVERITY) == ['note', 'alarm', 'attention', 'attention']
    assert rows(shown, ROBOT) == ['bot1', 'bot2', '', 'bot1']
    assert rows(shown) == [text for _, text, _ in NOTES]


def test_each_severity_has_a_shape_of_its_own(shown):
    pictures = [shown.filter.index(row, SEVERITY).data(Qt.DecorationRole).toImage()
                for row in range(4)]
    assert pictures[2] == pictures[3] and len({
        bytes(picture.constBits().asstring(picture.byteCount())) for picture in pictures}) == 3
    assert len({SEVERITY_SIGNS[severity][0] for severity in SEVERITY_SIGNS}) == 3


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
    ('All robots', 'All events', [0, 1, 2, 3]), ('bot1', 'All events', [0, 2, 3]),
    ('bot2', 'All events', [1, 2]), ('bot3', 'All events', [2]),
    ('All robots', 'Attention', [1, 2, 3]), ('All robots', 'Alarms', [1]),
    ('bot1', 'Alarms', [])])
def test_filters(shown, operator, robot, severity, wanted):
    choose(operator, shown.robot_combo, robot)
    choose(operator, shown.severity_combo, severity)
    assert rows(shown) == [NOTES[row][1] for row in wanted]
    shown.add(log_of([*NOTES, ('link.lost', 'lost while driven: again', 'bot1')]).events[4:])
    assert ('lost while driven: again' in rows(shown)) == (robot in ('All robots', 'bot1'))


def test_the_robot_that_is_chosen_stays_though_it_has_left(shown, operator):
    choose(operator, shown.robot_combo, 'bot2')
    shown.show_robots(('bot1', 'bot4'))
    assert shown.robot_combo.currentText() == 'bot2'
    assert [shown.robot_combo.itemText(row) for row in range(shown.robot_combo.count())] == [
        'All robots', 'bot1', 'bot4', 'bot2']
    assert rows(shown) == [NOTES[1][1], NOTES[2][1]]
    choose(operator, shown.robot_combo, 'All robots')
    shown.show_robots(('bot1', 'bot4'))
    assert shown.robot_combo.findText('bot2') == -1


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
    assert shown.newest_button.text() == 'Newest (7)' and shown.newest_button.isVisible()
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
    assert rows(shown)[4:] == [
        '{} (3 times since {})'.format(kind, clock_text(WALL_S + first))
        for first, kind in enumerate(('link.silent', 'link.back'))]


def test_repeats_that_come_at_once_are_one_line(operator):
    widget, log = EventList(), EventLog()
    widget.add([log.note('link.back', 'back', second, WALL_S, 'bot9') for second in range(4)])
    assert rows(widget) == ['back (4 times since {})'.format(clock_text(WALL_S))]


def test_it_keeps_as_many_as_the_log(shown):
    shown.add(many(MOST + 100))
    assert shown.filter.rowCount() == MOST


def test_only_new_rows_are_made(shown):
    inserted = []
    shown.add(many(1000))
    shown.filter.rowsInserted.connect(lambda parent, first, last: inserted.append((first, last)))
    shown.add(many(3, 1000))
    shown.add([])
    assert inserted == [(1004, 1006)]


@pytest.mark.parametrize('width', [370, 520, 700, 1200])
def test_nothing_is_clipped_and_fingers_hit(shown, operator, width):
    shown.add(log_of([('link.gone', 'gone: switched off or out of reach; last heard 14:02:04',
                       'bot2')]).events)
    shown.resize(width, 300)
    operator.settle()
    shown.lines.verticalScrollBar().setValue(0)
    operator.settle()
    head = (shown.robot_combo, shown.severity_combo, shown.sounds)
    for one, other in zip(head, head[1:]):
        assert one.geometry().right() < other.geometry().left()
    assert shown.minimumSizeHint().width() <= 370
    assert head[-1].geometry().right() < shown.width()
    assert shown.lines.rect().contains(shown.newest_button.geometry())
    assert min(widget.height() for widget in (*head, shown.newest_button)) >= 36
    index = shown.filter.index(shown.filter.rowCount() - 1, WHAT)
    assert shown.lines.visualRect(index).height() >= 36
    metrics, room = shown.lines.fontMetrics(), shown.lines.visualRect(index).size()
    needed = metrics.boundingRect(0, 0, room.width() - 8, 999, Qt.TextWordWrap, index.data())
    assert needed.height() <= room.height() and needed.width() <= room.width()
    words = [shown.filter.index(row, SEVERITY) for row in range(shown.filter.rowCount())]
    for word in words:
        assert metrics.horizontalAdvance(word.data()) + metrics.height() <= \
            shown.lines.visualRect(word).width()
        assert word.data(Qt.AccessibleTextRole) in ('note', 'attention', 'alarm')
    assert metrics.height() * 2 <= 36 or shown.lines.visualRect(index).height() > 36


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
VIEW = PanelView(ros=views.ROS_CONNECTED, mode='joy', robots=(BOT,))


@pytest.fixture
def host(panel, operator):
    """Return a host on a screen, with its tones."""
    made = []
    made_host = EventHost(lambda name: made_host.status, panel, lambda on_absent: made.append(
        Tones(on_absent)) or made[0], lambda: 0.0, lambda: WALL_S)
    made_host.status, made_host.tones = RecordingStatus(), made[0]
    made_host.start()
    made_host.show(VIEW)
    panel.show_view(VIEW)
    yield made_host
    made_host.close()
    assert made_host.tones.state == 'closed'


def lose(host, **values):
    """Show that the robot is silent."""
    host.show(replace(VIEW, robots=(replace(BOT, link=views.SILENT, note='nothing', **values),)))


def test_the_host_shows_what_changes_and_lets_it_be_heard(host, heard):
    told = heard(host.told)
    lose(host)
    assert rows(host.page) == ['found', 'silent: nothing']
    assert host.tones.played == ['attention']
    assert [event.kind for event in told[0]] == ['link.silent']
    host.show(VIEW)
    assert len(told) == 1


def test_the_host_tells_of_recordings(host):
    host.status = RecordingStatus(FAILED, note='the disk is full')
    host.show(VIEW)
    assert rows(host.page)[-1] == 'not recorded: the disk is full'


@pytest.mark.parametrize('selected, played', [(False, []), (True, ['lost'])])
def test_silenced_only_a_robot_lost_while_driven_is_heard(host, operator, selected, played):
    operator.click(host.page.sounds)
    host.show(replace(VIEW, robots=(replace(BOT, selected=selected),)))
    lose(host, selected=selected)
    assert host.tones.played == played
    assert host.save_settings() == {'sounds': False}


def test_the_switch_is_kept(host, operator):
    host.restore_settings({'sounds': False})
    assert not host.page.sounds.isChecked()
    operator.click(host.page.sounds)
    assert host.save_settings() == {'sounds': True}
    host.restore_settings({})
    assert host.page.sounds.isChecked()


def test_without_a_sound_device_a_line_says_so(host):
    host.tones.on_absent('no sound device can be opened: none')
    host.show(VIEW)
    host.show(VIEW)
    assert rows(host.page)[1:] == ['no sound: no sound device can be opened: none']


def test_the_bottom_line_names_the_worst_and_a_click_opens_the_list(host, panel, operator):
    button = panel.events_button
    host.log.see()
    assert not host.page.isVisible()
    lose(host, selected=True)
    host.note('request.refused', 'not done: bot9 is not in the list')
    worst = 'bot1 lost while driven ' + clock_text(WALL_S)
    assert (button.text(), button.severity) == (worst + ' (1 more)', ALARM)
    assert button.height() >= 36 and button.toolTip() == button.text()
    operator.click(button)
    operator.settle()
    assert host.page.isVisible() and rows(host.page)[-1].startswith('not done: ')
    assert button.text() == 'Events', 'whoever has opened the list has seen it'


@pytest.mark.parametrize('width, shown', [
    (500, 'bot1 lost while driven 14:02:06 (2 more)'), (300, 'bot1 lost while driven 14:02:06'),
    (130, '3 events')])
def test_the_words_of_the_bottom_line_give_way(operator, width, shown):
    button = EventButton()
    button.show_headline(Headline('bot1 lost while driven 14:02:06 (2 more)', ALARM), 3)
    button.resize(width, 40)
    assert button.shown_text() == shown
    button.resize(130, 40)
    button.show_headline(Headline('bot1 lost while driven 14:02:06', ALARM), 1)
    assert button.shown_text() == '1 event'
    button.show_headline(Headline('', CALM), 0)
    assert button.shown_text() == 'Events' and button.minimumSizeHint().width() <= 130


def test_a_click_on_a_line_looks_at_the_robot(host, panel, operator, heard):
    looked = heard(panel.looked_at)
    host.note('screen.note', 'a robot that has left', 'bot7')
    operator.click(panel.events_button)
    operator.settle()
    click_line(operator, host.page, 1)
    click_line(operator, host.page, 0)
    assert set(looked) == {'bot1'} and panel.stage.looked_at == 'bot1'


def test_tones_are_made_ready_a_while_after_the_start(host):
    assert host.tones.state == 'made' and host._begin.isActive()
    host._begin.timeout.emit()
    assert host.tones.state == 'started'
