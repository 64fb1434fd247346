# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The graph: what is on the screen follows the robot, and stands still only where it says so."""
import math

import numpy as np
import pytest
from python_qt_binding.QtCore import Qt
from python_qt_binding.QtGui import QColor, QPalette

from mhri.base.gui import theme
from mhri.base.series import BinRing, IMU_KEYS, ODOMETRY_KEYS, Series
from mhri.sensors.gui.imu_graph import CHOICES, ImuGraph, WINDOWS_S

NOW = 900.0


def series_of(now=NOW, rate_hz=200.0, turn=0.8):
    """Return a minute of a robot that turned for the last five seconds."""
    times = now - 60.0 + np.arange(int(60.0 * rate_hz)) / rate_hz
    rate = np.where(times > now - 5.0, turn, 0.0)
    odometry, imu = BinRing(ODOMETRY_KEYS), BinRing(IMU_KEYS)
    odometry.add(times, np.column_stack((0.2 * np.ones(len(times)), rate)))
    rows = np.zeros((len(times), len(IMU_KEYS)))
    rows[:, IMU_KEYS.index('gyro_z')], rows[:, IMU_KEYS.index('accel_z')] = rate, 9.81
    rows[:, IMU_KEYS.index('yaw')] = math.radians(30.0)
    imu.add(times, rows)
    rings = {key: odometry for key in ODOMETRY_KEYS}
    rings.update({key: imu for key in IMU_KEYS})
    return Series(now, rings)


@pytest.fixture
def graph(operator):
    widget = ImuGraph()
    widget.resize(520, 360)
    operator.show(widget)
    return widget


def inked(chart, stroke=0):
    """Return the columns and rows of a chart in which its blue curve is to be seen."""
    image = chart.view.grab().toImage()
    wanted = theme.colour(theme.DRIVE, chart.palette())
    points = [(x, y) for x in range(0, image.width()) for y in range(0, image.height())
              if sum(abs(a - b) for a, b in zip(image.pixelColor(x, y).getRgb(),
                                                wanted.getRgb())) < 60]
    return np.array(points)


def test_the_curve_rises_when_the_robot_turns(graph, operator):
    graph.show_value(series_of(turn=0.0))
    operator.settle()
    yaw_rate = graph.charts[1]
    before = inked(yaw_rate)
    graph.show_value(series_of(turn=0.8))
    operator.settle()
    after = inked(yaw_rate)
    assert np.ptp(before[:, 1]) < 8, 'a flat line'
    newest, older = after[after[:, 0] > 0.9 * yaw_rate.view.width(), 1], after[
        after[:, 0] < 0.7 * yaw_rate.view.width(), 1]
    assert newest.min() < older.min() - 20, 'the newest part, at the right, is higher'


def test_what_is_drawn_travels_to_the_left(graph, operator):
    places = []
    for later in (0.0, 5.0):
        moved = series_of()
        graph.show_value(Series(NOW + later, moved.rings))
        operator.settle()
        points = inked(graph.charts[1])
        places.append(points[points[:, 1] < points[:, 1].max() - 20, 0].min())
    width = graph.charts[1].view.width()
    assert (places[0] - places[1]) / width == pytest.approx(5.0 / 30.0, abs=0.05)


@pytest.mark.parametrize('index, captions, value', [
    (0, ['linear velocity [m/s]', 'yaw rate [rad/s]'], '0.20'),
    (1, ['linear acceleration [m/s²]'], '0.00'),
    (2, ['angular velocity [rad/s]'], '0.00'),
    (3, ['orientation [deg]'], '0.00')])
def test_every_choice_has_its_units(graph, operator, index, captions, value):
    graph.quantity_combo.setCurrentIndex(index)
    graph.show_value(series_of())
    operator.settle()
    shown = [chart for chart in graph.charts if chart.isVisible()]
    assert [chart.legend._plot.caption for chart in shown] == captions
    assert shown[0].legend.texts[0] == value
    assert len(CHOICES[index][2]) == len(captions)


def test_angles_are_in_degrees(graph):
    graph.quantity_combo.setCurrentIndex(3)
    graph.show_value(series_of())
    assert graph.charts[0].legend.texts == ('0.00', '0.00', '30.00')


def test_no_curve_and_no_number_before_the_first_sample(graph, operator):
    empty = {key: BinRing(IMU_KEYS if key in IMU_KEYS else ODOMETRY_KEYS)
             for key in IMU_KEYS + ODOMETRY_KEYS}
    graph.show_value(Series(NOW, empty))
    operator.settle()
    assert graph.charts[0].legend.texts == ('–',) and len(inked(graph.charts[0])) == 0


