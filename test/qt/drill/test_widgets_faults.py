# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The list of faults: real clicks begin and end them; it is there for simulated robots alone."""
import pytest
from python_qt_binding.QtWidgets import QAbstractButton, QWidget

from mhri.base.gui.page import Section, SectionPage
from mhri.base.views import LIVE, RobotView, ScreenView
from mhri.drill.gui.faults_page import FaultsPage, FOR_S
from mhri.drill.presenters.fault_presenter import FaultPresenter
from mhri.sim.faults import FAULTS


@pytest.fixture
def page(operator):
    made = FaultsPage()
    made.resize(420, 760)
    made.show_robots(('bot1', 'bot2'))
    return operator.show(made)


@pytest.fixture
def asked(page, heard):
    return heard(page.asked)


def press(page, operator, key):
    button = page.findChild(QAbstractButton, 'fault_button_' + key)
    operator.click(button)
    return button


def test_every_fault_is_in_the_list_with_its_default(page, operator, asked):
    for fault in FAULTS:
        press(page, operator, fault.key)
        assert asked[-1] == ('bot1', fault.key, pytest.approx(fault.default), FOR_S)
        value = page.findChild(QWidget, 'fault_value_' + fault.key)
        assert (value is not None) == bool(fault.unit)
    assert len(asked) == len(FAULTS)


def test_value_robot_and_time_are_chosen(page, operator, asked):
    page.findChild(QWidget, 'fault_value_delay').setText('0,25')
    page.robot_combo.setCurrentText('bot2')
    page.duration.set_value(None)
    assert page.duration.placeholderText() == 'until ended'
    press(page, operator, 'delay')
    press(page, operator, 'node_dead')
    assert asked == [('bot2', 'delay', 0.25, 0.0), ('bot2', 'node_dead', 0.0, FOR_S)]


def test_what_is_no_number_is_refused(page, operator, asked):
    page.findChild(QWidget, 'fault_value_delay').setText('1.000,5')
    press(page, operator, 'delay')
    assert asked == [] and '1.000,5' in page.answer.text()


def test_what_fails_is_said_and_can_be_ended(page, operator, asked):
    page.show_answer('bot1', True, 'bot1: delay each way 0.4 s')
    assert page.answer.text().startswith('bot1')
    button = press(page, operator, 'delay')
    assert button.text() == 'End' and asked == [('bot1', 'delay', 0.0, -1.0)]
    page.show_answer('bot1', True, 'bot1: no faults active')
    assert button.text() == 'Start'
    operator.click(page.end_all_button)
    assert asked[-1] == ('bot1', 'all', 0.0, -1.0)


def test_an_answer_is_that_of_its_robot(page):
    page.show_answer('bot2', False, 'no')
    assert page.answer.text() == ''
    page.robot_combo.setCurrentText('bot2')
    assert page.answer.text() == 'no'


def test_without_a_robot_nothing_can_be_asked(page, operator, asked):
    page.show_robots(())
    press(page, operator, 'delay')
    assert asked == [] and page.answer.text()


class Client:
    """Stands in for the client; bot2 is simulated once it says so."""

    def __init__(self):
        self.names, self.found, self.asked, self.watched = (), (), [], []
        self.news = []

    def follow(self, names):
        self.names = names

    def simulated(self):
        return self.found

    def ask(self, *words):
        self.asked.append(words)

    def watch(self, watched):
        self.watched.append(watched)

    def take_news(self):
        news, self.news = self.news, []
        return news

    def close(self):
        self.watched.append(None)


def test_the_page_is_there_for_simulated_robots_alone(operator):
    client, drawer = Client(), SectionPage()
    operator.show(drawer)

    def add(job, title, part, order, icon):
        drawer.add(Section(title, icon, part, order))
        drawer.sections[0].open(False)
    presenter = FaultPresenter(add, client)
    view = ScreenView(robots=(RobotView('bot1', link=LIVE), RobotView('bot2', link=LIVE)))
    presenter.show_view(view)
    assert client.names == ['bot1', 'bot2'] and presenter.page is None
    client.found = ('bot2',)
    client.news = [('bot2', True, 'bot2: laser silent')]
    presenter.show_view(view)
    presenter.show_view(view)
    page = presenter.page
    assert page.robot_combo.count() == 1 and not page.isVisible()
    section, = drawer.sections
    operator.settle()
    operator.click(section.row)
    assert page.isVisible() and client.watched == [True]
    assert page.answer.text() == 'bot2: laser silent'
    press(page, operator, 'delay')
    assert client.asked == [('bot2', 'delay', pytest.approx(0.4), FOR_S)]
    operator.click(section.row)
    assert not page.isVisible() and client.watched == [True, False]
    presenter.close()
