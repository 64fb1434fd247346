# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Stop all: on press, from every finger; released in two steps or not at all."""
import time

import pytest
from python_qt_binding.QtCore import QEvent, Qt
from python_qt_binding.QtTest import QTest
from python_qt_binding.QtWidgets import QWidget

from mhri.driving.gui import stop_bar
from mhri.driving.gui.stop_bar import StopBar
from mhri.driving.stop_words import StopWords


def headline(bar):
    return bar.findChild(QWidget, 'stopped_label')


def note(bar):
    return bar.findChild(QWidget, 'stop_note_label')


def wait_s(operator, seconds):
    """Let the window live for so long."""
    begun = time.monotonic()
    operator.wait_until(lambda: time.monotonic() - begun >= seconds)


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
    operator.click(stopped.cancel_button)
    assert not stopped.confirm_button.isVisible() and released == []
    operator.click(stopped.release_button)
    stopped.request_stop()
    assert not stopped.confirm_button.isVisible(), 'a new stop takes the question back'
    stopped.show_stop(True, '')
    operator.click(stopped.release_button)
    operator.click(stopped.confirm_button)
    assert released == [()] and not stopped.confirm_button.isVisible()
    stopped.show_stop(False, '')
    assert stopped.stop_button.isVisible()


def test_a_refused_release_says_why_and_can_be_tried_again(stopped, operator):
    operator.click(stopped.release_button)
    operator.click(stopped.confirm_button)
    assert not stopped.release_button.isEnabled()
    stopped.show_stop(True, 'centre the stick first')
    assert stopped.release_button.isEnabled()
    assert note(stopped).text() == 'centre the stick first'


def test_the_headline_says_what_is_proved_and_gives_way_to_a_shorter_one(stopped, operator):
    assert 'STOPPED' not in headline(stopped).text(), 'nothing is proved yet'
    said = StopWords(('STOP ALL in force \u2013 bot3 NOT CONFIRMED', 'bot3 NOT CONFIRMED'),
                     'go and look', '')
    stopped.show_stop(True, '', said)
    assert headline(stopped).shown_text() == said.headlines[0]
    assert note(stopped).text() == 'go and look'
    stopped.resize(440, 90)
    operator.settle()
    assert headline(stopped).shown_text() == said.headlines[1]
    headline(stopped).grab()
    assert headline(stopped).toolTip() == said.headlines[0]


def ring_of(bar):
    return bar.findChild(QWidget, 'hold_ring')


def test_a_ring_fills_while_the_stop_is_held_and_says_what_then_happens(
        operator, monkeypatch):
    # However long this process stands still, it is not full.
    monkeypatch.setattr(stop_bar, 'CUT_AFTER_S', 600.0)
    bar = operator.show(StopBar())
    bar.resize(1000, 120)
    bar.show_power(True)
    ring = ring_of(bar)
    QTest.mousePress(bar.stop_button, Qt.LeftButton)
    assert not ring.isVisible() and bar.stop_button.text() == stop_bar.STOPPING
    bar.show_stop(True, '')
    operator.wait_until(ring.isVisible)
    before = ring.share()
    operator.wait_until(lambda: ring.share() > before)
    assert ring.geometry() == ring.parentWidget().rect() and ring.text()
    QTest.mouseRelease(bar, Qt.LeftButton)
    assert not ring.isVisible()


def test_the_stop_held_for_two_seconds_cuts_the_power_and_the_ring_goes(
        operator, heard, monkeypatch):
    """Also where the page that says what is stopped has taken its place meanwhile."""
    monkeypatch.setattr(stop_bar, 'CUT_AFTER_S', 0.2)
    bar = operator.show(StopBar())
    bar.show_power(True)
    cut = heard(bar.power_cut_requested)
    QTest.mousePress(bar.stop_button, Qt.LeftButton)
    bar.show_stop(True, '')
    operator.wait_until(lambda: cut and ring_of(bar).share() == 0.0)
    QTest.mouseRelease(bar, Qt.LeftButton)
    assert cut == [()] and not ring_of(bar).isVisible()


def test_the_stop_button_let_go_before_cuts_nothing(operator, heard, monkeypatch):
    monkeypatch.setattr(stop_bar, 'CUT_AFTER_S', 0.2)
    bar = operator.show(StopBar())
    cut, ended = heard(bar.power_cut_requested), heard(bar.stop_button.let_go)
    QTest.mousePress(bar.stop_button, Qt.LeftButton)
    bar.show_stop(True, '')
    QTest.mouseRelease(bar, Qt.LeftButton)
    wait_s(operator, 2.0 * stop_bar.CUT_AFTER_S)
    assert ended == [()] and cut == []


def test_the_second_step_cuts_the_power_where_there_is_such_a_thing(stopped, operator, heard):
    cut = heard(stopped.power_cut_requested)
    assert not stopped.power_button.isVisible()
    stopped.show_power(True)
    stopped.grab()
    wait_s(operator, stop_bar.SETTLED_S)
    operator.click(stopped.power_button)
    assert cut == [()]
    operator.click(stopped.release_button)
    assert not stopped.power_button.isVisible(), 'the release has the room'


def test_clicks_that_follow_the_stop_never_cut_the_power(bar, operator, heard, monkeypatch):
    """Angry ones, and those that waited in a queue while the screen hung."""
    cut = heard(bar.power_cut_requested)
    bar.show_power(True)
    for _ in range(2):
        # However long this process stands still, it was too soon; then long enough.
        monkeypatch.setattr(stop_bar, 'SETTLED_S', 600.0)
        bar.show_stop(True, '')
        for _ in range(5):
            operator.click(bar.power_button)
        bar.grab()
        QTest.mousePress(bar.power_button, Qt.LeftButton)
        monkeypatch.setattr(stop_bar, 'SETTLED_S', 0.0)
        QTest.mouseRelease(bar.power_button, Qt.LeftButton)
        assert cut == [], 'it was pressed too soon'
        bar.show_stop(False, '')
    bar.show_stop(True, '')
    bar.grab()
    operator.click(bar.power_button)
    assert cut == [()]


@pytest.mark.parametrize('was_stopped', [False, True])
def test_a_screen_that_is_cut_off_has_no_stop_button_that_looks_alive(bar, was_stopped):
    bar.show_stop(was_stopped, '')
    bar.show_cut_off(True)
    assert not bar.stop_button.isVisible()
    assert 'cut off' in headline(bar).text() and 'restart' in note(bar).text()
    assert not bar.release_button.isEnabled()
    bar.show_cut_off(False)
    assert bar.stop_button.isVisible() != was_stopped
