# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The event list with real clicks and keys, and the host that feeds it and the tones."""
from dataclasses import replace

import pytest
from python_qt_binding.QtCore import QPoint, Qt
from python_qt_binding.QtTest import QTest

from mhri.core.recording.recording import FAILED, RecordingStatus
from mhri.core.screen import views
from mhri.core.screen.events import ALARM, clock_text, EventLog, MOST
from mhri.core.screen.views import PanelView, RobotView
from mhri.gui.screen import theme
from mhri.gui.screen.event_list import EventList, ROBOT, SEVERITY, TIME, WHAT
from mhri.presenters.event_host import EventHost

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
    widget.show_events(log_of(NOTES))
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
    assert len({theme.SEVERITY_SIGNS[severity][0] for severity in theme.SEVERITY_SIGNS}) == 3


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
    QTest.keyClick(shown.lines, Qt.Key_End)
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
    assert at_end(shown) and not shown.newest_button.isEnabled()
    shown.lines.verticalScrollBar().setValue(40)
    operator.settle()
    top = shown.lines.indexAt(QPoint(5, 5)).row()
    shown.add(many(7, 50))
    operator.settle()
    assert shown.lines.indexAt(QPoint(5, 5)).row() == top, 'what is read does not jump'
    assert shown.newest_button.text() == 'Newest (7)' and shown.newest_button.isEnabled()
    seen = heard(shown.seen)
    operator.click(shown.newest_button)
    operator.settle()
    assert at_end(shown) and shown.newest_button.text() == 'Newest' and seen
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


@pytest.mark.parametrize('width', [440, 520, 700, 1200])
def test_nothing_is_clipped_and_fingers_hit(shown, operator, width):
    shown.add(log_of([('link.gone', 'gone: switched off or out of reach; last heard 14:02:04',
                       'bot2')]).events)
    shown.resize(width, 300)
    operator.settle()
    head = (shown.robot_combo, shown.severity_combo, shown.sounds, shown.newest_button)
    for one, other in zip(head, head[1:]):
        assert one.geometry().right() < other.geometry().left()
    assert shown.minimumSizeHint().width() <= 440
    assert head[-1].geometry().right() < shown.width()
    assert min(widget.height() for widget in head) >= 36
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
def host(operator):
    """Return a host whose list is on the screen, its tones and its clock."""
    made, now = [], [0.0]
    made_host = EventHost(lambda name: made_host.status, lambda on_absent: made.append(
        Tones(on_absent)) or made[0], lambda: now[0], lambda: WALL_S + now[0])
    made_host.status, made_host.tones, made_host.now = RecordingStatus(), made[0], now
    made_host.start()
    operator.show(made_host.list)
    made_host.show(VIEW)
    yield made_host
    made_host.close()
    assert made_host.tones.state == 'closed'


def lose(host, **values):
    """Show that the robot is silent."""
    host.show(replace(VIEW, robots=(replace(BOT, link=views.SILENT, note='nothing', **values),)))


def test_the_host_shows_what_changes_and_lets_it_be_heard(host, heard):
    told = heard(host.told)
    lose(host)
    assert rows(host.list) == ['found', 'silent: nothing']
    assert host.tones.played == ['attention']
    assert [event.kind for event in told[0]] == ['link.silent']
    host.show(VIEW)
    assert len(told) == 1


def test_the_host_tells_of_recordings(host):
    host.status = RecordingStatus(FAILED, note='the disk is full')
    host.show(VIEW)
    assert rows(host.list)[-1] == 'not recorded: the disk is full'


@pytest.mark.parametrize('selected, played', [(False, []), (True, ['lost'])])
def test_silenced_only_a_robot_lost_while_driven_is_heard(host, operator, selected, played):
    operator.click(host.list.sounds)
    host.show(replace(VIEW, robots=(replace(BOT, selected=selected),)))
    lose(host, selected=selected)
    assert host.tones.played == played
    assert host.save_settings() == {'sounds': False}


def test_the_switch_is_kept(host, operator):
    host.restore_settings({'sounds': False})
    assert not host.list.sounds.isChecked()
    operator.click(host.list.sounds)
    assert host.save_settings() == {'sounds': True}
    host.restore_settings({})
    assert host.list.sounds.isChecked()


def test_without_a_sound_device_a_line_says_so(host):
    host.tones.on_absent('no sound device can be opened: none')
    host.show(VIEW)
    host.show(VIEW)
    assert rows(host.list)[1:] == ['no sound: no sound device can be opened: none']


def test_a_note_and_the_headline(host, operator):
    host.log.see()
    lose(host, selected=True)
    host.note('request.refused', 'not done: bot9 is not in the list')
    assert host.headline() == (
        'bot1 lost while driven {} (1 more)'.format(clock_text(WALL_S)), ALARM)
    click_line(operator, host.list, 0)
    assert host.headline().text == ''
