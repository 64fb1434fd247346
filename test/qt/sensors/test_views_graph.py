# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The graph: what is on the screen follows the robot, and stands still only where it says so."""
import math

import numpy as np
import pytest
from python_qt_binding.QtCore import Qt

from mhri.base.gui import theme
from mhri.base.series import BinRing, IMU_KEYS, ODOMETRY_KEYS, Series
from mhri.sensors.gui.imu_graph import ImuGraph

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


@pytest.mark.parametrize('index, units, values', [
    (0, ['m/s', 'rad/s'], ('0.20',)), (1, ['m/s²'], ('0.00', '0.00', '9.81')),
    (2, ['rad/s'], ('0.00', '0.00', '0.80')), (3, ['deg'], ('0.00', '0.00', '30.00'))])
def test_every_choice_has_its_units(graph, operator, index, units, values):
    graph.quantity_combo.setCurrentIndex(index)
    graph.show_value(series_of())
    operator.settle()
    shown = [chart for chart in graph.charts if chart.isVisible()]
    assert len(shown) == len(units) and shown[0].legend.texts == values
    assert all(unit in chart.legend.toolTip() for chart, unit in zip(shown, units))


def picture(graph, operator):
    operator.settle()
    return graph.charts[1].view.grab().toImage()


def test_pause_by_click_and_key_keeps_the_picture_and_says_so(graph, operator):
    graph.show_value(series_of())
    operator.settle()
    legend = graph.charts[1].legend.grab().toImage()
    operator.click(graph.pause_button)
    assert graph.paused and graph.charts[1].legend.grab().toImage() != legend
    before = picture(graph, operator)
    graph.show_value(series_of(turn=-0.8))
    assert picture(graph, operator) == before
    graph.window_combo.setCurrentIndex(0)
    assert len(inked(graph.charts[1])), 'another window of what is kept'
    graph.pause_button.setFocus()
    operator.hit(graph.pause_button, Qt.Key_Space)
    graph.show_value(series_of(turn=-0.8))
    assert not graph.paused and picture(graph, operator) != before


def test_the_choices_are_remembered(graph, operator):
    graph.quantity_combo.setCurrentIndex(2)
    graph.window_combo.setCurrentIndex(4)
    other = ImuGraph()
    other.restore_settings(graph.save_settings())
    assert (other.quantity_combo.currentData(), other.window_s) == ('gyro', 60)
    other.restore_settings({'quantity': 'gone', 'window_s': 7})
    assert (other.quantity_combo.currentData(), other.window_s) == ('gyro', 60)


def test_old_values_do_not_look_like_those_of_now(graph):
    pictures = []
    for old in (False, True, False):
        graph.show_old(old)
        assert all(chart.legend.old == old for chart in graph.charts)
        pictures.append(graph.charts[1].legend.grab().toImage())
    assert pictures[0] == pictures[2] != pictures[1]