@pytest.mark.parametrize('seconds', WINDOWS_S)
def test_the_window_is_as_long_as_chosen(graph, operator, seconds):
    graph.window_combo.setCurrentIndex(WINDOWS_S.index(seconds))
    graph.show_value(series_of())
    low, high = graph.charts[0].box.viewRange()[0]
    assert low == pytest.approx(-seconds, rel=0.1) and 0.0 <= high < 0.1 * seconds
    x, _ = graph.charts[1]._curves[0].getData()
    assert x[0] == pytest.approx(-seconds, rel=0.05) and len(x) <= 310


def test_pause_by_click_and_key_keeps_the_picture_and_says_so(graph, operator):
    graph.show_value(series_of())
    operator.click(graph.pause_button)
    before = graph.charts[1]._curves[0].getData()[1].copy()
    graph.show_value(series_of(turn=-0.8))
    np.testing.assert_array_equal(graph.charts[1]._curves[0].getData()[1], before)
    assert graph.paused and graph.pause_button.text() == 'Resume'
    assert all(chart.legend._paused for chart in graph.charts)
    graph.window_combo.setCurrentIndex(0)
    assert len(graph.charts[1]._curves[0].getData()[0]) > 0, 'another window of what is kept'
    graph.pause_button.setFocus()
    operator.hit(graph.pause_button, Qt.Key_Space)
    graph.show_value(series_of(turn=-0.8))
    assert not graph.paused and graph.charts[1]._curves[0].getData()[1].min() < -0.5


def test_hidden_it_draws_nothing(graph):
    graph.show_value(series_of())
    before = graph.charts[1]._curves[0].getData()[1].copy()
    graph.hide()
    graph.show_value(series_of(turn=-0.8))
    np.testing.assert_array_equal(graph.charts[1]._curves[0].getData()[1], before)


def test_the_choices_are_remembered(graph, operator):
    graph.quantity_combo.setCurrentIndex(2)
    graph.window_combo.setCurrentIndex(4)
    other = ImuGraph()
    other.restore_settings(graph.save_settings())
    assert (other.quantity_combo.currentData(), other.window_s) == ('gyro', 60)
    other.restore_settings({'quantity': 'gone', 'window_s': 7})
    assert (other.quantity_combo.currentData(), other.window_s) == ('gyro', 60)


def test_dark_and_light(graph, operator):
    grounds = []
    for ground, ink in (('#101214', '#f0f0f0'), ('#ffffff', '#101010')):
        palette = QPalette(graph.palette())
        for role, value in ((QPalette.Base, ground), (QPalette.Window, ground),
                            (QPalette.WindowText, ink), (QPalette.Text, ink)):
            palette.setColor(role, QColor(value))
        graph.setPalette(palette)
        graph.show_value(series_of())
        operator.settle()
        chart = graph.charts[0]
        grounds.append(chart.view.grab().toImage().pixelColor(
            chart.view.width() - 3, 3).lightness())
        assert len(inked(chart)) > 50
    assert grounds[0] < 60 < 200 < grounds[1]


def test_the_keyboard_and_the_mouse_pass_the_plot(graph):
    assert all(chart.view.focusPolicy() == Qt.NoFocus
               and chart.view.testAttribute(Qt.WA_TransparentForMouseEvents)
               for chart in graph.charts)


@pytest.mark.parametrize('width, quantity, shown', [
    (600, 0, ('caption', 'names', 'values')), (360, 0, ('names', 'values')),
    (270, 1, ('values',)), (700, 1, ('caption', 'names', 'values'))])
def test_where_there_is_little_room_the_values_are_the_last_to_go(graph, width, quantity, shown):
    """The yaw rate is that of the second chart, with two curves."""
    graph.quantity_combo.setCurrentIndex(quantity)
    legend = graph.charts[1 if quantity == 0 else 0].legend
    legend.resize(width, legend.height())
    assert legend.shown == shown
    assert legend._plot.caption in legend.toolTip()


def test_old_values_do_not_look_like_those_of_now(graph):
    pictures = []
    for old in (False, True, False):
        graph.show_old(old)
        assert all(chart.legend.old == old for chart in graph.charts)
        pictures.append(graph.charts[1].legend.grab().toImage())
    assert pictures[0] == pictures[2] != pictures[1]


def test_a_paused_graph_does_not_end_now(graph, operator):
    def ends():
        return {chart._bottom._tickLevels[0][0][1] for chart in graph.charts}
    assert ends() == {'now'}
    operator.click(graph.pause_button)
    assert ends() == {'end'}
    graph.window_combo.setCurrentIndex(0)
    assert ends() == {'end'}
    operator.click(graph.pause_button)
    assert ends() == {'now'}
