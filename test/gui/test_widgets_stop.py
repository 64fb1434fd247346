# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Stop all: on press, from every finger; released in two steps or not at all."""
import pytest
from python_qt_binding.QtCore import QEvent, Qt
from python_qt_binding.QtTest import QTest

from mhri.driving.gui import stop_bar
from mhri.driving.gui.stop_bar import StopBar
from mhri.driving.stop_words import StopWords


@pytest.fixture
def bar(operator):
    widget = StopBar()
    widget.resize(1000, 90)
    return operator.show(widget)


@pytest.fixture
def stopped(bar):
    bar.show_stop(True, '')
    return bar


def test_it_acts_on_press_not_on_release(bar, heard):
    asked = heard(bar.stop_requested)
    QTest.mousePress(bar.stop_button, Qt.LeftButton)
    assert asked == [()]
    QTest.mouseRelease(bar.stop_button, Qt.LeftButton)
    assert asked == [()]


def test_it_acts_on_the_first_contact_of_a_finger(bar, heard, touch):
    asked = heard(bar.stop_requested)
    touch(bar.stop_button, QEvent.TouchBegin, Qt.TouchPointPressed, 20, 20)
    assert asked == [()] and bar.stop_button.isDown()
    touch(bar.stop_button, QEvent.TouchEnd, Qt.TouchPointReleased, 20, 20)
    assert asked == [()] and not bar.stop_button.isDown()


def test_it_says_stopping_until_it_is_said_to_be_stopped(bar, operator):
    bar.request_stop()
    assert bar.stop_button.text() == 'STOPPING ...' and bar.stop_button.isVisible()
    bar.show_stop(True, '')
    assert not bar.stop_button.isVisible() and bar.release_button.isVisible()


def test_a_stop_that_nobody_grants_is_offered_again(bar, operator):
    bar.request_stop()
    operator.wait_until(lambda: bar.stop_button.text() == 'STOP ALL')


def test_release_takes_two_steps(stopped, operator, heard):
    released = heard(stopped.release_requested)
    assert not stopped.confirm_button.isVisible()
    place = stopped.release_button.mapTo(stopped, stopped.release_button.rect().center())
    operator.click(stopped.release_button)
    assert stopped.confirm_button.isVisible() and released == []
    assert stopped.childAt(place) is stopped.cancel_button, 'a double click cancels'
    operator.click(stopped.confirm_button)
    assert released == [()] and not stopped.confirm_button.isVisible()
    stopped.show_stop(False, '')
    assert stopped.stop_button.isVisible()


def test_cancel_goes_back(stopped, operator, heard):
    released = heard(stopped.release_requested)
    operator.click(stopped.release_button)
    operator.click(stopped.cancel_button)
    assert not stopped.confirm_button.isVisible() and stopped.release_button.isVisible()
    assert released == []


def test_an_unanswered_question_goes_away(operator, monkeypatch):
    monkeypatch.setattr(stop_bar, 'CONFIRM_WITHIN_S', 0.05)
    bar = operator.show(StopBar())
    bar.show_stop(True, '')
    operator.click(bar.release_button)
    assert bar.confirm_button.isVisible()
    operator.wait_until(lambda: not bar.confirm_button.isVisible())


def test_a_refused_release_says_why_and_can_be_tried_again(stopped, operator):
    operator.click(stopped.release_button)
    operator.click(stopped.confirm_button)
    assert not stopped.release_button.isEnabled()
    stopped.show_stop(True, 'centre the stick first')
    assert stopped.release_button.isEnabled()
    assert stopped._note_line.text() == 'centre the stick first'


def test_the_headline_says_what_is_proved_and_gives_way_to_a_shorter_one(stopped, operator):
    assert 'STOPPED' not in stopped._headline.text(), 'nothing is proved yet'
    said = StopWords(('STOP ALL in force \u2013 bot3 NOT CONFIRMED', 'bot3 NOT CONFIRMED'),
                     'go and look', '')
    stopped.show_stop(True, '', said)
    assert stopped._headline.shown_text() == said.headlines[0]
    assert stopped._note_line.text() == 'go and look'
    stopped.resize(700, 90)
    operator.settle()
    assert stopped._headline.shown_text() == said.headlines[1]
    stopped._headline.grab()
    assert stopped._headline.toolTip() == said.headlines[0]


