# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Every widget of every page: text of 11 points, 36 pixels for a finger, and no word cut off."""
from dataclasses import replace

import pytest
from python_qt_binding.QtCore import Qt
from python_qt_binding.QtWidgets import (
    QAbstractButton, QAbstractSlider, QAbstractSpinBox, QComboBox, QLabel, QLineEdit, QPushButton,
    QScrollBar, QTabBar)

from mhri.base.gui.labels import TextLine
from mhri.base.part import MISSION, ROBOTS, SETUP
from mhri.base.task_views import FieldView, KindView, Progress, RunView, TasksView
from mhri.base.views import ControlView, LinkFigures
from mhri.devices.gui.pad_calibration import PadCalibration
from mhri.doctor.facts import Finding, WARNING
from mhri.doctor.gui.doctor_page import DoctorPage
from mhri.drill.gui.faults_page import FaultsPage
from mhri.events.events import ALARM, Headline
from mhri.events.gui.event_list import EventList
from mhri.session.gui.note_bar import NoteBar
from mhri.session.gui.record_button import RecordButton
from mhri.session.gui.sessions_page import SessionsPage
from mhri.session.gui.time_line import TimeLineBar
from mhri.session.view import SessionView
from mhri.tasks.gui.runs_list import RunsList
from mhri.tasks.gui.tasks_page import TasksPage
from support.scenes import pixels_of

TARGETS = (QAbstractButton, QAbstractSlider, QAbstractSpinBox, QComboBox, QLineEdit, QTabBar)
WORDS = (QAbstractButton, QAbstractSpinBox, QComboBox, QLabel, QLineEdit, QTabBar)
KINDS = (KindView('goto', 'Go to', 'to a place, around a single thing in the way', (
    FieldView('x', 'm', 'where', ''), FieldView('speed', 'm/s', 'at most', '0.2', 0.05, 0.5),
    FieldView('frame', '', 'of its places', "''", choices=('', 'odom')))),)
THINNED = 'picture 1 in 2 s: the radio carries 0.9 Mbit/s'


def on_show(whole, kinds):
    """Return the widgets of some kinds that are in sight, without the insides of others."""
    return [widget for widget in whole.findChildren(kinds)
            if widget.isVisible() and not widget.visibleRegion().isEmpty()
            and not isinstance(widget, QScrollBar)
            and not isinstance(widget.parentWidget(), (QAbstractSpinBox, QComboBox, QTabBar))]


def is_whole(label):
    """Return whether all words of a label are in sight."""
    if isinstance(label, TextLine):
        return label.shown_text() in label.texts
    if label.wordWrap():
        return not label.text() or label.heightForWidth(label.width()) <= label.height()
    return not label.text() or label.sizeHint().width() <= label.width()


def flaws(whole):
    """Return what is too small or cut off: (object name, what, how)."""
    found = [(one.objectName(), 'font', one.font().pointSizeF()) for one in on_show(whole, WORDS)
             if one.font().pointSizeF() < 11.0]
    found += [(one.objectName(), 'target', (one.width(), one.height()))
              for one in on_show(whole, TARGETS) if min(one.width(), one.height()) < 36]
    found += [(one.objectName(), 'cut off', one.text()) for one in on_show(whole, QPushButton)
              if not hasattr(one, 'shown_text')
              and one.fontMetrics().horizontalAdvance(one.text()) > one.width() - 4]
    found += [(one.objectName(), 'cut off', one.text()) for one in on_show(whole, QLabel)
              if not is_whole(one)]
    # What scrolls does so up and down.
    return found + [(one.objectName(), 'outside', one.text())
                    for one in on_show(whole, (QPushButton, TextLine))
                    if one.visibleRegion().boundingRect().width() < one.width()]


