# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""The graph of a robot's motion: velocity and yaw rate, or what its IMU measures."""
import math

from python_qt_binding.QtCore import Qt
from python_qt_binding.QtWidgets import (
    QComboBox, QHBoxLayout, QPushButton, QSizePolicy, QVBoxLayout, QWidget)

from mhri.base import series as columns
from mhri.base.gui import theme
from mhri.sensors.gui.chart import Chart, Plot, Trace

WINDOWS_S = (5, 10, 20, 30, 60)
USUAL_WINDOW_S = 30
PAUSE = 'Pause'
RESUME = 'Resume'


def _axes(keys, names='xyz'):
    """Return a trace for each of three components; the vertical one is solid."""
    return tuple(Trace(key, name, stroke) for key, name, stroke in zip(keys, names, (1, 2, 0)))


# What can be shown: key, label, one or two plots. A further quantity is a further row.
CHOICES = (
    ('motion', 'Velocity, yaw rate', (
        Plot('linear velocity [m/s]', 0.1, 1.0, (Trace(columns.LINEAR, 'odometry'),)),
        Plot('yaw rate [rad/s]', 0.2, 1.0, (Trace('gyro_z', 'gyro', 1),
                                            Trace(columns.YAW_RATE, 'odometry'))))),
    ('accel', 'Linear acceleration', (
        Plot('linear acceleration [m/s²]', 1.0, 1.0, _axes(columns.ACCEL)),)),
    ('gyro', 'Angular velocity', (
        Plot('angular velocity [rad/s]', 0.2, 1.0, _axes(columns.GYRO)),)),
    ('orientation', 'Orientation', (
        Plot('orientation [deg]', 10.0, math.degrees(1.0),
             _axes(columns.ORIENTATION, columns.ORIENTATION)),)),
)


class ImuGraph(QWidget):
    """Draws each series it is given; while it is paused it keeps the one on show.

    Child widgets: ``quantity_combo``, ``window_combo``, ``pause_button``, ``charts``.
    """

    def __init__(self, parent=None):
        super().__init__(parent)
        self._series = None
        self._plots = ()
        self._build()
        self._connect()
        self._restore()

    def _build(self):
        """Make and place the charts and what chooses them."""
        self.setObjectName('imu_graph')
        self.charts = (Chart(self), Chart(self))
        self.quantity_combo = QComboBox(self)
        for key, label, _ in CHOICES:
            self.quantity_combo.addItem(label, key)
        self.window_combo = QComboBox(self)
        for seconds in WINDOWS_S:
            self.window_combo.addItem('{} s'.format(seconds), seconds)
        self.pause_button = QPushButton(PAUSE, self)
        self.pause_button.setCheckable(True)
        self.pause_button.setAutoDefault(False)
        row = QHBoxLayout()
        row.setSpacing(6)
        for widget, name, spoken in (
                (self.quantity_combo, 'quantity_combo', 'what the graph shows'),
                (self.window_combo, 'window_combo', 'seconds on show'),
                (self.pause_button, 'pause_button', 'pause the graph')):
            widget.setObjectName(name)
            widget.setAccessibleName(spoken)
            widget.setToolTip(spoken)
            widget.setFocusPolicy(Qt.TabFocus)
            widget.setMinimumHeight(theme.touch_size(self))
            row.addWidget(widget)
        self.quantity_combo.setSizeAdjustPolicy(QComboBox.AdjustToMinimumContentsLengthWithIcon)
        self.quantity_combo.setSizePolicy(QSizePolicy.Expanding, QSizePolicy.Fixed)
        # As wide as its longer text, so that nothing moves when it is pressed.
        self.pause_button.setMinimumWidth(
            theme.text_width(self.font(), PAUSE, RESUME) + self.fontMetrics().height())
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(4)
        for chart in self.charts:
            column.addWidget(chart, 1)
        column.addLayout(row)

    def _connect(self):
        """Wire the choices."""
        self.quantity_combo.currentIndexChanged[int].connect(lambda *_: self._arrange())
        self.window_combo.currentIndexChanged[int].connect(lambda *_: self._arrange())
        self.pause_button.toggled.connect(self._on_pause)

    def _restore(self):
        """Begin with the usual choice."""
        self.window_combo.setCurrentIndex(WINDOWS_S.index(USUAL_WINDOW_S))
        self._arrange()

    @property
    def paused(self):
        """Whether the graph stands still."""
        return self.pause_button.isChecked()

    @property
    def window_s(self):
        """Seconds on show."""
        return self.window_combo.currentData()

    def show_old(self, old):
        """Say whether the newest values are old: the robot is not heard any more."""
        for chart in self.charts:
            chart.legend.show_old(old)

    def show_value(self, series):
        """Draw a :class:`Series`; without effect while paused or hidden."""
        if self.paused or not self.isVisible():
            return
        self._series = series
        self._draw()

    def show_age(self, age_s):
        """Take the age of the newest value; the link says whether it is old (:meth:`show_old`)."""

    def _draw(self):
        """Draw the series that is there."""
        if self._series is not None:
            for chart, _ in zip(self.charts, self._plots):
                chart.show_series(self._series, self.window_s, self._series.now_s)

    def _arrange(self):
        """Show what is chosen."""
        plots = CHOICES[self.quantity_combo.currentIndex()][2]
        if plots is not self._plots:
            self._plots = plots
            for chart, plot in zip(self.charts, plots):
                chart.show_plot(plot)
        for index, chart in enumerate(self.charts):
            chart.setVisible(index < len(plots))
            chart.set_window(self.window_s, with_times=index == len(plots) - 1)
        self._draw()

    def _on_pause(self, paused):
        """Say in the button what it does next."""
        self.pause_button.setText(RESUME if paused else PAUSE)
        for chart in self.charts:
            chart.show_paused(paused)

    def save_settings(self):
        """Return the choices as a plain dict."""
        return {'quantity': self.quantity_combo.currentData(), 'window_s': self.window_s}

    def restore_settings(self, settings):
        """Take over a dict of :meth:`save_settings`; what is unknown now is left out."""
        for combo, key in ((self.quantity_combo, 'quantity'), (self.window_combo, 'window_s')):
            index = combo.findData(settings.get(key))
            if index >= 0:
                combo.setCurrentIndex(index)