def test_a_new_stop_takes_the_question_back(stopped, operator):
    operator.click(stopped.release_button)
    stopped.request_stop()
    assert not stopped.confirm_button.isVisible()


@pytest.mark.parametrize('state', ['at rest', 'under the pointer', 'down'])
def test_the_small_print_can_be_read(bar, operator, state):
    button = bar.stop_button
    button.setAttribute(Qt.WA_UnderMouse, state == 'under the pointer')
    button.setDown(state == 'down')
    colour = button.grab().toImage().pixelColor(40, button.height() // 2)

    def linear(value):
        return value / 12.92 if value <= 0.03928 else ((value + 0.055) / 1.055) ** 2.4
    luminance = sum(share * linear(value) for share, value in zip(
        (0.2126, 0.7152, 0.0722), colour.getRgbF()))
    assert 1.05 / (luminance + 0.05) >= 4.5


def test_its_size_never_changes(bar, operator):
    operator.settle()
    before = bar.sizeHint().height()
    for shown in ((True, ''), (True, 'x' * 300), (False, '')):
        bar.show_stop(*shown)
        assert bar.sizeHint().height() == before
    assert before >= 36


def test_the_stop_button_held_for_two_seconds_cuts_the_power(bar, operator, heard, monkeypatch):
    """Also where the page that says what is stopped has taken its place meanwhile."""
    cut = heard(bar.power_cut_requested)
    bar._held.setInterval(200)
    QTest.mousePress(bar.stop_button, Qt.LeftButton)
    bar.show_stop(True, '')
    operator.wait_until(lambda: cut)
    QTest.mouseRelease(bar, Qt.LeftButton)
    assert cut == [()]


def test_the_stop_button_let_go_before_cuts_nothing(bar, operator, heard):
    cut, ended = heard(bar.power_cut_requested), heard(bar.stop_button.let_go)
    QTest.mousePress(bar.stop_button, Qt.LeftButton)
    bar.show_stop(True, '')
    QTest.mouseRelease(bar, Qt.LeftButton)
    assert ended == [()] and not bar._held.isActive() and cut == []


def test_the_second_step_cuts_the_power_where_there_is_such_a_thing(stopped, operator, heard):
    cut = heard(stopped.power_cut_requested)
    assert not stopped.power_button.isVisible()
    stopped.show_power(True)
    operator.wait_until(lambda: stopped._appeared.isValid()
                        and stopped._appeared.elapsed() >= 1000 * stop_bar.SETTLED_S)
    operator.click(stopped.power_button)
    assert cut == [()]
    operator.click(stopped.release_button)
    assert not stopped.power_button.isVisible(), 'the release has the room'


def test_clicks_that_follow_the_stop_never_cut_the_power(bar, operator, heard, monkeypatch):
    """Angry ones, and those that waited in a queue while the screen hung."""
    monkeypatch.setattr(stop_bar, 'SETTLED_S', 2.0)
    cut = heard(bar.power_cut_requested)
    bar.show_power(True)
    for _ in range(2):
        bar.show_stop(True, '')
        for _ in range(5):
            operator.click(bar.power_button)
        operator.wait_until(bar._appeared.isValid)
        QTest.mousePress(bar.power_button, Qt.LeftButton)
        operator.wait_until(lambda: bar._appeared.elapsed() >= 1000 * stop_bar.SETTLED_S)
        QTest.mouseRelease(bar.power_button, Qt.LeftButton)
        assert cut == [], 'it was pressed too soon'
        bar.show_stop(False, '')
    bar.show_stop(True, '')
    operator.wait_until(lambda: bar._appeared.isValid()
                        and bar._appeared.elapsed() >= 1000 * stop_bar.SETTLED_S)
    operator.click(bar.power_button)
    assert cut == [()]


@pytest.mark.parametrize('was_stopped', [False, True])
def test_a_screen_that_is_cut_off_has_no_stop_button_that_looks_alive(bar, was_stopped):
    bar.show_stop(was_stopped, '')
    bar.show_cut_off(True)
    assert not bar.stop_button.isVisible()
    assert 'cut off' in bar._headline.text() and 'restart' in bar._note_line.text()
    assert not bar.release_button.isEnabled()
    bar.show_cut_off(False)
    assert bar.stop_button.isVisible() != was_stopped