@pytest.fixture
def whole_screen(scene):
    """Return a maker of screens with all pages, and with what comes and goes."""
    def make(size, font):
        made = scene(size, 3, font)
        made.robots = (made.robots[0], replace(
            made.robots[1], ask='Take control', note='lab has control', slow=True), replace(
            made.robots[2], slow=True, note=THINNED, figures=LinkFigures(0.41, 0.0, 0.2, THINNED)))
        made.view = replace(made.view, robots=made.robots,
                            control=ControlView(False, 'panel on lab-pc2', '14:02'))
        screen = made.screen
        doctor, tasks, events, faults = DoctorPage(), TasksPage(), EventList(), FaultsPage()
        runs = RunsList()
        for job, title, page in (
                (ROBOTS, 'Under way', runs), (MISSION, 'Tasks', tasks), (MISSION, 'Events', events),
                (MISSION, 'Sessions', SessionsPage()), (SETUP, 'Doctor', doctor),
                (SETUP, 'Faults', faults), (SETUP, 'Pad', PadCalibration())):
            screen.arrangement.add_section(job, title, page, 30)
        doctor.show_findings([Finding(WARNING, 'clock', 'bot1', 'its clock is 3 s off')], 0.4)
        faults.show_robots(('bot1', 'bot2'))
        under_way = TasksView(kinds=KINDS, runs=(RunView('a', 'goto', '', tuple(
            Progress(name, 'running', '1.3 m to go', 1.3) for name in ('bot1', 'bot2'))),))
        tasks.show_tasks(under_way, list(made.robots[:1]), ['bot1', 'bot2', 'bot3'])
        runs.show_tasks(under_way, [replace(made.robots[2], carry_on='Patrol')])
        events.show_robots(('bot1', 'bot2', 'bot3'))
        screen.events_button.show_headline(
            Headline('bot3 lost while driven 14:02:06 (2 more)', ALARM), 3)
        record, note = RecordButton(screen.foot), NoteBar(screen.foot)
        record.show_session(SessionView(True, True, 'here', 252.0))
        screen.small_row.insertWidget(1, record)
        screen.arrangement.passing.add(note)
        note.settle(note.ask(False), 'm3')
        return made
    return make


def sections_of(made):
    """Yield the sections of the drawer, each opened, and in sight as far as there is room."""
    for section in made.screen.arrangement.drawer.sections:
        made.screen.arrangement.show_page(section.part)
        made.show()
        yield section


@pytest.mark.parametrize('size, font', [((1024, 600), 1.0), ((1920, 1080), 2.0)])
def test_every_page_is_fit_for_eyes_and_fingers(whole_screen, size, font):
    made = whole_screen(size, font)
    found = {}
    for section in sections_of(made):
        found[section.part.objectName()] = flaws(made.screen)
    made.screen.drawer_button.setChecked(False)
    made.show()
    found['drawer closed'] = flaws(made.screen)
    assert len(found) == 12
    assert {page: flaw for page, flaw in found.items() if flaw} == {}


def test_where_the_keyboard_is_can_be_seen(whole_screen, application):
    made = whole_screen((1366, 768), 1.0)
    made.view = replace(made.view, control=ControlView())
    screen = made.show()
    application.setActiveWindow(screen)
    # As the first Tab does: some styles show the keyboard from then on.
    screen.window().setAttribute(Qt.WA_KeyboardFocusChange)
    unseen, looked_at = [], set()
    for section in sections_of(made):
        for widget in on_show(screen, TARGETS):
            if widget not in looked_at and widget.isEnabled() \
                    and widget.focusPolicy() & Qt.TabFocus:
                screen.stage.setFocus(Qt.TabFocusReason)
                without = pixels_of(widget)
                widget.setFocus(Qt.TabFocusReason)
                looked_at.add(widget)
                assert widget.hasFocus(), widget.objectName()
                if (pixels_of(widget) == without).all():
                    unseen.append((section.part.objectName(), widget.objectName()))
    assert unseen == [] and len(looked_at) > 20


def test_the_bar_of_a_replay_is_fit_for_eyes_and_fingers(operator):
    bar = TimeLineBar()
    bar.resize(1024, bar.sizeHint().height())
    assert flaws(operator.show(bar)) == []
